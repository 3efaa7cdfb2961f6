// The page: one clock, and all that follows it.
import { Camera, steer } from "./camera.js";
import { charts } from "./charts.js";
import { Grip } from "./grip.js";
import { Labels } from "./labels.js";
import { clamp } from "./numbers.js";
import { Renderer } from "./renderer.js";
import { census, Timeline } from "./timeline.js";
import { Tracks } from "./tracks.js";

// Frames that take longer than this on average, s, have fewer pixels while the motion plays; so few at the least.
const SLOW_S = 0.045;
const LEAST_SHARE = 0.4;
// A pointer that moves by more than this is no click.
const CLICK_PX = 4;
const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2];
const KINDS = { robot: "robot", tool: "tool", part: "parts", body: "bodies", neighbour: "other robots" };
const find = (id) => document.getElementById(id);

function refusal(host, view, seek) {
  const { refusal: why } = view;
  if (!why) return;
  host.hidden = false;
  const sentence = document.createElement("p");
  sentence.className = "sentence";
  sentence.textContent = why.sentence;
  host.append(sentence);
  if (why.met) {
    const met = document.createElement("p");
    const when = why.at_s === null ? "" : `, first at ${(view.start_s + why.at_s).toFixed(3)} s`;
    met.textContent = `Too near: ${why.met.join(" and ")}${when}.`;
    host.append(met);
    if (why.at_s !== null) {
      const go = document.createElement("button");
      go.textContent = "Show this instant";
      go.addEventListener("click", () => seek(why.at_s));
      host.append(go);
    }
  }
  if (why.helps) {
    const helps = document.createElement("p");
    helps.textContent = `This change was tried and works: ${why.helps}.`;
    host.append(helps);
  }
  census(host, view);
}

// An element of the page without what is in it, and without what listens to it.
function emptied(id) {
  const [old, fresh] = [find(id), find(id).cloneNode(false)];
  old.replaceWith(fresh);
  return fresh;
}

