// The names of the control points and the distance of the nearest pair, beside their places, so that none hides another.
import { away } from "./camera.js";

const NEAR_PX = 10; // a pointer that is nearer than this to a control point is at it
const [BESIDE, LINE] = [9, 22]; // from a point to its label, and from one line of labels to the next, px
const MARK = 8; // so far around a control point there is no label of another one, px
const SPACE = 1; // between two labels, px

// Where a label of a width may be from its point: to the right or left, above or below, then a line farther.
const places = (width) => [-LINE, 6, -2 * LINE, 6 + LINE].flatMap((y) => [[BESIDE, y], [-BESIDE - width, y]]);

const apart = (a, b) =>
  a.x + a.width + SPACE <= b.x || b.x + b.width + SPACE <= a.x || a.y + a.height + SPACE <= b.y || b.y + b.height + SPACE <= a.y;

export class Labels {
  constructor(renderer, tracks, camera, host) {
    Object.assign(this, { renderer, tracks, camera, host });
    this.pointer = null; // where a pointer is on the picture, px
    this.chosen = null; // the number of the control point that is marked
    this.points = tracks.view.control_points.map((point) => this.label(point.name));
    this.distance = this.label("", "distance");
  }

  label(text, kind = "") {
    const element = document.createElement("span");
    element.className = `label ${kind}`.trim();
    element.textContent = text;
    this.host.append(element);
    return { element, size: null, last: 0 };
  }

  choose(number) {
    this.chosen = number;
    this.points.forEach(({ element }, k) => element.classList.toggle("chosen", k === number));
  }

  // `plays`: labels stay where they were, so that none jumps to and fro.
  draw(t, show, pair, plays = false) {
    if (!plays) this.points.forEach((label) => (label.last = 0));
    const carriers = this.tracks.carrierPoses(t);
    const taken = [];
    this.distance.element.hidden = !pair || !show.pair;
    if (pair && show.pair) {
      this.distance.element.textContent = `${(1000 * pair.gap).toFixed(2)} mm`;
      this.distance.size = null;
      this.put(this.distance, this.renderer.onPage(pair.points[0].map((x, k) => (x + pair.points[1][k]) / 2)), taken, [[BESIDE, 8]]);
    }
    const points = this.tracks.view.control_points;
    const found = points.map((point, number) => {
      const { p } = this.tracks.pointPose(point, t, carriers);
      const at = this.renderer.onPage(p);
      this.points[number].element.classList.toggle("done", point.until_s !== null && t > point.until_s);
      const hovered = this.pointer !== null && Math.hypot(at.x - this.pointer[0], at.y - this.pointer[1]) <= NEAR_PX;
      return { number, at, far: away(this.camera, p), first: number === this.chosen ? 2 : Number(hovered) };
    });
    found.sort((a, b) => b.first - a.first || a.far - b.far || a.number - b.number);
    if (show.points) for (const { number, at: { x, y } } of found)
      taken.push({ of: this.points[number], x: x - MARK, y: y - MARK, width: 2 * MARK, height: 2 * MARK });
    const named = new Set(); // several points with one name at one place have one label
    for (const { number, at, first } of found) {
      const name = `${points[number].name} ${at.x.toFixed(0)} ${at.y.toFixed(0)}`;
      const again = named.has(name);
      named.add(name);
      if (show.points && !again && this.tracks.isShown(points[number], t)) this.put(this.points[number], at, taken, null, first > 0);
      else this.points[number].element.hidden = true;
    }
  }

  // Puts a label at the first of its places where no other one is, `always` or only where there is one.
  put(label, at, taken, own = null, always = true) {
    const { element } = label;
    element.hidden = !at.ahead;
    if (!at.ahead) return;
    if (label.size === null && element.offsetWidth) label.size = [element.offsetWidth, element.offsetHeight];
    const [width, height] = label.size || [0, 0]; // a page that is not shown has no sizes
    const offered = own || places(width);
    const rectangle = ([x, y]) => ({ x: at.x + x, y: at.y + y, width, height });
    const free = (number) => taken.every((other) => other.of === label || apart(rectangle(offered[number]), other));
    const number = [own ? 0 : label.last, ...offered.keys()].find(free);
    if (number === undefined && !always) {
      element.hidden = true;
      return;
    }
    label.last = number || 0;
    const { x, y } = rectangle(offered[label.last]);
    taken.push(rectangle(offered[label.last]));
    element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  }
}
