// The lines that are drawn: paths, the cross at a point, and marks on frames that move, as points x, y, z, time.
import { rotate, unit } from "./numbers.js";
import { unpack } from "./tracks.js";

const CROSS_M = 0.018;
// Arrows on what travels, so far apart, for so far before and behind its frame, m.
const ARROWS_M = 0.1;
const BELT_M = 0.5;

export function pathOf({ times, points }) {
  const found = new Float32Array(4 * times.length);
  times.forEach((time, k) => found.set([points[3 * k], points[3 * k + 1], points[3 * k + 2], time], 4 * k));
  return found;
}

export function traceOf(point) {
  const points = unpack(point.path_m);
  const found = new Float32Array((4 * points.length) / 3);
  for (let k = 0; k < points.length / 3; k += 1) found.set([...points.subarray(3 * k, 3 * k + 3), 0], 4 * k);
  return found;
}

export function crossLines() {
  const s = CROSS_M;
  return new Float32Array([-s, 0, 0, 0, s, 0, 0, 0, 0, -s, 0, 0, 0, s, 0, 0, 0, 0, -s, 0, 0, 0, s, 0]);
}

// Marks that show how frames move: arrows along the way of what travels, spokes on what turns. Bodies alone do not
// show it: the bed of a belt stands, and a round table looks the same at every angle.
export function marksOf(tracks, all) {
  const found = [];
  tracks.carriers.forEach((carrier, number) => {
    const { places, times, turns } = carrier;
    if (carrier.stands || number <= tracks.view.tool.carrier || carrier.name.includes("/")) return;
    const last = 3 * (times.length - 1);
    const way = [0, 1, 2].map((k) => places[last + k] - places[k]);
    const turned = [0, 1, 2, 3].some((k) => Math.abs(turns[k] - turns[turns.length - 4 + k]) > 1e-6);
    const on = all.find((batch) => !batch.body && batch.carrier === number);
    // what swings beside its pivot shows by itself how it moves
    const around = on && [0, 1].every((k) => on.low[k] < 0 && on.high[k] > 0);
    if (turned && around) {
      const radius = Math.max(...[0, 1].map((k) => Math.max(Math.abs(on.low[k]), Math.abs(on.high[k]))));
      found.push({ carrier: number, lines: spokes(radius, on.high[2] + 5e-4) });
    } else if (!turned && Math.hypot(...way) > 1e-3) {
      const back = rotate([-turns[0], -turns[1], -turns[2], turns[3]], unit(way));
      found.push({ carrier: number, lines: arrows(back, Math.hypot(...way)) });
    }
  });
  return found;
}

function spokes(radius, z) {
  const lines = [];
  for (let k = 0; k < 12; k += 1) {
    const [c, s] = [Math.cos((k * Math.PI) / 6), Math.sin((k * Math.PI) / 6)];
    const inner = (k % 3 ? 0.9 : 0.72) * radius;
    lines.push(inner * c, inner * s, z, 0, 0.97 * radius * c, 0.97 * radius * s, z, 0);
  }
  return new Float32Array(lines);
}

function arrows(along, travelled) {
  const lines = [];
  const aside = [-along[1], along[0], 0];
  const reach = BELT_M + travelled;
  for (let at = -reach; at <= BELT_M; at += ARROWS_M) {
    const tip = [0, 1, 2].map((k) => at * along[k] + (k === 2 ? 1e-3 : 0));
    for (const side of [-1, 1]) {
      const end = [0, 1, 2].map((k) => tip[k] - 0.02 * along[k] + side * 0.02 * aside[k]);
      lines.push(...tip, 0, ...end, 0);
    }
  }
  return new Float32Array(lines);
}
