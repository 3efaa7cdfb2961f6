// Vectors, quaternions and matrices, just as many as a page that draws needs. Matrices are column by column, as WebGL
// takes them; quaternions are x, y, z, w.

export function subtract(a, b) {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

export function add(a, b, factor = 1) {
  return [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
}

export function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function length(a) {
  return Math.hypot(a[0], a[1], a[2]);
}

export function unit(a) {
  const size = length(a);
  return size > 0 ? [a[0] / size, a[1] / size, a[2] / size] : [0, 0, 0];
}

export function clamp(value, low, high) {
  return Math.min(high, Math.max(low, value));
}

// The attitude at a share of the shorter arc between two: what the tracks of a view promise to be within 0.1 mm.
export function slerp(a, b, share) {
  let cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const sign = cosine < 0 ? -1 : 1;
  cosine = Math.min(1, Math.abs(cosine));
  const angle = Math.acos(cosine);
  let first = 1 - share;
  let second = share;
  if (angle > 1e-4) {
    first = Math.sin((1 - share) * angle) / Math.sin(angle);
    second = Math.sin(share * angle) / Math.sin(angle);
  }
  const found = [0, 1, 2, 3].map((k) => first * a[k] + sign * second * b[k]);
  const size = Math.hypot(...found);
  return found.map((x) => x / size);
}

export function rotate(q, p) {
  const u = [q[0], q[1], q[2]];
  const once = cross(u, p);
  const twice = cross(u, once);
  return [0, 1, 2].map((k) => p[k] + 2 * (q[3] * once[k] + twice[k]));
}

export function timesQuaternion(a, b) {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

// A pose {p, q} and one that is fixed in it.
export function then(pose, child) {
  return { p: add(pose.p, rotate(pose.q, child.p)), q: timesQuaternion(pose.q, child.q) };
}

export function turn(yaw) {
  return [0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)];
}

export function matrixOf(pose) {
  const [x, y, z, w] = pose.q;
  const [px, py, pz] = pose.p;
  return new Float32Array([
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
    px, py, pz, 1,
  ]);
}

export function multiply(a, b) {
  const found = new Float32Array(16);
  for (let column = 0; column < 4; column += 1) {
    for (let row = 0; row < 4; row += 1) {
      let sum = 0;
      for (let k = 0; k < 4; k += 1) sum += a[4 * k + row] * b[4 * column + k];
      found[4 * column + row] = sum;
    }
  }
  return found;
}

export function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2);
  return new Float32Array([
    f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0,
  ]);
}

export function orthographic(halfHeight, aspect, near, far) {
  return new Float32Array([
    1 / (halfHeight * aspect), 0, 0, 0, 0, 1 / halfHeight, 0, 0, 0, 0, 2 / (near - far), 0,
    0, 0, (far + near) / (near - far), 1,
  ]);
}

export function lookAt(eye, target, up) {
  const back = unit(subtract(eye, target));
  const right = unit(cross(up, back));
  const above = cross(back, right);
  return new Float32Array([
    right[0], above[0], back[0], 0, right[1], above[1], back[1], 0, right[2], above[2], back[2], 0,
    -dot(right, eye), -dot(above, eye), -dot(back, eye), 1,
  ]);
}

// A point through a matrix, divided: what is on the screen lies between -1 and 1.
export function project(matrix, p) {
  const out = [0, 1, 2, 3].map((r) => matrix[r] * p[0] + matrix[4 + r] * p[1] + matrix[8 + r] * p[2] + matrix[12 + r]);
  return [out[0] / out[3], out[1] / out[3], out[2] / out[3], out[3]];
}
