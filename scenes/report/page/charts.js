// Diagrams over time, all with the same time axis and the same cursor.
import { clamp } from "./numbers.js";

const LEFT = 46;
const RIGHT = 10;
const TOP = 8;
const BOTTOM = 16;

function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// Round numbers between two values, some four of them.
export function ticks(low, high, count = 4) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((k) => k * power).find((k) => k >= rough * 0.999);
  const found = [];
  for (let value = Math.ceil(low / step - 1e-9) * step; value <= high + 1e-9 * step; value += step) found.push(value);
  return found.map((value) => (Math.abs(value) < step / 1e6 ? 0 : value));
}

// One diagram. `lines`: {times, value(k), colour}; `bands`: {from, to, value, colour} of what must not be fallen below;
// `low`, `high`: the ends of its axis; `limits`: values at which a line is drawn; `readout(t)`: spans of text.
export class Chart {
  constructor(host, { title, unit, lines, low, high, limits = [], bands = [], readout }, lasts, seek) {
    this.set = { lines, low, high, limits, bands, readout, unit };
    this.lasts = lasts;
    const figure = document.createElement("figure");
    figure.className = "chart";
    const caption = document.createElement("figcaption");
    const name = document.createElement("span");
    name.textContent = title;
    this.values = document.createElement("span");
    this.values.className = "values";
    caption.append(name, this.values);
    this.canvas = document.createElement("canvas");
    figure.append(caption, this.canvas);
    host.append(figure);
    const at = (event) => {
      const box = this.canvas.getBoundingClientRect();
      seek(clamp((event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT), 0, 1) * lasts);
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      at(event);
    });
    this.canvas.addEventListener("pointermove", (event) => event.buttons && at(event));
  }

  x(t) {
    return LEFT + (t / this.lasts) * (this.w - LEFT - RIGHT);
  }

  y(value) {
    const { low, high } = this.set;
    return TOP + (1 - (clamp(value, low, high) - low) / (high - low)) * (this.h - TOP - BOTTOM);
  }

  // What does not change with the time cursor is drawn once for each size and theme, and kept as a picture.
  prepare() {
    const ratio = window.devicePixelRatio || 1;
    this.w = this.canvas.clientWidth;
    this.h = this.canvas.clientHeight;
    const picture = document.createElement("canvas");
    for (const each of [picture, this.canvas]) {
      each.width = Math.round(this.w * ratio);
      each.height = Math.round(this.h * ratio);
    }
    const c = picture.getContext("2d");
    c.scale(ratio, ratio);
    c.font = "11px system-ui, sans-serif";
    this.frame(c);
    for (const band of this.set.bands) {
      c.fillStyle = style(band.colour);
      const top = this.y(band.value);
      c.fillRect(this.x(band.from), top, this.x(band.to) - this.x(band.from), this.y(this.set.low) - top);
    }
    for (const limit of this.set.limits) {
      c.strokeStyle = style("--limit");
      c.setLineDash([4, 3]);
      c.beginPath();
      c.moveTo(LEFT, this.y(limit));
      c.lineTo(this.w - RIGHT, this.y(limit));
      c.stroke();
      c.setLineDash([]);
    }
    for (const line of this.set.lines) this.curve(c, line);
    this.picture = picture;
    this.ratio = ratio;
  }

  frame(c) {
    const { low, high, unit } = this.set;
    c.strokeStyle = style("--rule");
    c.fillStyle = style("--faint");
    c.textBaseline = "middle";
    c.textAlign = "right";
    for (const value of ticks(low, high, 3)) {
      const y = this.y(value);
      c.beginPath();
      c.moveTo(LEFT, y);
      c.lineTo(this.w - RIGHT, y);
      c.stroke();
      c.fillText(`${Number(value.toPrecision(4))}${unit === "%" ? " %" : ""}`, LEFT - 5, y);
    }
    c.textAlign = "center";
    c.textBaseline = "alphabetic";
    for (const t of ticks(0, this.lasts, 5)) c.fillText(`${Number(t.toPrecision(4))}`, this.x(t), this.h - 3);
  }

  curve(c, { times, value, colour }) {
    c.strokeStyle = style(colour);
    c.lineWidth = 1.6;
    c.lineJoin = "round";
    c.beginPath();
    times.forEach((t, k) => (k ? c.lineTo(this.x(t), this.y(value(k))) : c.moveTo(this.x(t), this.y(value(k)))));
    c.stroke();
    c.lineWidth = 1;
  }

  draw(t) {
    if (!this.picture || this.w !== this.canvas.clientWidth || this.h !== this.canvas.clientHeight) this.prepare();
    if (!this.w) return;
    const c = this.canvas.getContext("2d");
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, this.canvas.width, this.canvas.height);
    c.drawImage(this.picture, 0, 0);
    c.scale(this.ratio, this.ratio);
    c.strokeStyle = style("--cursor");
    c.lineWidth = 1.5;
    this.cursor = this.x(t);
    c.beginPath();
    c.moveTo(this.cursor, TOP - 4);
    c.lineTo(this.cursor, this.h - BOTTOM + 2);
    c.stroke();
    this.values.replaceChildren(
      ...this.set.readout(t).map(({ text, colour }) => {
        const span = document.createElement("span");
        span.textContent = text;
        if (colour) span.style.color = style(colour);
        return span;
      }),
    );
  }

  forget() {
    this.picture = null;
  }
}

