// Simulations of the cell: its job is followed, and the figures and the page that it ends with are shown.
import { followed, tellProgress } from "./jobs.js";
import { ask } from "./service.js";

const find = (id) => document.getElementById(id);
const percent = (share) => `${(100 * share).toFixed(1)} %`;
let shown = null; // the simulation that is shown: { figure, stale, cell }

function element(kind, text, className = "") {
  const made = document.createElement(kind);
  made.textContent = text;
  made.className = className;
  return made;
}

function tell(progress) {
  if (progress === null) return tellProgress("Waiting for a worker");
  const { stage, share, elapsed_s: elapsed, seed, simulated_s: simulated, change } = progress;
  if (stage === "page") return tellProgress("Drawing the first run");
  return tellProgress("Simulating", [
    ["done", percent(share)],
    ["for", `${elapsed.toFixed(1)} s`],
    ...(seed === null ? [] : [["run with seed", String(seed)], ["simulated in it", `${simulated.toFixed(1)} s`]]),
    ...(change === null ? [] : [["change that is tried", change]]),
  ]);
}

// What people ask first of a result.
function figures(found) {
  const { parts_per_minute: rate, interval, known, missed, moving, waiting, runs } = found;
  const waits = Object.entries(waiting).filter(([, share]) => share >= 5e-4);
  const seeds = runs.map(({ seed }) => seed);
  const minutes = runs.reduce((sum, run) => sum + run.simulated_s, 0) / 60;
  const rows = [
    ["parts a minute", rate.toFixed(1) + (interval ? ` (95 % interval ${interval.map((each) => each.toFixed(1)).join(" to ")})` : "")],
    ["missed", `${missed} of ${known}`],
    ["moving", `${percent(moving)} of the time`],
    ["waits for", waits.map(([reason, share]) => `${reason} ${percent(share)}`).join(", ") || "nothing"],
    ["simulated", `${minutes.toFixed(2)} min, ${seeds.length > 1 ? `seeds ${seeds[0]} to ${seeds.at(-1)}` : `seed ${seeds[0]}`}`],
  ];
  const list = document.createElement("dl");
  list.append(...rows.map(([name, value]) => {
    const row = document.createElement("div");
    row.append(element("dt", name), element("dd", value));
    return row;
  }));
  return list;
}

// Shows a result in place of the one before. `page` is empty where it has none; `framed` is called with the window of the
// player, `closed` when the figure is closed.
function show({ name, cell, found, page, framed, closed }) {
  if (shown) shown.figure.remove();
  const figure = document.createElement("figure");
  const caption = document.createElement("figcaption");
  const stale = element("span", "The cell has changed since.", "stale");
  stale.hidden = true;
  const close = element("button", "Close");
  close.addEventListener("click", () => {
    figure.remove();
    shown = null;
    closed();
  });
  const what = found.complete ? "simulated; below is the first run" : "simulated until it was ended";
  caption.append(element("strong", name), element("span", what), stale, element("span", "", "space"), close);
  const notes = found.notes.map((note) => element("p", note));
  figure.append(caption, element("p", found.bottleneck), figures(found), ...notes);
  if (page) {
    const frame = document.createElement("iframe");
    frame.title = `First run of ${name}`;
    frame.srcdoc = page;
    frame.addEventListener("load", () => framed(frame.contentWindow));
    figure.append(frame);
  }
  find("simulations").append(figure);
  shown = { figure, stale, cell };
}

// Marks the simulation that is shown, if the text of the cell is another one now.
export function compareCell(cell) {
  if (shown) shown.stale.hidden = shown.cell === cell;
}

// Whether a simulation of the cell as it is now is shown.
export const current = () => shown !== null && shown.stale.hidden;

// Has the service simulate the text of a cell, and shows the result. False where it was cancelled before there was any.
// Raises `Refused`.
export async function simulate(name, cell, framed, closed) {
  const question = { cell, minutes: find("minutes").valueAsNumber, seeds: find("seeds").valueAsNumber };
  const job = await followed("v1/simulations", question, tell);
  if (job.outcome === null) return false;
  const found = await (await ask(`${job.address}/answer`)).json();
  const page = job.state === "done" ? await (await ask(`${job.address}/page`)).text() : "";
  show({ name, cell, found, page, framed, closed });
  return true;
}
