// Draws a view at an instant. What is drawn where says tracks.js; how it looks says this file.
import { batches, FLOATS_PER_VERTEX } from "./geometry.js";
import { crossLines, marksOf, pathOf, traceOf } from "./lines.js";
import { clamp, matrixOf, multiply, project, unit } from "./numbers.js";
import {
  FLOOR_FRAGMENT, FLOOR_VERTEX, LINE_FRAGMENT, LINE_VERTEX, SOLID_FRAGMENT, SOLID_VERTEX,
} from "./shaders.js";

const LIGHT = unit([0.35, -0.55, 0.9]);
const IDENTITY = matrixOf({ p: [0, 0, 0], q: [0, 0, 0, 1] });
const NOWHERE = new Float32Array(16); // of what was taken away: no triangle has an area

function colourOf(name) {
  const text = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  return [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16) / 255);
}

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  const places = {};
  for (let k = 0; k < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); k += 1) {
    const name = gl.getActiveUniform(made, k).name.replace("[0]", "");
    places[name] = gl.getUniformLocation(made, name);
  }
  return { made, places };
}

export class Renderer {
  constructor(canvas) {
    const options = { antialias: true, stencil: true, alpha: false };
    const gl = canvas.getContext("webgl2", options);
    if (!gl) throw new Error("This browser has no WebGL 2.");
    Object.assign(this, { canvas, gl });
    this.stats = { drawCalls: 0, triangles: 0 };
    this.share = 1; // of the pixels of a side that are drawn: fewer while a slow machine plays
    this.solid = program(gl, SOLID_VERTEX, SOLID_FRAGMENT);
    this.floor = program(gl, FLOOR_VERTEX, FLOOR_FRAGMENT);
    this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT);
    this.held = []; // arrays and buffers of what is drawn
    this.empty = gl.createVertexArray();
    this.readTheme();
  }

  // What is drawn from now on.
  take(tracks) {
    const { gl } = this;
    for (const { vertices, buffer } of this.held.splice(0)) {
      gl.deleteVertexArray(vertices);
      gl.deleteBuffer(buffer);
    }
    this.tracks = tracks;
    this.chosen = [-1, -1]; // the first and the last of the bodies that are marked
    this.batches = batches(tracks.view).map((batch) => this.uploaded(batch));
    this.path = this.ribbon(pathOf(tracks.toolPath));
    this.pairLine = this.ribbon(new Float32Array(8));
    this.crosses = this.ribbon(crossLines(), true);
    this.traces = tracks.view.control_points.map((point) => point.path && this.ribbon(traceOf(point)));
    this.marks = marksOf(tracks, this.batches).map(({ carrier, lines }) => ({ carrier, line: this.ribbon(lines, true) }));
    // of a refusal without a motion: the two bodies that would meet
    const met = (tracks.view.refusal && !tracks.view.moves && tracks.view.refusal.met) || [];
    this.met = met.map((name) => tracks.view.bodies.findIndex((body) => body.name === name));
    this.box = boxOf(tracks, this.batches);
    this.ground = Math.min(0, this.box.floor);
  }

  uploaded(batch) {
    const { gl } = this;
    const array = (data) => {
      const [vertices, buffer] = [gl.createVertexArray(), gl.createBuffer()];
      this.held.push({ vertices, buffer });
      gl.bindVertexArray(vertices);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      [[0, 3], [3, 3], [6, 3], [9, 2], [11, 3]].forEach(([offset, size], place) => {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * FLOATS_PER_VERTEX, 4 * offset);
      });
      return vertices;
    };
    return { ...batch, solidArray: array(batch.solid), edgeArray: array(batch.edges) };
  }

  // Points x, y, z, time as one line; or, `apart`, every two of them as a line of their own.
  ribbon(points, apart = false) {
    const { gl } = this;
    const [vertices, buffer] = [gl.createVertexArray(), gl.createBuffer()];
    this.held.push({ vertices, buffer });
    gl.bindVertexArray(vertices);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, points, gl.DYNAMIC_DRAW);
    for (const place of [0, 1]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 4, gl.FLOAT, false, apart ? 32 : 16, 16 * place);
      gl.vertexAttribDivisor(place, 1);
    }
    return { vertices, buffer, segments: apart ? points.length / 8 : points.length / 4 - 1 };
  }

  readTheme() {
    this.theme = {
      colours: ["--robot", "--tool", "--part", "--body", "--neighbour"].flatMap(colourOf),
      background: colourOf("--stage"),
      ground: colourOf("--ground"),
      grid: colourOf("--grid"),
      hot: colourOf("--hot"),
      accent: colourOf("--accent"),
      quiet: colourOf("--quiet-line"),
      mark: colourOf("--mark"),
      edge: colourOf("--edge"),
      unknown: colourOf("--unknown"),
      clearance: colourOf("--clearance"),
      ghost: colourOf("--ghost"),
    };
  }

  resize() {
    const { canvas } = this;
    const ratio = this.share * Math.min(window.devicePixelRatio || 1, 2);
    const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
    return { w, h, ratio };
  }

  draw(t, camera, show, pair) {
    const { gl, theme } = this;
    const { w, h, ratio } = this.resize();
    if (!w || !h) return;
    camera.shape(w / h);
    this.stats = { drawCalls: 0, triangles: 0 };
    const matrix = camera.matrix();
    const carriers = this.tracks.carrierPoses(t);
    const poses = this.batches.map(({ body, carrier }) => {
      if (body && !this.tracks.isThere(body, t)) return NOWHERE;
      return matrixOf(body ? this.tracks.bodyPose(body, t, carriers) : carriers[carrier]);
    });
    const hot = show.pair && pair ? pair.bodies : this.met.length ? this.met : [-1, -1];
    this.focus = this.tracks.toolPose(t, carriers).p;
    // what is too near is red; what is merely nearest has a touch of it, for a table may be large
    const hotShare = !pair || pair.gap < pair.required - 1e-5 ? 0.75 : 0.22;
    Object.assign(this, { matrix, poses, t, ratio, size: [w, h], hot, hotShare });
    gl.viewport(0, 0, w, h);
    gl.clearColor(...theme.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.drawFloor(camera);
    this.begin(camera);
    this.drawShadows();
    const ghost = this.tracks.view.candidate;
    this.drawSolids((batch) => !ghost || !mine(batch, this.tracks, t));
    this.drawEdges((batch) => !ghost || !mine(batch, this.tracks, t), 0.55);
    if (ghost) this.drawGhost((batch) => mine(batch, this.tracks, t));
    if (show.path) this.drawLines(this.path, IDENTITY, 2.2, [...theme.accent, 1], [...theme.accent, 0.32]);
    const faint = [...theme.accent, 0.55];
    for (const { carrier, line } of this.marks) this.drawLines(line, matrixOf(carriers[carrier]), 1.6, faint, faint);
    this.drawPoints(carriers, show);
    this.begin(camera);
    if (show.unknown) this.drawShells((batch) => batch.unknown, { unknownShare: 1 }, theme.unknown, 0.2);
    const clearance = show.clearance ? this.clearance(t) : 0;
    if (clearance > 0) this.drawShells((batch) => mine(batch, this.tracks, t), { clearance }, theme.clearance, 0.16);
    if (show.pair && pair) this.drawPair(pair);
    this.drawTool(carriers);
  }

  // The clearance that counts now; where a pair has an exception the nearest pair's.
  clearance(t) {
    const pair = this.tracks.nearest(t);
    return pair ? Math.max(0, pair.required) : 0;
  }

  begin(camera) {
    const { gl, solid, theme } = this;
    const u = solid.places;
    gl.useProgram(solid.made);
    gl.uniformMatrix4fv(u.project, false, this.matrix);
    gl.uniform3fv(u.colours, theme.colours);
    gl.uniform3fv(u.eye, camera.flat ? camera.axes().back.map((x, k) => camera.target[k] + 50 * x) : camera.eye());
    gl.uniform3fv(u.light, LIGHT);
    gl.uniform3fv(u.hotColour, theme.hot);
    gl.uniform2fv(u.hot, this.hot);
    gl.uniform1f(u.hotShare, this.hotShare);
    gl.uniform2fv(u.chosen, this.chosen);
    gl.uniform3fv(u.chosenColour, theme.accent);
    gl.uniform3fv(u.focus, this.focus);
    gl.uniform1f(u.hole, 0.6 * camera.box.radius);
    gl.uniform1f(u.seconds, this.t);
    gl.uniform1f(u.floorHeight, this.ground + 5e-4);
    this.set({});
  }

  // What of a pass differs from the plain one.
  set({ alpha = 1, tint = [0, 0, 0], tinted = 0, lit = 1, clearance = 0, unknownShare = 0, shadow = 0 }) {
    const { gl } = this;
    const u = this.solid.places;
    gl.uniform1f(u.alpha, alpha);
    gl.uniform3fv(u.tint, tint);
    gl.uniform1f(u.tinted, tinted);
    gl.uniform1f(u.lit, lit);
    gl.uniform1f(u.clearance, clearance);
    gl.uniform1f(u.unknownShare, unknownShare);
    gl.uniform1f(u.shadow, shadow);
  }

  drawBatch(batch, pose) {
    const { gl } = this;
    gl.uniformMatrix4fv(this.solid.places.model, false, pose);
    gl.bindVertexArray(batch.solidArray);
    gl.drawArrays(gl.TRIANGLES, 0, batch.vertices);
    this.stats.drawCalls += 1;
    this.stats.triangles += batch.vertices / 3;
  }

  each(wanted, act) {
    this.batches.forEach((batch, k) => wanted(batch) && act(batch, this.poses[k]));
  }

  drawSolids(wanted) {
    const { gl } = this;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    this.each(wanted, (batch, pose) => this.drawBatch(batch, pose));
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  drawEdges(wanted, alpha) {
    const { gl } = this;
    this.set({ alpha, tint: this.theme.edge, tinted: 1, lit: 0 });
    this.each(wanted, (batch, pose) => {
      gl.uniformMatrix4fv(this.solid.places.model, false, pose);
      gl.bindVertexArray(batch.edgeArray);
      gl.drawArrays(gl.LINES, 0, batch.edgeVertices);
      this.stats.drawCalls += 1;
    });
    this.set({});
  }

  // Each body flattened onto the floor along the light; the stencil keeps what overlaps from becoming darker.
  drawShadows() {
    const { gl } = this;
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.depthMask(false);
    this.set({ alpha: 0.13, tinted: 1, lit: 0, shadow: 1 });
    this.each(() => true, (batch, pose) => this.drawBatch(batch, pose));
    gl.depthMask(true);
    gl.disable(gl.STENCIL_TEST);
    this.set({});
  }

  // First the depth alone, so that only the nearest surface of what is translucent is seen.
  drawTranslucent(wanted, settings) {
    const { gl } = this;
    gl.colorMask(false, false, false, false);
    this.set(settings);
    this.each(wanted, (batch, pose) => this.drawBatch(batch, pose));
    gl.colorMask(true, true, true, true);
    gl.depthMask(false);
    this.each(wanted, (batch, pose) => this.drawBatch(batch, pose));
    gl.depthMask(true);
    this.set({});
  }

  drawGhost(wanted) {
    this.drawTranslucent(wanted, { alpha: 0.62, tint: this.theme.ghost, tinted: 0.55 });
    this.drawEdges(wanted, 0.6);
  }

  drawShells(wanted, settings, tint, alpha) {
    const { gl } = this;
    gl.depthMask(false);
    this.set({ ...settings, alpha, tint, tinted: 1 });
    gl.enable(gl.CULL_FACE);
    this.each(wanted, (batch, pose) => this.drawBatch(batch, pose));
    gl.disable(gl.CULL_FACE);
    gl.depthMask(true);
    this.set({});
  }

  drawFloor(camera) {
    const { gl, floor, theme } = this;
    const u = floor.places;
    gl.useProgram(floor.made);
    gl.uniformMatrix4fv(u.project, false, this.matrix);
    gl.uniform3f(u.middle, camera.box.middle[0], camera.box.middle[1], this.ground);
    gl.uniform1f(u.size, 2.2 * camera.box.radius + 0.6);
    gl.uniform3fv(u.line, theme.grid);
    gl.uniform3fv(u.ground, theme.ground);
    gl.uniform1f(u.groundAlpha, 0.9);
    gl.bindVertexArray(this.empty);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.depthMask(true);
    this.stats.drawCalls += 1;
  }

  drawLines(ribbon, pose, width, past, future) {
    const { gl, line } = this;
    if (ribbon.segments < 1) return;
    const u = line.places;
    gl.useProgram(line.made);
    gl.uniformMatrix4fv(u.project, false, this.matrix);
    gl.uniformMatrix4fv(u.model, false, pose);
    gl.uniform2fv(u.pixels, this.size);
    gl.uniform1f(u.width, width * this.ratio);
    gl.uniform4fv(u.past, past);
    gl.uniform4fv(u.future, future);
    gl.uniform1f(u.seconds, this.t);
    gl.bindVertexArray(ribbon.vertices);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, ribbon.segments);
    this.stats.drawCalls += 1;
  }

  // A cross at each control point: strong while it is met, faint once it is done.
  drawPoints(carriers, show) {
    if (!show.points) return;
    this.tracks.view.control_points.forEach((point, k) => {
      if (!this.tracks.isShown(point, this.t)) return;
      const pose = matrixOf(this.tracks.pointPose(point, this.t, carriers));
      const met = point.time_s !== null && this.t >= point.time_s && this.t <= point.until_s + 1e-6;
      const done = point.until_s !== null && this.t > point.until_s;
      const colour = [...(met ? this.theme.hot : this.theme.mark), done ? 0.35 : 1];
      this.drawLines(this.crosses, pose, met ? 2.6 : 1.8, colour, colour);
      if (this.traces[k]) {
        const faint = [...this.theme.mark, 0.7];
        this.drawLines(this.traces[k], matrixOf(carriers[point.carrier]), 1.6, faint, faint);
      }
    });
  }

  drawPair(pair) {
    const { gl } = this;
    const [a, b] = pair.points;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.pairLine.buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, new Float32Array([...a, 0, ...b, 0]));
    const colour = [...this.theme.hot, 1];
    gl.disable(gl.DEPTH_TEST);
    this.drawLines(this.pairLine, IDENTITY, 3, colour, colour);
    gl.enable(gl.DEPTH_TEST);
  }

  // A dot where the tool point is, over everything: the eye follows it.
  drawTool(carriers) {
    const { gl } = this;
    const { p } = this.tracks.toolPose(this.t, carriers);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.pairLine.buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, new Float32Array([...p, 0, ...p, 0]));
    gl.disable(gl.DEPTH_TEST);
    const colour = [...this.theme.accent, 1];
    this.drawLines(this.pairLine, IDENTITY, 6, colour, colour);
    gl.enable(gl.DEPTH_TEST);
  }

  // The number of the body that is seen at a place of the canvas, in pixels of CSS; -1: there is none.
  bodyAt(left, top) {
    const { clientWidth, clientHeight } = this.canvas;
    const [x, y] = [(2 * left) / clientWidth - 1, 1 - (2 * top) / clientHeight];
    let [found, nearest] = [-1, Infinity];
    this.batches.forEach(({ solid, vertices }, k) => {
      const matrix = multiply(this.matrix, this.poses[k]);
      for (let at = 0; at < vertices; at += 3) {
        const [a, b, c] = [0, 1, 2].map((corner) => {
          const from = (at + corner) * FLOATS_PER_VERTEX;
          return project(matrix, solid.subarray(from, from + 3));
        });
        if (a[3] <= 0 || b[3] <= 0 || c[3] <= 0) continue;
        const side = (p, q) => (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
        const [u, v, w] = [side(b, c), side(c, a), side(a, b)];
        const whole = u + v + w;
        if (whole === 0 || u / whole < 0 || v / whole < 0 || w / whole < 0) continue;
        const depth = (u * a[2] + v * b[2] + w * c[2]) / whole;
        if (depth < nearest) [found, nearest] = [solid[at * FLOATS_PER_VERTEX + 10], depth];
      }
    });
    return found;
  }

  // Where a point of the world is on the page, in pixels of CSS from the corner of the canvas.
  onPage(p) {
    if (!this.matrix) return { x: 0, y: 0, ahead: false }; // a frame has no size before its page has laid it out
    const [x, y, , w] = project(this.matrix, p);
    const { clientWidth, clientHeight } = this.canvas;
    return { x: ((x + 1) / 2) * clientWidth, y: ((1 - y) / 2) * clientHeight, ahead: w > 0 };
  }
}

