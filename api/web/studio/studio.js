// The studio: a scenario is written, planned by the service, watched and compared. It uses the public HTTP API only.
import * as answers from "./answers.js";
import { contentOf, fileName, kindOf, LONGEST_TEXT, nameOf, scenarioOf } from "./documents.js";
import * as drafts from "./drafts.js";
import * as drawing from "./drawing.js";
import { mark, number, replace, text } from "./editor.js";
import { fault, showFaults } from "./faults.js";
import { download, isDocument, offerLink, receiveFiles } from "./files.js";
import { History } from "./history.js";
import { cancel, searched, searching, tellProgress } from "./jobs.js";
import { heldBy, isLink, linkTo } from "./links.js";
import { besideOf, cellNameOf, cellOf, drawnWith, drawWithin, fileOf, partOf, readable, taskOf } from "./parts.js";
import { chooseAtCaret, know, placeOf, shownAs } from "./selection.js";
import { ask, enterKey, Refused } from "./service.js";
import * as simulations from "./simulations.js";

const find = (id) => document.getElementById(id);
let scenario = null; // the name of the shipped scenario that is shown unchanged
let changes = 0; // counts those of the text
let connected = false; // whether the service has sent its scenarios and formats
let kept = true; // whether the browser keeps the text as it is
const shipped = new Map(); // texts of shipped scenarios by name
const history = new History();

// ---- the editor -------------------------------------------------------------------------------------------------

const tellFaults = (problem) => showFaults(problem, besideOf(text.value), showBeside);

// The messages about the answer and its files; faults of the text are not touched.
function note(sentence, bad = false) {
  find("note").textContent = sentence;
  find("note").classList.toggle("bad", bad);
}

// Does what may be refused, and tells why it was, with `tell`.
async function attempt(act, tell = tellFaults) {
  try {
    return await act();
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    return tell(error.problem);
  }
}

function forget() {
  find("faults").replaceChildren();
  note("");
  number();
}

// While one writes the cell is drawn, and faults are shown, once nothing has been typed for a moment: a longer one for
// faults, which half a word has. One text is sent at a time; of those that wait the latest is.
const MOMENT_MS = 120;
const FAULT_MS = 600;
const after = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
let examined = null; // the promise of what is sent
let replaced = true; // whether the text is another one than that of the drawing, and no change of it

async function examine() {
  const of = (changes += 1);
  const latest = () => of === changes && !searching();
  const patient = after(FAULT_MS);
  await after(MOMENT_MS);
  await examined;
  if (!latest() || !text.value.trim()) return;
  examined = attempt(async () => {
    const { kind } = kindOf(text.value);
    if (kind !== "text") return note(`This is a ${kind} in JSON. Plan takes it.`);
    const question = { ...readable(text.value, scenario), draw: true };
    const { status, view, places: written } = await (await ask("v1/scenes/parse", question, { quiet: true })).json();
    if (!latest()) return undefined;
    drawing.show(view, !replaced, status === "cell");
    replaced = false;
    know(written);
    return answers.settle();
  }, (problem) => {
    if (latest() && problem.missing) drawing.leave(`The cell ${problem.missing} is missing. Open it, too: then this task is drawn.`);
    else if (latest() && replaced) drawing.leave("Nothing is drawn: the text has a fault.");
    else if (latest()) drawing.mark("The text has changed since, and has a fault.");
    answers.settle();
    patient.then(() => latest() && tellFaults(problem));
  });
  await examined;
}

// ---- what is drawn and where it is written ----------------------------------------------------------------------

// Selects the lines of a body that was clicked, in the text that has them. Keys go on to the picture.
function showPlace(body) {
  const place = placeOf(body);
  if (!place) return;
  if (place.written !== shownAs()) {
    const other = besideOf(text.value);
    if (other === null) return;
    showBeside(other);
    listTexts();
  }
  mark(place.begin, place.end);
  text.scrollIntoView({ block: "nearest" });
  chooseAtCaret();
}

// ---- changes that are not typed ---------------------------------------------------------------------------------

// Has the service write a change into the texts: { set }, values of the request, or { move }, a thing of the drawing.
// The text with a thing that was moved is shown. True if it is written. A note states why it is not.
async function write(change) {
  const given = text.value;
  return attempt(async () => {
    const made = await (await ask("v1/scenes/parse", { ...readable(given, scenario), ...change })).json();
    if (text.value !== given) throw new Refused({ detail: "The text has changed meanwhile. Nothing else is changed." });
    const [own, other] = [made[shownAs()], besideOf(given)];
    const there = other && made[partOf(other.text) === "cell" ? "cell" : "text"];
    if (other !== null && there !== other.text) rewriteBoth(own, other, there, "move" in change);
    else if (own !== given) rewrite(own);
    note("");
    return true;
  }, noteProblem);
}

