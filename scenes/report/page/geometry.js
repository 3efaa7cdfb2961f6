// Meshes made ready to be drawn: normals that are smooth on round surfaces and sharp at edges, the edges themselves,
// and batches. Each batch is one draw call.
import { add, cross, dot, length, rotate, subtract, turn, unit } from "./numbers.js";
import { unpack } from "./tracks.js";

// Faces that meet at less than this angle are parts of one round surface.
const SMOOTH = Math.cos((35 * Math.PI) / 180);
// A shell keeps its distance from the faces that meet at a corner; where these meet sharply it would become a spike.
const LONGEST_SPIKE = 2;
export const FLOATS_PER_VERTEX = 14;

function facesOf(mesh) {
  const grid = unpack(mesh.vertices);
  const faces = unpack(mesh.faces);
  const points = [];
  for (let k = 0; k < grid.length; k += 3) {
    points.push([0, 1, 2].map((i) => mesh.low_m[i] + mesh.step_m[i] * grid[k + i]));
  }
  const triangles = [];
  for (let k = 0; k < faces.length; k += 3) {
    const corners = [faces[k], faces[k + 1], faces[k + 2]];
    const [a, b, c] = corners.map((corner) => points[corner]);
    const normal = cross(subtract(b, a), subtract(c, a));
    if (length(normal) > 0) triangles.push({ corners, weighted: normal, normal: unit(normal) });
  }
  return { points, triangles };
}

// The directions in which a vertex moves when all faces around it move outwards by 1: the sum of those of its surfaces.
function spikes(points, around) {
  return points.map((_, k) => {
    const groups = [];
    for (const face of around[k]) {
      const group = groups.find((each) => dot(each.normal, face.normal) > SMOOTH);
      if (group) group.sum = add(group.sum, face.weighted);
      else groups.push({ normal: face.normal, sum: face.weighted });
    }
    const sum = groups.reduce((total, group) => add(total, unit(group.sum)), [0, 0, 0]);
    const size = length(sum);
    return size > LONGEST_SPIKE ? sum.map((x) => (x * LONGEST_SPIKE) / size) : sum;
  });
}

// Corners (position, normal, direction of a shell) three by three, and edges, pairs of points.
export function prepared(mesh) {
  const { points, triangles } = facesOf(mesh);
  const around = points.map(() => []);
  for (const face of triangles) for (const corner of face.corners) around[corner].push(face);
  const outwards = spikes(points, around);
  const corners = [];
  const sides = new Map();
  for (const face of triangles) {
    face.corners.forEach((corner, k) => {
      let sum = [0, 0, 0];
      for (const other of around[corner]) if (dot(other.normal, face.normal) > SMOOTH) sum = add(sum, other.weighted);
      corners.push({ point: points[corner], normal: unit(sum), outward: outwards[corner] });
      const next = face.corners[(k + 1) % 3];
      const key = corner < next ? `${corner} ${next}` : `${next} ${corner}`;
      if (!sides.has(key)) sides.set(key, { ends: [corner, next], faces: [] });
      sides.get(key).faces.push(face);
    });
  }
  const edges = [];
  for (const { ends, faces } of sides.values()) {
    if (faces.length !== 2 || dot(faces[0].normal, faces[1].normal) < SMOOTH) edges.push(ends.map((end) => points[end]));
  }
  return { corners, edges };
}

function write(target, at, point, normal, outward, body) {
  const unknown = body.unknown || { horizontal_m: 0, growth_m_s: 0, vertical_m: 0 };
  target.set(
    [
      ...point, ...normal, ...outward, body.kindNumber, body.number,
      unknown.horizontal_m, unknown.growth_m_s, unknown.vertical_m,
    ],
    at,
  );
}

// The shapes of the last view, by the numbers of their meshes: most are in the next one, too.
let known = new Map();
function shapesOf(meshes) {
  const now = new Map();
  const shapes = meshes.map((mesh) => {
    const key = JSON.stringify(mesh);
    if (!now.has(key)) now.set(key, known.get(key) || prepared(mesh));
    return now.get(key);
  });
  known = now;
  return shapes;
}

export const KINDS = ["robot", "tool", "part", "body", "neighbour"];

// Bodies that are always on their carrier are one batch with all others on it, in its frame; a part that is carried, comes
// or goes is a batch of its own, in its own frame. So there are few draw calls, however many bodies stand around.
export function batches(view) {
  const shapes = shapesOf(view.meshes);
  const found = new Map();
  view.bodies.forEach((body, number) => {
    const alone = body.seats.length > 1 || body.seats[0].from_s > 0 || body.gone_s !== null;
    const key = alone ? `body ${number}` : `carrier ${body.seats[0].carrier}`;
    if (!found.has(key)) found.set(key, { body: alone ? body : null, carrier: body.seats[0].carrier, members: [] });
    found.get(key).members.push({ body: { ...body, number }, alone });
  });
  return [...found.values()].map((batch) => filled(batch, shapes));
}

function filled(batch, shapes) {
  const count = (what) => batch.members.reduce((sum, { body }) => sum + shapes[body.mesh][what].length, 0);
  const solid = new Float32Array(FLOATS_PER_VERTEX * count("corners"));
  const edges = new Float32Array(2 * FLOATS_PER_VERTEX * count("edges"));
  let at = 0;
  let atEdge = 0;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const { body, alone } of batch.members) {
    const own = { ...body, kindNumber: KINDS.indexOf(body.kind) };
    const seat = body.seats[0];
    const q = alone ? turn(0) : turn(seat.yaw_rad);
    const place = (p) => (alone ? p : add(seat.at_m, rotate(q, p)));
    for (const corner of shapes[body.mesh].corners) {
      const point = place(corner.point);
      write(solid, at, point, rotate(q, corner.normal), rotate(q, corner.outward), own);
      at += FLOATS_PER_VERTEX;
      for (let k = 0; k < 3; k += 1) {
        low[k] = Math.min(low[k], point[k]);
        high[k] = Math.max(high[k], point[k]);
      }
    }
    for (const ends of shapes[body.mesh].edges) {
      for (const end of ends) {
        write(edges, atEdge, place(end), [0, 0, 1], [0, 0, 0], own);
        atEdge += FLOATS_PER_VERTEX;
      }
    }
  }
  const members = batch.members.map(({ body }) => body);
  return {
    carrier: batch.carrier,
    body: batch.body,
    members,
    kinds: new Set(members.map((body) => body.kind)),
    unknown: members.some((body) => body.unknown),
    solid,
    edges,
    vertices: solid.length / FLOATS_PER_VERTEX,
    edgeVertices: edges.length / FLOATS_PER_VERTEX,
    low,
    high,
  };
}
