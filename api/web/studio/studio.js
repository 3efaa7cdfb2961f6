// The studio: a scenario is written, planned by the service, watched and compared. It asks the public HTTP API only, by
// addresses relative to this page, so that it works below any prefix.
const find = (id) => document.getElementById(id);
const text = find("text");
let running = null; // the job that is worked on: { address, stop }
let shown = null; // the answer that is shown: { name, request, answer, page, text, figure }
let planned = 0;
let basis = ""; // the scenario that was chosen last
let own = null; // the text that was written here, once there is one
let written = 0; // counts what changes the text
let key = sessionStorage.getItem("assur-key"); // of the service, if it asks for one; forgotten with this tab

class Refused extends Error {
  constructor(problem) {
    super(problem.detail || problem.title || "The service did not answer.");
    this.problem = problem;
  }
}

// True where there is another key than the one that was refused.
function askedForKey(refused) {
  if (key && refused !== `Bearer ${key}`) return true; // another request has asked meanwhile
  key = (prompt(key ? "The service does not know this key. Its key:" : "The service asks for a key:") || "").trim();
  if (key) sessionStorage.setItem("assur-key", key);
  else sessionStorage.removeItem("assur-key");
  return key !== "";
}

async function ask(address, body, method = body === undefined ? "GET" : "POST") {
  const headers = body === undefined ? {} : { "Content-Type": "application/json" };
  if (key) headers.Authorization = `Bearer ${key}`;
  let response;
  try {
    response = await fetch(address, { method, headers, body: body === undefined ? undefined : JSON.stringify(body) });
  } catch {
    throw new Refused({ detail: "The service cannot be reached." });
  }
  if (response.ok) return response;
  if (response.status === 401 && askedForKey(headers.Authorization)) return ask(address, body, method);
  let problem = { detail: `The service answered with status ${response.status}.` };
  try {
    problem = await response.json();
  } catch { /* what stands between answered in its own words */ }
  throw new Refused(problem);
}

// ---- the editor -------------------------------------------------------------------------------------------------

function number(faults = new Set()) {
  const count = text.value.split("\n").length;
  find("lines").replaceChildren(...Array.from({ length: count }, (_, k) => {
    const line = document.createElement("span");
    line.textContent = String(k + 1);
    line.classList.toggle("fault", faults.has(k + 1));
    return line;
  }));
  find("lines").scrollTop = text.scrollTop;
}

function goTo(line) {
  const before = text.value.split("\n").slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
  const length = (text.value.split("\n")[line - 1] || "").length;
  text.focus();
  text.setSelectionRange(before, before + length);
  text.scrollTop = Math.max(0, (line - 6) * 20);
}

function tellFaults(problem) {
  const errors = problem.errors || [];
  const paragraphs = errors.map((error) => {
    const paragraph = document.createElement("p");
    if (error.line) {
      const go = document.createElement("button");
      go.textContent = `line ${error.line}`;
      go.addEventListener("click", () => goTo(error.line));
      paragraph.append(go);
    }
    const got = error.value === undefined ? "" : `: got ${JSON.stringify(error.value)}`;
    paragraph.append(`${error.field}${got}; allowed: ${error.allowed}`);
    return paragraph;
  });
  if (!errors.length) {
    const paragraph = document.createElement("p");
    paragraph.textContent = problem.detail || problem.title;
    paragraphs.push(paragraph);
  }
  find("faults").replaceChildren(...paragraphs);
  number(new Set(errors.map((error) => error.line)));
}

function forget() {
  find("faults").replaceChildren();
  find("note").textContent = "";
  number();
}

// What is written is kept as the text of one's own, so that choosing a scenario loses nothing.
function changed() {
  own = text.value;
  find("scenario").value = "";
  forget();
  tellStale();
  examine();
}

function nameOf() {
  return find("scenario").value || (basis ? `${basis}, changed` : "own text");
}

// Whether the answer that is shown is of the text as it is now.
function tellStale() {
  if (shown) shown.stale.hidden = shown.text === text.value;
}

// Faults are told while one writes, once nothing has been typed for a moment.
const MOMENT_MS = 600;
async function examine() {
  const of = (written += 1);
  await new Promise((resolve) => setTimeout(resolve, MOMENT_MS));
  if (of !== written || running) return;
  try {
    await ask("v1/scenes/parse", { text: text.value });
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    if (of === written && !running) tellFaults(error.problem);
  }
}