function rewrite(content, also = null) {
  const same = content === text.value;
  replace(content);
  history.add(content, text.selectionEnd, null, also);
  if (same) tellText();
  else changed();
}

// Changes the text that is shown and the `other` one, of a task and its cell, in one step of undo. `turn`: the other one
// is shown then; the drawing is that of the task, as before. Raises `Refused`.
function rewriteBoth(own, other, there, turn) {
  if (!drafts.rewrite(other.id, other.text, there))
    throw new Refused({ detail: `${fileOf(other)} is not changed: another tab has changed it, or the browser does not keep it.` });
  if (turn) {
    drawWithin(partOf(other.text) === "cell" ? drafts.current() : other);
    drafts.open(other.id);
    text.value = other.text;
  }
  rewrite(turn ? there : own, { id: other.id, before: other.text, after: there });
}

// Changes are written in the order in which they are made.
let writing = Promise.resolve();
function moved(move) {
  writing = writing.catch(() => {}).then(() => write({ move })).then(() => examined);
  return writing;
}

// Why the change that a refusal proposes cannot be written into the texts that the service is to read; empty: it can,
// or nothing is proposed.
async function unwritten({ relaxation }, texts) {
  if (!relaxation) return "";
  if (!relaxation.set) {
    const by = relaxation.what === "without" ? "leaves out what is in the text" : "is this change and no other";
    return `There is no button: no value ${by}. Change the text by hand.`;
  }
  return attempt(async () => (await ask("v1/scenes/parse", { ...texts, set: relaxation.set }), ""),
    (problem) => (problem.errors ? `A button needs ${problem.errors[0].allowed}.` : problem.detail || problem.title));
}

async function apply(set) {
  if (await write({ set })) await plan();
}

const noteProblem = (problem) => note((problem.errors || []).map(fault).join(" ") || problem.detail || problem.title, true);

// ---- texts that are kept ----------------------------------------------------------------------------------------

// What an answer is an answer to: the text, and that of its cell.
function meant() {
  const { text: own, cell } = drawnWith(text.value);
  return JSON.stringify([own, cell]);
}

const name = () => scenario || nameOf(text.value, (drafts.current() || {}).file);

// Keeps the text, and tells where that is not as it should be. `as`: its file, if it is from one.
function keepText(as) {
  const state = drafts.keep(text.value, as);
  if (state !== "kept" || !kept) find("kept").textContent = {
    kept: "",
    parted: "Another tab has changed this text. What is written here is kept as a text of its own.",
    lost: "The browser does not keep this text: its storage is full or switched off. Save it as a file before you close "
      + "the page; or delete texts that are not needed.",
  }[state];
  kept = state !== "lost";
}

const label = ({ text: content, file, when }) =>
  `${nameOf(content, file)} (${new Date(when).toLocaleString([], { dateStyle: "short", timeStyle: "short" })})`;

function listTexts() {
  const here = drafts.current();
  const value = scenario || `text:${here ? here.id : ""}`;
  const own = drafts.all().map((draft) => new Option(label(draft), `text:${draft.id}`));
  if (value === "text:") own.unshift(new Option("own text", value));
  find("own").replaceChildren(...own);
  find("scenario").value = value;
  find("delete").hidden = here === null;
}

// After the text or what it is has changed: everything that follows it.
function tellText() {
  const here = drafts.current();
  if (here && find("scenario").value === `text:${here.id}`) find("scenario").selectedOptions[0].textContent = label(here);
  else listTexts();
  const search = scenario ? `?scenario=${encodeURIComponent(scenario)}` : location.pathname;
  if (scenario || location.search) window.history.replaceState(null, "", search);
  forget();
  offerCell();
  find("simulation").hidden = partOf(text.value) === "scenario";
  simulations.compareCell(drawnWith(text.value).cell || text.value);
  answers.compareText(meant());
  examine();
}

// A text that undo or redo brought back is what it was before, if it is kept or shipped.
function returned() {
  const draft = drafts.all().find((each) => each.text === text.value);
  const [same = null] = [...shipped].find(([, content]) => content === text.value) || [];
  if (!draft && !same) return false;
  drafts.open(draft ? draft.id : null);
  scenario = draft ? null : same;
  return true;
}

