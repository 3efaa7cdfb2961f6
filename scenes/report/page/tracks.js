// What a view document says at an instant. There is no kinematics and no time law here: poses are interpolated between
// samples of Python's, and bodies sit on carriers.
import { slerp, then, turn } from "./numbers.js";

function bytesOf(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k += 1) bytes[k] = raw.charCodeAt(k);
  return bytes.buffer;
}

// The numbers of a packed array of a view, as one flat array.
export function unpack(packed) {
  return packed.float32 === undefined
    ? new Uint16Array(bytesOf(packed.uint16))
    : new Float32Array(bytesOf(packed.float32));
}

// Number of the last of the times that is not after t; 0 before all of them.
export function lastBefore(times, t) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

// Which two samples a time lies between, and its share of the way; behind the last one that sample alone.
export function bracket(times, t) {
  const k = lastBefore(times, t);
  const next = Math.min(k + 1, times.length - 1);
  const whole = times[next] - times[k];
  const share = whole > 0 ? Math.min(1, Math.max(0, (t - times[k]) / whole)) : 0;
  return { k, next, share };
}

// Where there are more control points than this, only those are shown that are met within so many seconds.
const MANY = 40;
const SOON_S = 3;

class Carrier {
  constructor(track) {
    this.name = track.name;
    this.times = unpack(track.time_s);
    this.places = unpack(track.position_m);
    this.turns = unpack(track.rotation);
    this.stands = this.times.length === 1;
  }

  at(t) {
    const { k, next, share } = bracket(this.times, t);
    const p = [0, 1, 2].map((i) => {
      const from = this.places[3 * k + i];
      return from + share * (this.places[3 * next + i] - from);
    });
    const one = Array.from(this.turns.subarray(4 * k, 4 * k + 4));
    const other = Array.from(this.turns.subarray(4 * next, 4 * next + 4));
    return { p, q: slerp(one, other, share) };
  }
}

const seatPose = (seat) => ({ p: seat.at_m, q: turn(seat.yaw_rad) });

export class Tracks {
  constructor(view) {
    this.view = view;
    this.carriers = view.carriers.map((track) => new Carrier(track));
    const { curves, distances } = view;
    this.curves = curves && {
      ...curves,
      count: curves.names.length,
      times: unpack(curves.time_s),
      values: unpack(curves.joints),
      toolRates: unpack(curves.tool),
      knots: unpack(curves.knots_s),
    };
    this.near = distances && {
      times: unpack(distances.time_s),
      gaps: unpack(distances.gap_m),
      required: unpack(distances.required_m),
      bodies: unpack(distances.bodies),
      points: unpack(distances.points_m),
    };
    this.toolPath = { times: unpack(view.tool.time_s), points: unpack(view.tool.path_m) };
  }

  carrierPoses(t) {
    return this.carriers.map((carrier) => carrier.at(t));
  }

  // The seat of a body: the last one that has begun.
  seat(body, t) {
    let found = body.seats[0];
    for (const seat of body.seats) if (seat.from_s <= t) found = seat;
    return found;
  }

  bodyPose(body, t, carriers = this.carrierPoses(t)) {
    const seat = this.seat(body, t);
    return then(carriers[seat.carrier], seatPose(seat));
  }

  // Whether a body is there: from its first seat on, until it is taken away.
  isThere(body, t) {
    return t >= body.seats[0].from_s && (body.gone_s === null || t < body.gone_s);
  }

  // Whether a control point belongs to what is shown: in a motion that is planned, one that is met in its time.
  belongs(point) {
    return point.time_s !== null || this.view.status !== "planned";
  }

  // Whether a control point is shown: where there are many, those that are met now or soon.
  isShown(point, t) {
    if (!this.belongs(point)) return false;
    if (this.view.control_points.length <= MANY || point.time_s === null) return true;
    return point.time_s < t + SOON_S && t <= point.until_s + 1e-6;
  }

  pointPose(point, t, carriers = this.carrierPoses(t)) {
    return then(carriers[point.carrier], seatPose(point));
  }

  toolPose(t, carriers = this.carrierPoses(t)) {
    return then(carriers[this.view.tool.carrier], seatPose(this.view.tool));
  }

  // Value of a joint or of one of its derivatives; where it jumps, that behind the jump.
  joint(number, order, t) {
    const { times, values, count } = this.curves;
    const { k, next, share } = bracket(times, t);
    const at = (sample) => values[(4 * sample + order) * count + number];
    return at(k) + share * (at(next) - at(k));
  }

  toolRate(order, t) {
    const { times, toolRates } = this.curves;
    const { k, next, share } = bracket(times, t);
    return toolRates[2 * k + order] + share * (toolRates[2 * next + order] - toolRates[2 * k + order]);
  }

  // The nearest pair: that of the sample which is nearer in time.
  nearest(t) {
    if (!this.near) return null;
    const { times, gaps, required, bodies, points } = this.near;
    const { k, next, share } = bracket(times, t);
    const s = share < 0.5 ? k : next;
    return {
      gap: gaps[k] + share * (gaps[next] - gaps[k]),
      required: required[s],
      bodies: [bodies[2 * s], bodies[2 * s + 1]],
      points: [Array.from(points.subarray(6 * s, 6 * s + 3)), Array.from(points.subarray(6 * s + 3, 6 * s + 6))],
      at: times[s],
    };
  }

  limits(t) {
    let found = this.curves.limits[0];
    for (const span of this.curves.limits) if (span.from_s <= t) found = span;
    return found;
  }

  leg(t) {
    return this.view.legs.findLast((leg) => leg.from_s <= t) || this.view.legs[0] || null;
  }
}