class Player {
  constructor() {
    this.view = null;
    this.t = 0;
    this.speed = 0.25;
    this.playing = false;
    this.show = { path: true, points: true, pair: true, unknown: false, clearance: false };
    this.canvas = find("stage");
    this.renderer = new Renderer(this.canvas);
    this.camera = new Camera();
    this.charts = [];
    this.moved = null; // called with what was moved in the view from above, by a page that can write it
    this.grip = new Grip(this);
    steer(this.canvas, this.camera, () => this.draw(), this.grip);
    this.picked = null; // called with the body that was clicked, by a page that has one to tell
    this.canvas.addEventListener("pointerdown", ({ clientX, clientY }) => (this.pressed = [clientX, clientY]));
    this.canvas.addEventListener("click", (event) => this.pick(event));
    for (const type of ["pointermove", "pointerleave"]) this.canvas.addEventListener(type, (event) => this.point(event));
    this.controls();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.resized = new ResizeObserver(() => this.charts.forEach((chart) => chart.draw(this.t)));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.restyle());
  }

  // Plays a view from now on. `still`: the camera stays where it is, if there is one, and so does the clock.
  take(view, still = false) {
    this.pause();
    this.grip.leave();
    const known = this.view !== null && still;
    this.view = view;
    this.tracks = new Tracks(view);
    this.renderer.take(this.tracks);
    this.camera.box = this.renderer.box;
    if (!known) this.camera.look("perspective");
    const seek = (t) => this.seek(t);
    this.resized.disconnect();
    this.charts = charts(emptied("charts"), this.tracks, seek);
    for (const chart of this.charts) this.resized.observe(chart.canvas);
    this.timeline = new Timeline(emptied("timeline"), this.tracks, seek);
    this.labels = new Labels(this.renderer, this.tracks, this.camera, emptied("labels"));
    document.querySelector("aside").hidden = !view.curves && !view.refusal;
    find("refusal").hidden = true;
    refusal(emptied("refusal"), view, seek);
    this.legend(emptied("legend"));
    find("time").max = String(view.lasts_s);
    const met = view.refusal && view.refusal.at_s;
    this.seek(known ? this.t : met || 0);
  }

  legend(host) {
    const kinds = new Set(this.view.bodies.map((body) => body.kind));
    for (const [kind, name] of Object.entries(KINDS)) {
      if (!kinds.has(kind)) continue;
      const item = document.createElement("span");
      item.className = `swatch of-${kind}`;
      item.textContent = this.view.candidate && kind === "robot" ? "best candidate" : name;
      host.append(item);
    }
  }

  controls() {
    const times = find("time");
    times.addEventListener("input", () => this.seek(Number(times.value)));
    find("play").addEventListener("click", () => this.toggle());
    find("back").addEventListener("click", () => this.step(-1));
    find("next").addEventListener("click", () => this.step(1));
    const speed = find("speed");
    for (const value of SPEEDS) speed.append(new Option(`${value} ×`, String(value), false, value === this.speed));
    speed.addEventListener("change", () => (this.speed = Number(speed.value)));
    document.querySelectorAll("[data-view]").forEach((button) =>
      button.addEventListener("click", () => this.look(button.dataset.view)),
    );
    document.querySelectorAll("[data-show]").forEach((box) => {
      box.checked = this.show[box.dataset.show];
      box.addEventListener("change", () => {
        this.show[box.dataset.show] = box.checked;
        this.draw();
      });
    });
    find("theme").addEventListener("click", () => this.changeTheme());
    document.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const of = event.target.closest("input, select, textarea, summary");
    if (of && !(of.type === "checkbox" && event.key !== " ")) return;
    const acts = {
      " ": () => this.toggle(),
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1),
      Home: () => this.seek(0),
      End: () => this.seek(this.view.lasts_s),
      "[": () => this.faster(-1),
      "]": () => this.faster(1),
      1: () => this.look("perspective"),
      2: () => this.look("top"),
      3: () => this.look("side"),
      4: () => this.look("front"),
    };
    if (!acts[event.key] || (event.key === " " && event.target.closest("button"))) return;
    event.preventDefault();
    acts[event.key]();
  }

  look(name) {
    this.camera.look(name);
    this.draw();
  }

  // Takes the `state` of another camera.
  see(state) {
    Object.assign(this.camera, state, { moved: true });
    this.draw();
  }

  // Marks bodies by their kind, or one by its name, and a control point by its step; nothing: none.
  mark({ kind, name } = {}) {
    const { bodies, control_points: points } = this.view;
    this.grip.chosen = kind ? { kind, name } : null;
    const is = (body) => (kind === "body" ? body.name === name && !["robot", "tool"].includes(body.kind) : body.kind === kind);
    this.renderer.chosen = [bodies.findIndex(is), bodies.findLastIndex(is)];
    this.labels.choose(kind === "step" ? points.findIndex(({ step }) => String(step) === name) : null);
    this.draw();
  }

  // A click that has not moved the camera.
  pick({ clientX, clientY }) {
    if (this.picked === null || Math.hypot(clientX - this.pressed[0], clientY - this.pressed[1]) > CLICK_PX) return;
    const { left, top } = this.canvas.getBoundingClientRect();
    const number = this.renderer.bodyAt(clientX - left, clientY - top);
    if (number >= 0) this.picked(this.view.bodies[number]);
  }

  // The name of the control point at the pointer is shown, also where others are.
  point({ type, clientX, clientY }) {
    if (this.view === null) return;
    const { left, top } = this.canvas.getBoundingClientRect();
    this.labels.pointer = type === "pointerleave" ? null : [clientX - left, clientY - top];
    this.labels.draw(this.t, this.show, this.tracks.nearest(this.t), this.playing);
  }

  faster(by) {
    const next = clamp(SPEEDS.indexOf(this.speed) + by, 0, SPEEDS.length - 1);
    this.speed = SPEEDS[next];
    find("speed").value = String(this.speed);
  }

  changeTheme() {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
    this.restyle();
  }

  restyle() {
    this.renderer.readTheme();
    this.charts.forEach((chart) => chart.forget());
    this.draw();
  }

  // Knots, or hundredths of the whole where nothing has knots.
  stops() {
    if (this.tracks.curves) return Array.from(this.tracks.curves.knots);
    return Array.from({ length: 101 }, (_, k) => (k / 100) * this.view.lasts_s);
  }

  step(by) {
    this.pause();
    const stops = this.stops();
    const next = by > 0 ? stops.find((t) => t > this.t + 1e-6) : stops.findLast((t) => t < this.t - 1e-6);
    if (next !== undefined) this.seek(next);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.t >= this.view.lasts_s - 1e-6) this.t = 0;
    this.playing = true;
    this.last = null;
    this.frames = { count: 0, seconds: 0 };
    find("play").classList.add("on");
    find("play").setAttribute("aria-label", "Pause");
    requestAnimationFrame((now) => this.frame(now));
  }

  pause() {
    this.playing = false;
    find("play").classList.remove("on");
    find("play").setAttribute("aria-label", "Play");
    if (this.renderer.share < 1) this.sharp();
  }

  sharp() {
    this.renderer.share = 1;
    this.draw();
  }

  frame(now) {
    if (!this.playing) return;
    const since = this.last === null ? 0 : Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    this.keepUp(since);
    this.t = Math.min(this.view.lasts_s, this.t + since * this.speed);
    this.draw();
    if (this.t >= this.view.lasts_s) this.pause();
    else requestAnimationFrame((next) => this.frame(next));
  }

  keepUp(since) {
    this.frames.count += 1;
    this.frames.seconds += since;
    if (this.frames.count < 6) return;
    if (this.frames.seconds / this.frames.count > SLOW_S)
      this.renderer.share = Math.max(LEAST_SHARE, 0.75 * this.renderer.share);
    this.frames = { count: 0, seconds: 0 };
  }

  seek(t) {
    this.t = clamp(t, 0, this.view.lasts_s);
    this.draw();
  }

  draw() {
    if (this.view === null) return;
    const { t } = this;
    const pair = this.tracks.nearest(t);
    this.renderer.draw(t, this.camera, this.show, pair);
    this.labels.draw(t, this.show, pair, this.playing);
    this.charts.forEach((chart) => chart.draw(t));
    this.timeline.draw(t);
    find("time").value = String(t);
    find("now").textContent = (this.view.start_s + t).toFixed(3);
    const leg = this.tracks.leg(t);
    const point = leg && this.view.control_points[leg.step];
    const why = leg && leg.kind === "WAIT" && leg.note ? `: ${leg.note}` : "";
    find("leg").textContent = leg ? `${leg.kind}${point ? `, ${point.name}` : ""}${why}` : "the arm stands";
  }
}

try {
  if (window.self !== window.top) document.documentElement.dataset.within = "another page";
  const view = JSON.parse(find("view").textContent);
  // for tests, for who looks into a page with the tools of a browser, and for a page that has views of its own to play
  window.assur = new Player();
  if (view === null) document.documentElement.dataset.bare = "yes";
  else window.assur.take(view);
  document.documentElement.dataset.ready = "yes";
} catch (error) {
  find("failed").hidden = false;
  find("failed").textContent = `Nothing can be drawn here: ${error.message} The tables below need no graphics.`;
  console.error(error);
}