function written({ inputType = null }) {
  history.add(text.value, text.selectionEnd, /^(insertText|deleteContent\w+)$/.test(inputType) ? inputType : null);
  changed();
}

function changed() {
  scenario = null;
  if (text.value.trim() || drafts.current()) keepText();
  tellText();
}

// Undo (-1) and redo (+1).
function step(by) {
  const found = history.step(by);
  if (found === null) return;
  const { also } = found;
  const changedElsewhere = also !== null && !drafts.rewrite(also.id, also.from, also.to);
  text.value = found.text;
  text.setSelectionRange(found.caret, found.caret);
  if (returned()) tellText();
  else changed();
  if (changedElsewhere) note("The text that was changed with this one has changed since. It is left as it is.", true);
}

// Replaces the whole text; undo brings back what was there. `task`: the drawing is that of this task, as before.
function put(content, task = null) {
  const left = drafts.current();
  if (left && !left.text.trim()) drafts.remove();
  text.value = content;
  history.add(text.value, 0);
  drawWithin(task);
  replaced = replaced || task === null;
  find("kept").textContent = "";
  text.setSelectionRange(0, 0);
  text.scrollTop = 0;
}

async function showScenario(chosen) {
  if (!shipped.has(chosen)) shipped.set(chosen, await (await ask(`v1/scenes/${encodeURIComponent(chosen)}/text`)).text());
  put(shipped.get(chosen));
  drafts.open(null);
  scenario = chosen;
  tellText();
}

// Shows a text that comes from a file, a link or the clipboard, and keeps it.
function showOwn(content, file) {
  const lines = content.replace(/\r\n?/g, "\n");
  const crlf = lines.length < content.length && !/(^|[^\r])\n/.test(content);
  put(lines);
  const same = drafts.all().find((each) => each.text === text.value && [null, each.file || file].includes(file));
  drafts.open(same ? same.id : null);
  scenario = null;
  keepText(same && file === null ? same : { file, crlf });
  tellText();
}

async function choose() {
  const { value } = find("scenario");
  await attempt(async () => {
    if (!value.startsWith("text:")) return showScenario(value);
    const draft = drafts.all().find(({ id }) => `text:${id}` === value);
    const beside = besideOf(text.value);
    if (draft && beside && draft.id === beside.id) return showBeside(draft);
    return draft ? showDraft(draft) : tellText();
  });
  listTexts();
}

function showDraft(draft, task = null) {
  put(draft.text, task);
  drafts.open(draft.id);
  scenario = null;
  tellText();
}

// Shows the other text of a task and its cell, in the drawing of the task.
const showBeside = (draft) => showDraft(draft, partOf(draft.text) === "cell" ? drafts.current() : draft);

async function remove() {
  drafts.remove();
  await attempt(() => showScenario("demo"), (problem) => {
    put("");
    tellText();
    tellFaults(problem);
  });
  note("The text is deleted. Undo brings it back.");
}

// ---- planning ---------------------------------------------------------------------------------------------------

// Files that are dropped on a player, and keys that are not its own, are those of the page.
function framed(frame) {
  receiveFiles(frame, openFiles);
  frame.addEventListener("keydown", pressed);
}

const drawn = async (body) => (await ask("v1/plans/report", body)).text();

// The request with a full report and time to look for a change that would help, where it states none. Wrong options stay
// for the service to refuse.
let explainS = 1;
function reported(request) {
  const { options = {} } = request;
  if (options?.constructor !== Object) return request;
  const explain = "explain_budget_ms" in options ? {} : { explain_budget_s: explainS };
  return { ...request, options: { report: "full", ...explain, ...options } };
}

// Does what the service works on, if it does nothing else. `act` is given how to say that it was cancelled.
async function work(act) {
  if (find("plan").disabled) return;
  forget();
  changes += 1; // what is examined now is of no use any more
  const begun = Date.now();
  busy(true);
  scrollTo(0, 0);
  await attempt(async () => {
    await connect();
    await act((rest) => note(`Cancelled after ${((Date.now() - begun) / 1000).toFixed(1)} s; ${rest}`));
  });
  busy(false);
}