// Whether a batch moves with the robot now: its own bodies, its tool, and a part while it is held.
function mine(batch, tracks, t) {
  if (batch.body) return tracks.seat(batch.body, t).carrier === tracks.view.tool.carrier;
  return batch.kinds.has("robot") || batch.kinds.has("tool");
}

// In which direction from its base, rad, the arm works: the camera stands on that side, so that the arm does not hide
// its tool.
function workOf(tracks) {
  const base = tracks.carriers[0].at(0).p;
  const { points } = tracks.toolPath;
  let [x, y] = [0, 0];
  for (let k = 0; k < points.length; k += 3) {
    x += points[k] - base[0];
    y += points[k + 1] - base[1];
  }
  return Math.atan2(y, x);
}

// How far from its base, m, the arm may reach: the length of its links.
function reachOf(tracks) {
  const links = tracks.carriers.slice(0, tracks.view.tool.carrier + 1).map((carrier) => carrier.at(0).p);
  return links.slice(1).reduce((sum, p, k) => sum + Math.hypot(p[0] - links[k][0], p[1] - links[k][1]), 0);
}

// At so many times the robot is in the picture as a whole.
const TIMES = 50;

// What is seen of a cell at first: the robot wherever it moves, the path of its tool, the control points, and the bodies
// around as far as they are within the reach of the arm: belts and tables are often much longer. `points`: corners of all.
function boxOf(tracks, all) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const points = [];
  const take = (p) => {
    points.push(p);
    for (let k = 0; k < 3; k += 1) {
      low[k] = Math.min(low[k], p[k]);
      high[k] = Math.max(high[k], p[k]);
    }
  };
  const corners = (batch, t) => {
    const m = matrixOf(batch.body ? tracks.bodyPose(batch.body, t) : tracks.carriers[batch.carrier].at(t));
    return Array.from({ length: 8 }, (_, k) => {
      const corner = [0, 1, 2].map((i) => (k & (1 << i) ? batch.high[i] : batch.low[i]));
      return [0, 1, 2].map((r) => m[r] * corner[0] + m[4 + r] * corner[1] + m[8 + r] * corner[2] + m[12 + r]);
    });
  };
  const around = [];
  for (const batch of all) {
    if (batch.kinds.has("robot") || batch.kinds.has("tool")) {
      for (let k = 0; k <= TIMES; k += 1) corners(batch, (k / TIMES) * tracks.view.lasts_s).forEach(take);
    } else if (!batch.body || tracks.isThere(batch.body, 0)) around.push(...corners(batch, 0));
  }
  const { points: path } = tracks.toolPath;
  for (let k = 0; k < path.length; k += 3) take(Array.from(path.subarray(k, k + 3)));
  for (const point of tracks.view.control_points.filter((each) => tracks.belongs(each))) take(tracks.pointPose(point, point.time_s || 0).p);
  const floor = Math.min(low[2], ...around.map((p) => p[2]));
  const [base, reach] = [tracks.carriers[0].at(0).p, reachOf(tracks)];
  const [least, most] = [low.map((x, k) => Math.min(x, base[k] - reach)), high.map((x, k) => Math.max(x, base[k] + reach))];
  for (const p of around) take(p.map((x, k) => clamp(x, least[k], most[k])));
  const middle = [0, 1, 2].map((k) => (low[k] + high[k]) / 2);
  const radius = Math.hypot(...[0, 1, 2].map((k) => (high[k] - low[k]) / 2));
  return { points, middle, radius, floor, work: workOf(tracks) };
}
