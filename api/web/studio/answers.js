// The answers that are shown: one, or two that are compared and have one clock and one camera. What of them is saved.
import * as differences from "./differences.js";
import { fileName } from "./documents.js";
import * as drawing from "./drawing.js";
import { ask } from "./service.js";
import * as simulations from "./simulations.js";

const find = (id) => document.getElementById(id);
let shown = null; // the answer that was shown last: { name, request, answer, about, page, text, figure, stale, proposal, kept }
let other = null; // the answer that is kept, with which it is compared
let count = 0;

function element(kind, text, className = "") {
  const made = document.createElement(kind);
  made.textContent = text;
  made.className = className;
  return made;
}

// Shows an answer: { name, request, answer, about, page, text, unwritten }. `text` is the scenario that it is the answer
// to, `unwritten` why the change that it proposes cannot be written there.
// `framed` is called with the window of the player, `apply` with the values of a change that would help.
export function show(made, framed, apply) {
  if (shown && !shown.kept) shown.figure.remove();
  count += 1;
  const { answer } = made;
  const figure = document.createElement("figure");
  const caption = document.createElement("figcaption");
  const what = answer.status === "planned" ? `planned, ${answer.duration_s.toFixed(3)} s` : answer.sentence;
  const stale = element("span", "The text has changed since.", "stale");
  stale.hidden = true;
  const close = element("button", "Close");
  close.addEventListener("click", () => {
    figure.remove();
    if (shown !== null && shown.figure === figure) shown = null;
    if (other !== null && other.figure === figure) other = null;
    settle();
  });
  caption.append(element("strong", made.name), element("span", `answer ${count}: ${what}`), stale, element("span", "", "space"), close);
  const frame = document.createElement("iframe");
  frame.title = `Answer to ${made.name}`;
  frame.srcdoc = made.page;
  frame.addEventListener("load", () => framed(frame.contentWindow));
  const proposal = proposed(answer, made.unwritten, apply);
  figure.append(caption, ...(proposal ? [proposal] : []), frame);
  find("answers").append(figure);
  shown = { ...made, figure, stale, proposal, kept: false };
  settle();
}

// What would not help, where no change works; null: nothing was tried, and there was time for it.
function inVain({ tried = [], explain_budget_spent: spent = false }) {
  if (!tried.length && !spent) return null;
  const row = element("div", "", "proposal");
  const over = "the time for trying changes was over (explain_budget_s)";
  if (!tried.length) row.append(element("span", `What would help is not known: ${over}.`));
  else {
    const list = document.createElement("ul");
    list.append(...tried.map((change) => element("li", change)));
    row.append(element("span", "What would not help, each tried by itself:"), list);
    if (spent) row.append(element("span", `Others were not tried: ${over}.`));
  }
  return row;
}

// The change that was tried and works, and a button that writes it into the text, or `why` there is
// no button. Without such a change, what was tried; null: nothing was.
function proposed(answer, why, apply) {
  const { relaxation } = answer;
  if (!relaxation) return inVain(answer);
  const row = element("div", "", "proposal");
  row.append(element("span", `This change was tried and works: ${relaxation.what}: ${relaxation.value}.${why && ` ${why}`}`));
  if (relaxation.set && !why) {
    const button = element("button", "Apply");
    button.title = Object.entries(relaxation.set).map(([path, value]) => `${path} = ${JSON.stringify(value)}`).join("\n");
    button.addEventListener("click", () => apply(relaxation.set));
    row.append(button);
  }
  return row;
}

// Whether the answer that is shown is that of `text`.
export function compareText(text) {
  if (shown) {
    shown.stale.hidden = shown.text === text;
    find("of-answer").label = shown.stale.hidden ? "Answer" : "Answer to the text before its last change";
  }
  settle();
}

export function settle() {
  find("keep").disabled = shown === null || shown.kept;
  find("of-answer").disabled = shown === null;
  find("formats").disabled = shown === null || shown.answer.status !== "planned";
  document.querySelector(".together").hidden = find("answers").children.length < 2;
  find("differences").hidden = other === null || shown === null || shown === other;
  if (!find("differences").hidden) differences.fill(find("differences"), other, shown);
  const button = shown && shown.proposal && shown.proposal.querySelector("button");
  if (button) button.disabled = !shown.stale.hidden || find("plan").disabled; // of another text it says nothing
  drawing.settle((shown !== null && shown.stale.hidden) || simulations.current());
  const shows = ["answers", "simulations"].some((id) => find(id).children.length > 0);
  find("hint").hidden = !find("drawing").hidden || shows || !find("progress").hidden;
}

export function keep() {
  for (const figure of [...find("answers").children]) if (figure !== shown.figure) figure.remove();
  shown.kept = true;
  other = shown;
  settle();
}

// What is moved in one player moves the others, if they are to have one clock and one camera. A player that has just
// come takes the camera of the first one.
let [times, views] = [[], []];
export function follow() {
  const players = [...document.querySelectorAll("#answers iframe")].map((frame) => frame.contentWindow.assur).filter(Boolean);
  const view = (player) => JSON.stringify(player.camera.state);
  if (players.length > 1 && find("together").checked) {
    const known = times.length === players.length;
    const moved = known ? players.findIndex((player, k) => player.t !== times[k]) : -1;
    if (moved >= 0) players.forEach((player, k) => k !== moved && player.seek(players[moved].t));
    const turned = known ? players.findIndex((player, k) => view(player) !== views[k]) : 0;
    if (turned >= 0) players.forEach((player, k) => k !== turned && player.see(players[turned].camera.state));
  }
  times = players.map((player) => player.t);
  views = players.map(view);
  requestAnimationFrame(follow);
}

// ---- files ------------------------------------------------------------------------------------------------------

const FORMATS = { // words for the formats of exports; one that is not here goes by its own name
  csv: "CSV", ros2: "ROS 2 (YAML)", "ros2-json": "ROS 2 (JSON)", glb: "3D model (GLB)",
  spel: "SPEL+ (recipe)", melfa: "MELFA-BASIC (recipe)",
};

// Lists the formats. The longest time, s, that the service gives to look for a change that would help.
export async function offerFormats() {
  const { components } = await (await ask("openapi.json")).json();
  const formats = components.schemas.ExportQuestion.properties.format.enum;
  find("formats").replaceChildren(...formats.map((format) => new Option(FORMATS[format] || format, `export:${format}`)));
  return components.schemas.OptionsDocument.properties.explain_budget_s.maximum;
}

async function exported(made, format) {
  const { request, answer } = made;
  const { file, encoding, ending } = await (await ask("v1/plans/export", { request, plan: answer, format })).json();
  const content = encoding === "base64" ? Uint8Array.from(atob(file), (letter) => letter.charCodeAt(0)) : file;
  return [content, ending === format ? "" : `-${format}`, ending];
}

async function fileOf(made, what) {
  const { request, answer, name, about } = made;
  if (what.startsWith("export:")) return exported(made, what.slice("export:".length));
  const json = (document) => [JSON.stringify(document), `-${what}`, "json"];
  if (what === "plan") return json({ schema: "assur-plan/1", title: name, about, request, plan: answer });
  if (what === "answer") return json(answer);
  return what === "request" ? json(request) : [made.page, "", "html"];
}

// The file of what is offered of the answer: its content and its name. Raises `Refused` for a format that cannot hold it.
export async function saved(what) {
  const [content, part, ending] = await fileOf(shown, what);
  return [content, `${fileName(shown.name)}${part}.${ending}`];
}