const plan = () => work(async (cancelled) => {
  if (kindOf(text.value).kind !== "text" && (await take(text.value))) return;
  const task = taskOf(text.value);
  const [given, title] = [meant(), task ? nameOf(task.text, task.file) : name()];
  const texts = readable(text.value, scenario);
  const { request: read, about } = await (await ask("v1/scenes/parse", texts)).json();
  if (read === undefined) throw new Refused({ detail: "This is a cell. A task is planned: a text of assur-task/1 that names the file of this cell." });
  const request = reported(read);
  const answer = await searched(request);
  if (answer === null) {
    cancelled("no plan is kept. To end sooner with the best plan so far, set a smaller budget_s or max_candidates.");
    return;
  }
  tellProgress("Drawing");
  const page = await drawn({ request, plan: answer, title, about });
  const why = await unwritten(answer, texts);
  answers.show({ name: title, about, request, answer, page, text: given, unwritten: why }, framed, apply);
  answers.compareText(meant());
});

// Simulates the cell of the text, which has to be here.
const simulate = () => work(async (cancelled) => {
  const { cell } = drawnWith(text.value);
  if (cell === null && partOf(text.value) === "task")
    throw new Refused({ detail: "The cell of this task is not open here. A cell with streams is simulated: open its file." });
  const own = cellOf(text.value);
  const title = own === null ? name() : nameOf(own.text, own.file);
  const made = await simulations.simulate(title, cell === null ? text.value : cell, framed, answers.settle);
  simulations.compareCell(drawnWith(text.value).cell || text.value);
  if (!made) cancelled("nothing was simulated yet.");
});

function busy(is) {
  find("plan").disabled = is;
  find("simulate").disabled = is;
  find("cancel").hidden = !is;
  find("cancel").disabled = false;
  if (!is) find("progress").hidden = true;
  answers.settle();
}

// ---- files ------------------------------------------------------------------------------------------------------

// Takes the content of a file or of the clipboard: a scenario as it is, a request as a scenario, a plan file as both its
// scenario and its plan. True for a plan file.
async function take(content, file = null) {
  const found = kindOf(content);
  const from = `Opened from ${file || "the clipboard"}.`;
  const task = cellNameOf(text.value) !== null && cellOf(text.value) === null ? drafts.current() : null; // its cell is missing
  if (found.kind === "text") {
    showOwn(content, file);
    if (task !== null && cellOf(task.text) !== null) showDraft(task);
  } else {
    const stem = file === null ? found.title : nameOf("", file);
    const made = scenarioOf(found.request, found.about || found.title || from);
    const page = found.kind === "plan" ? await drawn(content) : null;
    if (made.length <= LONGEST_TEXT) showOwn(made, stem ? `${fileName(stem)}.yaml` : null);
    else if (page === null) throw new Refused({ detail: `The request has ${made.length} characters, too many for this page.` });
    if (page === null) return false;
    const { request, plan: answer, about, title } = found;
    const of = made.length <= LONGEST_TEXT ? meant() : made;
    const why = await unwritten(answer, { text: made });
    answers.show({ name: title || nameOf(made, file), about, request, answer, page, text: of, unwritten: why }, framed, apply);
    answers.compareText(meant());
    if (made.length > LONGEST_TEXT) note("The plan is shown. Its request is too long for the editor: it has meshes or other long parts.");
    return true;
  }
  return false;
}

async function openFiles(files) {
  if (files.length) await attempt(async () => {
    const both = await Promise.all(files.slice(0, 2).map(async (file) => [await contentOf(file), file.name]));
    const order = both.sort(([a], [b]) => partOf(a).localeCompare(partOf(b))); // the cell before the task
    if (files.length > 1 && (files.length > 2 || order.map(([each]) => partOf(each)).join() !== "cell,task"))
      throw new Refused({ detail: `These are ${files.length} files. Open one at a time, or a cell and a task.` });
    for (const [content, file] of order) await take(content, file);
  });
  find("file").value = "";
}

function pasted(event) {
  const [content, files] = [event.clipboardData.getData("text/plain"), event.clipboardData.files];
  if (!isDocument(content, files, text)) return;
  event.preventDefault();
  if (content) attempt(() => take(content));
  else openFiles([...files]);
}

async function save() {
  const { value } = find("save");
  find("save").value = "";
  if (!value) return;
  find("save").disabled = true;
  note("");
  await attempt(async () => {
    const cell = cellOf(text.value);
    if (value === "link") {
      const { text: whole, cell: its } = drawnWith(text.value);
      return note(await offerLink(await linkTo(whole, its), its === null ? "the text as it is" : "the task and its cell as they are"));
    }
    const own = { text: textFile, cell: () => [crlfOf(cell)(cell.text), fileOf(cell)] };
    const [content, file] = value in own ? own[value]() : await answers.saved(value);
    download(content, file);
    if (value === "text") kept = true;
    return undefined;
  }, noteProblem);
  find("save").disabled = false;
}

