// A job of the service: it is started, followed, and its progress drawn.
import { ask, Refused } from "./service.js";

const find = (id) => document.getElementById(id);
let running = null; // the address of the job that is worked on

export const searching = () => running !== null;

async function* events(address) {
  const response = await ask(`${address}/events`);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    const parts = (rest + value).split("\n\n");
    rest = parts.pop();
    for (const part of parts) {
      const data = part.split("\n").find((line) => line.startsWith("data: "));
      if (data) yield JSON.parse(data.slice(6));
    }
  }
}

// Shows what is done, with some figures of it: pairs of a name and a value. `durations`: of the best plan over time.
export function tellProgress(doing, rows = [], durations = []) {
  find("progress").hidden = false;
  find("hint").hidden = true;
  find("doing").textContent = doing;
  find("numbers").replaceChildren(...rows.map(([name, value]) => {
    const row = document.createElement("div");
    const term = document.createElement("dt");
    const description = document.createElement("dd");
    term.textContent = name;
    description.textContent = value;
    row.append(term, description);
    return row;
  }));
  drawBest(durations);
}

function drawBest(durations) {
  const canvas = find("best");
  canvas.hidden = durations.length < 2;
  if (canvas.hidden) return;
  const drawing = canvas.getContext("2d");
  const last = durations[durations.length - 1][0] || 1;
  const values = durations.map(([, value]) => value);
  const low = Math.min(...values), high = Math.max(...values);
  const at = ([t, value]) => [(t / last) * canvas.width, 8 + (1 - (value - low) / (high - low || 1)) * (canvas.height - 16)];
  drawing.clearRect(0, 0, canvas.width, canvas.height);
  drawing.strokeStyle = getComputedStyle(document.body).getPropertyValue("--blue");
  drawing.lineWidth = 3;
  drawing.beginPath();
  durations.forEach((each, k) => {
    const [x, y] = at(each);
    if (k) drawing.lineTo(x, at(durations[k - 1])[1]);
    drawing[k ? "lineTo" : "moveTo"](x, y);
  });
  drawing.stroke();
}

// Starts a job at an address, and gives it with its own `address` when it has ended. `tell` is called with its progress.
// Raises `Refused`.
export async function followed(start, question, tell) {
  const { id } = await (await ask(start, question)).json();
  const address = `v1/jobs/${id}`;
  running = address;
  try {
    for await (const job of events(address)) {
      if (job.state === "failed") throw new Refused(job.problem);
      if (job.state !== "working") return { ...job, address };
      if (!find("cancel").disabled) tell(job.progress);
    }
    throw new Refused({ detail: "The connection to the service was lost." });
  } finally {
    running = null;
  }
}

// The answer to a request, null where the search was cancelled. Raises `Refused`.
export async function searched(request) {
  const durations = [];
  const seconds = (value) => (value === null ? "none yet" : `${value.toFixed(3)} s`);
  const job = await followed("v1/jobs", request, (progress) => {
    if (progress === null) return tellProgress("Planning");
    if (progress.stage === "search" && progress.duration_s !== null)
      durations.push([progress.elapsed_s, progress.duration_s]);
    const looking = progress.stage === "relaxation";
    return tellProgress(looking ? "There is no plan; looking for a change that would help" : "Planning", [
      ["searched for", `${progress.elapsed_s.toFixed(1)} s`],
      ["candidates", String(progress.candidates)],
      ["steps passed", String(progress.steps)],
      ["best plan", seconds(progress.duration_s)],
      ["no plan takes less than", progress.lower_bound_s === null ? "not known" : seconds(progress.lower_bound_s)],
    ], durations);
  });
  return job.state === "cancelled" ? null : (await ask(`${job.address}/answer`)).json();
}

export async function cancel() {
  if (running === null) return;
  find("cancel").disabled = true;
  find("doing").textContent = "Cancelling";
  await ask(running, undefined, { method: "DELETE" });
}
