// The eye: around a target, moved by mouse, fingers and keys.
import { add, clamp, cross, dot, lookAt, multiply, orthographic, perspective, subtract, unit } from "./numbers.js";

const ANGLE = (32 * Math.PI) / 180;
const STEEPEST = 1.553;
// So far to the side of the direction in which the arm works, rad, the eye is at first.
const ASIDE = 0.6;
export const VIEWS = {
  perspective: { azimuth: 0, elevation: 0.58, flat: false },
  top: { azimuth: -Math.PI / 2, elevation: Math.PI / 2, flat: true },
  side: { azimuth: -Math.PI / 2, elevation: 0, flat: true },
  front: { azimuth: 0, elevation: 0, flat: true },
};

export class Camera {
  constructor() {
    this.box = null; // of what is seen
    this.aspect = 1;
  }

  // One of VIEWS, from so far that the box of what moves is seen as a whole.
  look(name) {
    Object.assign(this, VIEWS[name]);
    if (name === "perspective") this.azimuth = this.box.work - ASIDE;
    this.moved = false;
    this.fit();
  }

  // The shape of the picture, width by height. A view that nobody has moved is fitted to it.
  shape(aspect) {
    if (aspect === this.aspect) return;
    this.aspect = aspect;
    if (!this.moved) this.fit();
  }

  // As near as can be, with all points of the box in the picture, and in the middle of it.
  fit() {
    const { points, middle } = this.box;
    const { right, up, back } = this.axes();
    const slope = Math.tan(ANGLE / 2);
    const [across, along] = [[right, slope * this.aspect], [up, slope]].map(([axis, most]) => {
      const ends = [-Infinity, -Infinity]; // how far the eye must be for the points on either side
      for (const point of points) {
        const p = subtract(point, middle);
        const nearer = this.flat ? 0 : dot(p, back);
        const aside = dot(p, axis) / most;
        ends[0] = Math.max(ends[0], nearer - aside);
        ends[1] = Math.max(ends[1], nearer + aside);
      }
      return { shift: (most * (ends[1] - ends[0])) / 2, distance: (ends[0] + ends[1]) / 2 };
    });
    this.target = add(add(middle, right, across.shift), up, along.shift);
    this.distance = 1.08 * Math.max(across.distance, along.distance, 0.1);
  }

  // What is seen, whatever the shape of the picture: to be given to the camera of another page.
  get state() {
    const { azimuth, elevation, flat, distance } = this;
    return { azimuth, elevation, flat, distance, target: [...this.target] };
  }

  axes() {
    const level = Math.cos(this.elevation);
    const back = [
      level * Math.cos(this.azimuth),
      level * Math.sin(this.azimuth),
      Math.sin(this.elevation),
    ];
    // straight from above the direction to the eye says nothing of what is up on the screen
    const right = [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0];
    return { back, right, up: cross(back, right) };
  }

  eye() {
    return add(this.target, this.axes().back, this.distance);
  }

  matrix() {
    const { up } = this.axes();
    const eye = this.eye();
    const near = Math.max(0.01, this.distance / 50);
    const far = this.distance * 4 + 20;
    const half = this.distance * Math.tan(ANGLE / 2);
    const lens = this.flat ? orthographic(half, this.aspect, -far, far) : perspective(ANGLE, this.aspect, near, far);
    return multiply(lens, lookAt(eye, this.target, unit(up)));
  }

  // Whether it looks straight down, without perspective.
  get above() {
    return this.flat && this.elevation === VIEWS.top.elevation;
  }

  // How far, m, what is seen at shares of the height of the picture is from one another.
  across(dx, dy) {
    const { right, up } = this.axes();
    const whole = 2 * this.distance * Math.tan(ANGLE / 2);
    return add(add([0, 0, 0], right, dx * whole), up, -dy * whole);
  }

  orbit(dx, dy) {
    this.flat = false;
    this.azimuth -= dx;
    this.elevation = clamp(this.elevation + dy, -0.4, STEEPEST);
  }

  // By shares of the height of the picture.
  pan(dx, dy) {
    this.target = subtract(this.target, this.across(dx, dy));
  }

  zoom(factor) {
    this.distance = clamp(this.distance * factor, 0.05, 60);
  }
}

// Lets pointers and keys move a camera, but for those that `grip` takes; `drawn` is called after each move.
export function steer(canvas, camera, drawn, grip) {
  const changed = () => {
    camera.moved = true;
    drawn();
  };
  const pointers = new Map();
  const middle = () => {
    const all = [...pointers.values()];
    const x = all.reduce((sum, p) => sum + p.x, 0) / all.length;
    const y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
    return { x, y, spread: Math.hypot(all[0].x - x, all[0].y - y) };
  };
  canvas.addEventListener("pointerdown", (event) => {
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    canvas.setPointerCapture(event.pointerId);
    if (pointers.size > 1 || event.button !== 0) grip.leave();
    else grip.take(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId) || grip.drag(event)) return;
    const before = middle();
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const after = middle();
    const height = canvas.clientHeight;
    const [dx, dy] = [(after.x - before.x) / height, (after.y - before.y) / height];
    if (pointers.size > 1) {
      camera.pan(dx, dy);
      if (before.spread > 0 && after.spread > 0) camera.zoom(before.spread / after.spread);
    } else if (event.shiftKey || event.buttons & 6) camera.pan(dx, dy);
    else camera.orbit(3 * dx, 3 * dy);
    changed();
  });
  const leave = (event) => pointers.delete(event.pointerId);
  canvas.addEventListener("pointerup", (event) => {
    grip.drop();
    leave(event);
  });
  canvas.addEventListener("pointercancel", (event) => {
    grip.leave();
    leave(event);
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(event.deltaY * (event.ctrlKey ? 0.01 : 0.0015)));
      changed();
    },
    { passive: false },
  );
  const keys = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  canvas.addEventListener("keydown", (event) => {
    if (keys[event.key]) {
      const [x, y] = keys[event.key];
      if (grip.nudge(-x, y, event.shiftKey)) {
        event.preventDefault();
        event.stopPropagation();
        return;
      }
      if (event.shiftKey) camera.pan(0.05 * x, 0.05 * y);
      else camera.orbit(0.1 * x, 0.1 * y);
    } else if (event.key === "+" || event.key === "=") camera.zoom(0.9);
    else if (event.key === "-") camera.zoom(1.1);
    else return;
    event.preventDefault();
    event.stopPropagation();
    changed();
  });
}

// How far the eye is from a point.
export function away(camera, point) {
  return Math.hypot(...subtract(camera.eye(), point));
}