const ORDERS = ["position", "velocity", "acceleration", "jerk"];
const KEYS = [null, "velocity", "acceleration", "jerk"];
const ANGLES = ["°", "°/s", "°/s²", "k°/s³"];
const LENGTHS = ["mm", "mm/s", "m/s²", "m/s³"];

export const jointColour = (number) => `--joint-${number % 6}`;

// A value of a joint or of a derivative as people read it.
export function jointText(unit, order, value) {
  const turn = 180 / Math.PI / (order === 3 ? 1000 : 1);
  const [factor, digits] = unit === "rad" ? [turn, order ? 0 : 1] : [order < 2 ? 1000 : 1, order === 1 ? 0 : 1];
  const rounded = Number((factor * value).toFixed(digits)) + 0;
  return `${rounded.toFixed(digits)} ${(unit === "rad" ? ANGLES : LENGTHS)[order]}`;
}

// Share of a limit, in %: of a position where in its range it is, from 0 to 100.
function shareOf(tracks, joint, order, t, value) {
  const limits = tracks.limits(t);
  if (order === 0) {
    const { lower, upper } = limits;
    return (100 * (value - lower[joint])) / (upper[joint] - lower[joint]);
  }
  const most = limits[KEYS[order]];
  return most ? (100 * value) / most[joint] : 0;
}

function jointChart(tracks, order) {
  const { times, values, count, names, units } = tracks.curves;
  const limited = order < 3 || tracks.limits(0).jerk !== null;
  const lines = names.map((_, joint) => ({
    times,
    colour: jointColour(joint),
    value: (k) => shareOf(tracks, joint, order, times[k], values[(4 * k + order) * count + joint]),
  }));
  return {
    title: `Joint ${ORDERS[order]}, share of its ${order ? "limit" : "range"}${limited ? "" : " (unbounded)"}`,
    unit: "%",
    low: order ? -115 : -5,
    high: order ? 115 : 105,
    limits: order ? [-100, 100] : [0, 100],
    lines: limited ? lines : [],
    readout: (t) =>
      names.map((name, joint) => ({
        text: `${name} ${jointText(units[joint], order, tracks.joint(joint, order, t))}`,
        colour: jointColour(joint),
      })),
  };
}

function clearanceChart(tracks) {
  const { times, gaps, required } = tracks.near;
  const most = Math.max(...required);
  const least = Math.min(...gaps);
  const high = 1000 * Math.max(4 * most, 2 * least, Math.min(Math.max(...gaps), 0.06), 0.005);
  const bands = [];
  for (let k = 0; k + 1 < times.length; k += 1) {
    const last = bands[bands.length - 1];
    // one band for as long as the same is required: many side by side would show seams
    if (last && last.value === 1000 * required[k] && last.to === times[k]) last.to = times[k + 1];
    else bands.push({ from: times[k], to: times[k + 1], value: 1000 * required[k], colour: "--forbidden" });
  }
  const cut = 1000 * Math.max(...gaps) > high ? `, up to ${Number(high.toPrecision(3))}` : "";
  return {
    title: `Clearance of the nearest pair, mm${cut}`,
    unit: "mm",
    low: Math.min(0, 1000 * least),
    high,
    bands,
    lines: [{ times, value: (k) => 1000 * gaps[k], colour: "--hot" }],
    readout: (t) => {
      const pair = tracks.nearest(t);
      const [a, b] = pair.bodies.map((number) => tracks.view.bodies[number].name);
      return [{ text: `${(1000 * pair.gap).toFixed(2)} mm`, colour: "--hot" }, { text: `${a} – ${b}` }];
    },
  };
}

function speedChart(tracks) {
  const { times, toolRates } = tracks.curves;
  const peak = Math.max(...times.map((_, k) => toolRates[2 * k]), 0.01);
  return {
    title: "Speed of the tool point, m/s",
    unit: "m/s",
    low: 0,
    high: 1.1 * peak,
    lines: [{ times, value: (k) => toolRates[2 * k], colour: "--accent" }],
    readout: (t) => [
      { text: `${tracks.toolRate(0, t).toFixed(2)} m/s`, colour: "--accent" },
      { text: `${tracks.toolRate(1, t).toFixed(1)} m/s²` },
    ],
  };
}

// All diagrams of a view, in their order.
export function charts(host, tracks, seek) {
  const wanted = [];
  if (tracks.near) wanted.push(clearanceChart(tracks));
  if (tracks.curves) {
    wanted.push(speedChart(tracks));
    for (const order of [0, 1, 2, 3]) wanted.push(jointChart(tracks, order));
  }
  return wanted.map((each) => new Chart(host, each, tracks.view.lasts_s, seek));
}