// ---- planning ---------------------------------------------------------------------------------------------------

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

function tellProgress(doing, progress, durations) {
  find("progress").hidden = false;
  find("hint").hidden = true;
  find("doing").textContent = doing;
  const seconds = (value) => (value === null ? "none yet" : `${value.toFixed(3)} s`);
  const rows = progress === null ? [] : [
    ["searched for", `${progress.elapsed_s.toFixed(1)} s`],
    ["candidates", String(progress.candidates)],
    ["steps passed", String(progress.steps)],
    ["best plan", seconds(progress.duration_s)],
    ["no plan takes less than", progress.lower_bound_s === null ? "not known" : seconds(progress.lower_bound_s)],
  ];
  find("numbers").replaceChildren(...rows.map(([name, value]) => {
    const row = document.createElement("div");
    const term = document.createElement("dt");
    const told = document.createElement("dd");
    term.textContent = name;
    told.textContent = value;
    row.append(term, told);
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

async function searched(request, job) {
  const durations = [];
  for await (const told of events(job.address)) {
    const { progress } = told;
    if (progress && progress.stage === "search" && progress.duration_s !== null)
      durations.push([progress.elapsed_s, progress.duration_s]);
    const looking = progress && progress.stage === "relaxation";
    tellProgress(looking ? "There is no plan; looking for a change that would help" : "Planning", progress, durations);
    if (told.state === "cancelled") return null;
    if (told.state === "failed") throw new Refused(told.problem);
    if (told.state === "done") return (await ask(`${job.address}/answer`)).json();
  }
  return running === job ? Promise.reject(new Refused({ detail: "The connection to the service was lost." })) : null;
}

async function plan() {
  if (running) return;
  forget();
  written += 1; // what is examined now is of no use any more
  const [given, name, begun] = [text.value, nameOf(), Date.now()];
  busy(true);
  try {
    const { request, about } = await (await ask("v1/scenes/parse", { text: given })).json();
    const told = await (await ask("v1/jobs", request)).json();
    running = { address: `v1/jobs/${told.id}` };
    const answer = await searched(request, running);
    if (answer === null) {
      const after = ((Date.now() - begun) / 1000).toFixed(1);
      find("note").textContent = `Cancelled after ${after} s; no plan is kept. To end sooner with the best plan that is `
        + "found, set a smaller budget_s or max_candidates.";
      return;
    }
    tellProgress("Drawing", null, []);
    planned += 1;
    const title = `${name} ${planned}`;
    const page = await (await ask("v1/plans/report", { request, plan: answer, title, about })).text();
    show({ name: title, title, about, request, answer, page, text: given });
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    tellFaults(error.problem);
  } finally {
    running = null;
    busy(false);
  }
}

function busy(is) {
  find("plan").disabled = is;
  find("cancel").hidden = !is;
  find("cancel").disabled = false;
  if (!is) find("progress").hidden = true;
  find("hint").hidden = is || shown !== null;
}

async function cancel() {
  if (!running) return;
  find("cancel").disabled = true;
  find("doing").textContent = "Cancelling";
  try {
    await ask(running.address, undefined, "DELETE");
  } catch (error) {
    tellFaults(error.problem); // it has ended meanwhile, or is lost
  }
}

// ---- answers ----------------------------------------------------------------------------------------------------

function show(made) {
  find("hint").hidden = true;
  if (shown && !shown.kept) shown.figure.remove();
  const figure = document.createElement("figure");
  const caption = document.createElement("figcaption");
  const name = document.createElement("strong");
  name.textContent = made.name;
  const { answer } = made;
  const what = document.createElement("span");
  what.textContent = answer.status === "planned" ? `planned, ${answer.duration_s.toFixed(3)} s` : answer.sentence;
  const stale = document.createElement("span");
  stale.className = "stale";
  stale.textContent = "The text has changed since.";
  const space = document.createElement("span");
  space.className = "space";
  const close = document.createElement("button");
  close.textContent = "Close";
  close.addEventListener("click", () => {
    figure.remove();
    if (shown !== null && shown.figure === figure) shown = null;
    settle();
  });
  caption.append(name, what, stale, space, close);
  const frame = document.createElement("iframe");
  frame.title = `Answer to ${made.name}`;
  frame.srcdoc = made.page;
  figure.append(caption, frame);
  find("answers").append(figure);
  shown = { ...made, figure, stale, kept: false };
  tellStale();
  settle();
}

function settle() {
  find("keep").disabled = shown === null || shown.kept;
  find("save").disabled = shown === null;
  find("formats").disabled = shown === null || shown.answer.status !== "planned";
  document.querySelector(".together").hidden = find("answers").children.length < 2;
  find("hint").hidden = find("answers").children.length > 0 || running !== null;
}

function keep() {
  for (const figure of [...find("answers").children]) if (figure !== shown.figure) figure.remove();
  shown.kept = true;
  settle();
}

// What is moved in one player moves the others, if they are to have one clock.
let times = [];
function follow() {
  const players = [...document.querySelectorAll("iframe")].map((frame) => frame.contentWindow.assur).filter(Boolean);
  if (players.length > 1 && find("together").checked) {
    const moved = players.findIndex((player, k) => player.t !== times[k]);
    if (moved >= 0 && times.length === players.length)
      players.forEach((player, k) => k !== moved && player.seek(players[moved].t));
  }
  times = players.map((player) => player.t);
  requestAnimationFrame(follow);
}

// ---- files ------------------------------------------------------------------------------------------------------

const FORMATS = { // words for the formats of exports; one that is not here goes by its own name
  csv: "CSV", ros2: "ROS 2 (YAML)", "ros2-json": "ROS 2 (JSON)", glb: "3D model (GLB)",
  spel: "SPEL+ (recipe)", melfa: "MELFA-BASIC (recipe)",
};

async function offerFormats() {
  const { components } = await (await ask("openapi.json")).json();
  const formats = components.schemas.ExportQuestion.properties.format.enum;
  find("formats").append(...formats.map((format) => new Option(FORMATS[format] || format, `export:${format}`)));
}

async function exported(made, format) {
  const { request, answer } = made;
  const { file, encoding, ending } = await (await ask("v1/plans/export", { request, plan: answer, format })).json();
  const content = encoding === "base64" ? Uint8Array.from(atob(file), (letter) => letter.charCodeAt(0)) : file;
  return [content, ending === format ? "" : `-${format}`, ending];
}

async function fileOf(made, what) {
  const { request, answer, title, about } = made;
  if (what.startsWith("export:")) return exported(made, what.slice("export:".length));
  const json = (document) => [JSON.stringify(document), `-${what}`, "json"];
  if (what === "plan") return json({ schema: "assur-plan/1", title, about, request, plan: answer });
  if (what === "answer") return json(answer);
  if (what === "request") return json(request);
  return what === "report" ? [made.page, "", "html"] : [made.text, "", "yaml"];
}

async function save() {
  const { value } = find("save");
  const made = shown;
  find("save").value = "";
  if (!value || !made) return;
  find("save").disabled = true;
  try {
    const [content, part, ending] = await fileOf(made, value);
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([content], { type: "application/octet-stream" }));
    link.download = `${made.name.replaceAll(" ", "-")}${part}.${ending}`;
    link.click();
    URL.revokeObjectURL(link.href);
    find("faults").replaceChildren();
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    tellFaults(error.problem); // this format cannot hold the motion, and the service says why
  } finally {
    settle();
  }
}

async function choose() {
  const name = find("scenario").value;
  written += 1;
  if (name) {
    text.value = await (await ask(`v1/scenes/${name}/text`)).text();
    basis = name;
  } else text.value = own === null ? text.value : own;
  text.scrollTop = 0;
  forget();
  tellStale();
}

text.addEventListener("input", changed);
text.addEventListener("scroll", () => (find("lines").scrollTop = text.scrollTop));
find("plan").addEventListener("click", plan);
find("cancel").addEventListener("click", cancel);
find("keep").addEventListener("click", keep);
find("save").addEventListener("change", save);
find("scenario").addEventListener("change", choose);
document.addEventListener("keydown", (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) plan();
});

const { scenes } = await (await ask("v1/scenes")).json();
await offerFormats();
find("scenario").append(new Option("own text", ""), ...scenes.map(({ name }) => new Option(name, name)));
find("scenario").value = "demo";
await choose();
follow();
document.documentElement.dataset.ready = "yes";