// Shows what the link in the address holds, as if it were opened from files, and takes it out of the address. Whether it
// was a link that could be shown. A link that cannot is named by `refuse`.
async function openLink(refuse) {
  const { hash } = location;
  if (!isLink(hash)) return false;
  window.history.replaceState(null, "", location.pathname + location.search);
  return attempt(async () => {
    const { text: content, cell, file } = await heldBy(hash);
    if (cell !== null) showOwn(cell, file);
    showOwn(content, null);
    return true;
  }, (problem) => (refuse(problem.detail), false));
}

// The text as it is seen, and the name of its file.
function textFile() {
  const draft = drafts.current() || {};
  return [crlfOf(draft)(text.value), draft.file || `${fileName(name())}.yaml`];
}

const crlfOf = ({ crlf = false }) => (content) => (crlf ? content.replaceAll("\n", "\r\n") : content);

// A task is saved, and so is its cell.
function offerCell() {
  const offered = find("of-text").querySelector("[value=cell]");
  if (offered) offered.remove();
  if (cellOf(text.value) !== null) find("of-text").append(new Option("cell (YAML)", "cell"));
}

// ---- keys -------------------------------------------------------------------------------------------------------

function pressed(event) {
  if (!(event.ctrlKey || event.metaKey) || event.target.matches("#key, #link")) return;
  const key = event.key.toLowerCase();
  if (key === "enter") plan();
  if (key !== "z" && key !== "y") return;
  event.preventDefault();
  step(key === "z" && !event.shiftKey ? -1 : 1);
}

// ---- the page ---------------------------------------------------------------------------------------------------

// The lists of scenarios and formats. Raises `Refused`.
async function connect(quiet = false) {
  if (connected) return;
  const { scenes } = await (await ask("v1/scenes", undefined, { quiet })).json();
  const [mostS] = await Promise.all([answers.offerFormats(), drawing.begin(framed, showPlace, moved)]);
  explainS = Math.min(explainS, mostS);
  answers.settle();
  find("shipped").replaceChildren(...scenes.map((each) => new Option(each.name, each.name)));
  connected = true;
  listTexts();
}

// A text that is there already; else the scenario in the address; else the text that was written here last; else the demo.
async function begin(there = text.value !== "") {
  const wanted = there ? null : new URLSearchParams(location.search).get("scenario");
  const draft = there || wanted !== null ? null : drafts.begin();
  if (draft) {
    put(draft.text);
    tellText();
  }
  await connect();
  if (wanted !== null) await attempt(() => showScenario(wanted), (problem) => {
    window.history.replaceState(null, "", location.pathname);
    return begin().then(() => tellFaults(problem));
  });
  else if (!draft && !text.value) await showScenario("demo");
}

text.addEventListener("input", written);
text.addEventListener("beforeinput", (event) => { // by a menu of the browser
  if (!event.inputType.startsWith("history")) return;
  event.preventDefault();
  step(event.inputType === "historyUndo" ? -1 : 1);
});
text.addEventListener("paste", pasted);
document.addEventListener("selectionchange", () => document.activeElement === text && chooseAtCaret());
text.addEventListener("scroll", () => (find("lines").scrollTop = text.scrollTop));
find("plan").addEventListener("click", plan);
find("simulate").addEventListener("click", simulate);
find("cancel").addEventListener("click", () => attempt(cancel)); // the job may have ended meanwhile
find("keep").addEventListener("click", () => {
  answers.keep();
  note("This answer is kept. Press Plan: the next answer is shown next to it.");
});
find("save").addEventListener("change", save);
find("scenario").addEventListener("change", choose);
find("open").addEventListener("click", () => find("file").click());
find("file").addEventListener("change", () => openFiles([...find("file").files]));
find("delete").addEventListener("click", remove);
find("undo").addEventListener("click", () => step(-1));
find("enter").addEventListener("click", async () => (await enterKey()) && attempt(connected ? () => {} : () => begin()));
receiveFiles(window, openFiles);
document.addEventListener("keydown", pressed);
addEventListener("beforeunload", (event) => kept || event.preventDefault());
drafts.watch(() => keepText(), listTexts);

let broken = "";
const opened = await openLink((why) => (broken = why));
await attempt(() => begin(opened));
if (broken) note(broken, true);
addEventListener("hashchange", () => openLink((why) => note(why, true)).then(listTexts));
listTexts();
number();
answers.follow();
document.documentElement.dataset.ready = "yes";
