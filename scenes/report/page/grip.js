// What is moved in the view from above: a body or a control point, by a pointer or by the arrow keys. It is drawn as an
// outline until the page that writes its place has drawn the cell anew.
import { rotate, then, turn } from "./numbers.js";
import { unpack } from "./tracks.js";

const NEAR_PX = 10; // a pointer that is nearer than this to a control point is at it
const CLICK_PX = 4; // a pointer that moves by no more has not moved a thing
const PAUSE_MS = 300; // keys that follow sooner are one move
const GRID_MM = 1;
const FINE_MM = 0.1;

export class Grip {
  constructor(player) {
    this.player = player;
    this.chosen = null; // what is marked: { kind, name } of the service
    this.held = null; // what is moved: { thing, from, by (m, in the world), fine, begun }
    this.waiting = null; // the timer of the keys
    const drawn = document.createElement("template");
    drawn.innerHTML = '<svg id="moved"><polygon></polygon></svg>';
    this.picture = drawn.content.firstElementChild;
    this.outline = this.picture.firstElementChild;
    this.picture.replaceChildren();
    this.words = document.createElement("span");
    this.words.className = "label moved";
    this.words.hidden = true;
    player.canvas.parentElement.append(this.picture, this.words);
  }

  get on() {
    return this.player.moved !== null && this.player.view !== null && this.player.camera.above;
  }

  // The bodies with a place of their own.
  bodies() {
    return this.player.view.bodies.filter(({ kind }) => kind === "body" || kind === "part");
  }

  named({ kind, name }) {
    const { control_points: points } = this.player.view;
    if (kind === "body") return this.ofBody(this.bodies().find((body) => body.name === name));
    return kind === "step" ? this.ofPoint(points.find(({ step }) => String(step) === name)) : null;
  }

  ofBody(body) {
    return body ? { kind: "body", name: body.name, title: body.name, body, seat: this.player.tracks.seat(body, this.player.t) } : null;
  }

  ofPoint(point) {
    return point ? { kind: "step", name: String(point.step), title: point.name, seat: point } : null;
  }

  // What is at a place of the canvas: a part, else a control point, else a body.
  at(left, top) {
    const { player } = this;
    const body = player.view.bodies[player.renderer.bodyAt(left, top)];
    if (body && body.kind === "part") return this.ofBody(body);
    const near = (point) => {
      const { x, y } = player.renderer.onPage(player.tracks.pointPose(point, player.t).p);
      return Math.hypot(x - left, y - top) <= NEAR_PX;
    };
    return this.ofPoint(player.view.control_points.find(near)) || (body && body.kind === "body" ? this.ofBody(body) : null);
  }

  take({ clientX, clientY, shiftKey }) {
    this.leave();
    if (!this.on) return;
    const box = this.player.canvas.getBoundingClientRect();
    const thing = this.at(clientX - box.left, clientY - box.top);
    if (thing) this.held = { thing, from: [clientX, clientY], by: [0, 0, 0], fine: shiftKey, begun: false };
  }

  // Whether the pointer moves a thing.
  drag({ clientX, clientY, shiftKey }) {
    const { held, player } = this;
    if (held === null || !held.from) return false;
    const [dx, dy] = [clientX - held.from[0], clientY - held.from[1]];
    held.begun = held.begun || Math.hypot(dx, dy) > CLICK_PX;
    if (!held.begun) return true;
    const height = player.canvas.clientHeight;
    held.by = player.camera.across(dx / height, dy / height);
    held.fine = shiftKey;
    this.draw();
    return true;
  }

  // Whether a key moves what is marked: by a millimetre to the right (x) or up (y), with shift by ten.
  nudge(x, y, far) {
    const thing = this.on && this.chosen !== null ? this.named(this.chosen) : null;
    if (thing === null) return false;
    if (this.held === null || this.held.from) this.held = { thing, from: null, by: [0, 0, 0], fine: false, begun: true };
    const { right, up } = this.player.camera.axes();
    const step = (far ? 10 : 1) * 1e-3;
    this.held.by = this.held.by.map((value, k) => value + step * (x * right[k] + y * up[k]));
    this.draw();
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.drop(), PAUSE_MS);
    return true;
  }

  // Reports what was moved, along the axes of the frame in which it is.
  async drop() {
    const { held } = this;
    clearTimeout(this.waiting);
    this.held = null;
    if (held === null || !held.begun) return;
    const { q } = this.player.tracks.carrierPoses(this.player.t)[held.thing.seat.carrier];
    const back = [-q[0], -q[1], -q[2], q[3]];
    const [x, y] = rotate(back, held.by);
    const { kind, name } = held.thing;
    await this.player.moved({ kind, name, by_m: [x, y], grid_m: this.grid(held) * 1e-3 });
    if (this.held === null) this.leave();
  }

  leave() {
    clearTimeout(this.waiting);
    this.held = null;
    this.picture.replaceChildren();
    this.words.hidden = true;
  }

  grid({ fine }) {
    return fine ? FINE_MM : GRID_MM;
  }

  draw() {
    const { held, player } = this;
    const { thing, by } = held;
    const pose = then(player.tracks.carrierPoses(player.t)[thing.seat.carrier], { p: thing.seat.at_m, q: turn(thing.seat.yaw_rad) });
    const outline = this.corners(thing).map((corner) => {
      const p = rotate(pose.q, corner).map((value, k) => value + pose.p[k] + by[k]);
      const { x, y } = player.renderer.onPage(p);
      return `${x.toFixed(1)},${y.toFixed(1)}`;
    });
    this.outline.setAttribute("points", outline.join(" "));
    this.picture.replaceChildren(this.outline);
    const mm = (value) => {
      const digits = held.fine ? 1 : 0;
      return `${value < 0 ? "−" : "+"}${Math.abs(1000 * value).toFixed(digits)}`;
    };
    this.words.textContent = `${thing.title}: ${mm(by[0])}, ${mm(by[1])} mm`;
    const { x, y } = player.renderer.onPage(pose.p.map((value, k) => value + by[k]));
    this.words.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    this.words.hidden = false;
  }

  // The corners, seen from above, of the box around a body; of a control point a small square.
  corners({ body }) {
    let [low, high] = [[-0.01, -0.01], [0.01, 0.01]];
    if (body) {
      const mesh = this.player.view.meshes[body.mesh];
      const numbers = unpack(mesh.vertices);
      [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
      for (let at = 0; at < numbers.length; at += 3) {
        for (let k = 0; k < 2; k += 1) {
          const value = mesh.low_m[k] + numbers[at + k] * mesh.step_m[k];
          low[k] = Math.min(low[k], value);
          high[k] = Math.max(high[k], value);
        }
      }
    }
    return [[low[0], low[1], 0], [high[0], low[1], 0], [high[0], high[1], 0], [low[0], high[1], 0]];
  }
}
