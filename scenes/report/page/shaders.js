// Programs for the graphics processor, as text.

const HEAD = `#version 300 es
precision highp float;
`;

// A vertex is moved outwards for shells: by what is not known of where its body is, or by a clearance.
export const SOLID_VERTEX = `${HEAD}
layout(location = 0) in vec3 point;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 outward;
layout(location = 3) in vec2 names;
layout(location = 4) in vec3 unknown;
uniform mat4 project, model;
uniform float clearance, unknownShare, seconds, floorHeight, shadow;
uniform vec3 light;
out vec3 world, facing;
flat out float kind, body;
void main() {
  vec4 at = model * vec4(point, 1.0);
  mat3 axes = mat3(model);
  vec3 out3 = axes * outward;
  float flatAmount = unknown.x + unknown.y * seconds;
  at.xyz += clearance * out3 + unknownShare * out3 * vec3(flatAmount, flatAmount, unknown.z);
  if (shadow > 0.5) at.xyz -= light * ((at.z - floorHeight) / light.z);
  world = at.xyz;
  facing = axes * normal;
  kind = names.x;
  body = names.y;
  gl_Position = project * at;
}`;

export const SOLID_FRAGMENT = `${HEAD}
in vec3 world, facing;
flat in float kind, body;
uniform vec3 colours[5];
uniform vec3 eye, light, hotColour, chosenColour, tint;
uniform vec2 hot, chosen;
uniform vec3 focus;
uniform float alpha, tinted, lit, hotShare, hole;
out vec4 colour;
// Whether a point of the surroundings hides the tool: it is before it, above it, and near the line from the eye to it.
bool hides() {
  vec3 way = focus - eye;
  float along = dot(world - eye, way) / dot(way, way);
  float beside = length(world - eye - along * way);
  return kind > 2.5 && hole > 0.0 && along < 0.97 && world.z > focus.z + 0.03 && beside < hole;
}
void main() {
  if (lit > 0.5 && hides()) discard;
  vec3 base = mix(colours[int(kind + 0.5)], tint, tinted);
  if (abs(body - hot.x) < 0.5 || abs(body - hot.y) < 0.5) base = mix(base, hotColour, hotShare);
  if (body > chosen.x - 0.5 && body < chosen.y + 0.5) base = mix(base, chosenColour, 0.6);
  if (lit < 0.5) { colour = vec4(base, alpha); return; }
  vec3 n = normalize(facing);
  vec3 toEye = normalize(eye - world);
  if (dot(n, toEye) < 0.0) n = -n;
  float key = max(dot(n, light), 0.0);
  float sky = 0.5 + 0.5 * n.z;
  float gloss = pow(max(dot(n, normalize(light + toEye)), 0.0), 42.0);
  float rim = pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
  float fill = max(dot(n, toEye), 0.0);
  vec3 shade = base * (0.26 + 0.24 * sky + 0.38 * key + 0.2 * fill) + vec3(0.10 * gloss + 0.05 * rim);
  colour = vec4(shade, alpha);
}`;

// The floor: lines every 0.1 m and stronger ones every metre, which fade with the distance from the middle.
export const FLOOR_VERTEX = `${HEAD}
uniform mat4 project;
uniform vec3 middle;
uniform float size;
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  place = middle.xy + size * corner;
  gl_Position = project * vec4(place, middle.z, 1.0);
}`;

export const FLOOR_FRAGMENT = `${HEAD}
in vec2 place;
uniform vec3 middle, line, ground;
uniform float size, groundAlpha;
out vec4 colour;
float grid(float spacing) {
  vec2 at = place / spacing;
  vec2 width = fwidth(at);
  vec2 near = abs(fract(at - 0.5) - 0.5) / width;
  // lines that would run into each other fade away
  float crowded = 1.0 - smoothstep(0.2, 0.6, max(width.x, width.y));
  return (1.0 - min(min(near.x, near.y), 1.0)) * crowded;
}
void main() {
  float fade = 1.0 - smoothstep(0.25, 1.0, length(place - middle.xy) / size);
  float lines = max(0.35 * grid(0.1), 0.8 * grid(1.0));
  colour = vec4(mix(ground, line, lines), fade * max(groundAlpha, lines));
}`;

// Lines of any width: each segment is four corners beside its two ends. The colour changes at `seconds`.
export const LINE_VERTEX = `${HEAD}
layout(location = 0) in vec4 begin;
layout(location = 1) in vec4 end;
uniform mat4 project, model;
uniform vec2 pixels;
uniform float width;
out float time, across;
void main() {
  vec4 a = project * model * vec4(begin.xyz, 1.0);
  vec4 b = project * model * vec4(end.xyz, 1.0);
  float side = float(gl_VertexID & 1) * 2.0 - 1.0;
  bool last = gl_VertexID > 1;
  vec2 way = (b.xy / b.w - a.xy / a.w) * pixels;
  float size = length(way);
  vec2 along = size > 1e-6 ? way / size : vec2(1.0, 0.0);
  // half a width beyond each end, so that corners close
  vec2 offset = (vec2(-along.y, along.x) * side + along * (last ? 0.5 : -0.5)) * (width + 1.0) / pixels;
  vec4 at = last ? b : a;
  time = last ? end.w : begin.w;
  across = side * (width + 1.0) / max(width, 0.001);
  gl_Position = vec4(at.xy + offset * at.w, at.z, at.w);
}`;

export const LINE_FRAGMENT = `${HEAD}
in float time, across;
uniform vec4 past, future;
uniform float seconds;
out vec4 colour;
void main() {
  colour = time <= seconds ? past : future;
  colour.a *= 1.0 - smoothstep(0.8, 1.2, abs(across));
}`;
