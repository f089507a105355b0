// Light on exact surfaces, as in `viewer/light.py` and `viewer/render.py`.

const COMMON = `
precision highp float; precision highp int; precision highp sampler2D;
uniform sampler2D surfaces, shifts;
uniform float explode;
vec4 surfaceTexel(int i, int k) { int t = 3 * i + k; return texelFetch(surfaces, ivec2(t % 1536, t / 1536), 0); }
vec3 shiftOf(int part) { return explode * texelFetch(shifts, ivec2(part % 1024, part / 1024), 0).xyz; }
`;

export const MESH_VERTEX = `${COMMON}
in vec3 position; in float surface, side; in vec2 light;
uniform mat4 modelViewMatrix, projectionMatrix;
out vec3 own, world; out vec2 sky; flat out int row; flat out float kind;
void main() {
  row = int(surface + 0.5); kind = side; sky = light; own = position;
  world = position;
  if (explode > 0.0) world += shiftOf(int(surfaceTexel(row, 1).w + 0.5));
  gl_Position = projectionMatrix * modelViewMatrix * vec4(world, 1.0);
}`;

export const MESH_FRAGMENT = `${COMMON}
in vec3 own, world; in vec2 sky; flat in int row; flat in float kind;
uniform sampler2D colors;
uniform int shading, selected, picking; uniform bool cuts, solid;
uniform vec3 eye, right, back, sun; uniform vec4 plane;
out vec4 pixel;
const float STRIPES = 14.0;

vec3 daylight(vec3 n, float open, float sunshine) {
  float up = n.z;
  return open * (0.5 + 0.5 * up) * vec3(0.52, 0.55, 0.60)
    + (0.35 + 0.65 * open) * (0.5 - 0.5 * up) * vec3(0.26, 0.25, 0.24)
    + sunshine * max(dot(n, sun), 0.0) / sun.z * vec3(0.48, 0.45, 0.40);
}

void main() {
  if (cuts && dot(world, plane.xyz) > plane.w) discard;
  vec4 first = surfaceTexel(row, 0), second = surfaceTexel(row, 1);
  vec3 axis = surfaceTexel(row, 2).xyz;
  int part = int(second.w + 0.5);
  if (picking == 2) {
    // The distance from the eye, in four bytes.
    float rest = length(world - eye) / 64.0;
    vec4 bytes;
    for (int k = 0; k < 4; k++) { rest *= 256.0; bytes[k] = floor(rest); rest -= bytes[k]; }
    pixel = bytes / 255.0;
    return;
  }
  if (picking == 1) {
    int id = part + 1;
    pixel = vec4(float(id & 255), float((id >> 8) & 255), float((id >> 16) & 255), 255.0) / 255.0;
    return;
  }
  // The exact normal: planes have A = 0, cylinders an axis. Triangles lie a little off their
  // surface: a step of Newton along the ray leads onto it. Inner faces lie on another sphere
  // about the same centre, which their surface does not tell.
  vec3 ray = normalize(world - eye);
  vec3 d = own - second.xyz;
  d -= dot(d, axis) * axis;
  vec3 n = first.xyz - 2.0 * first.w * d;
  float miss = kind == 1.0 ? 0.0 : first.w * dot(d, d) - dot(first.xyz, d), slope = dot(n, ray);
  n -= 2.0 * first.w * miss * slope / (slope * slope + 0.0001) * (ray - dot(ray, axis) * axis);
  n = normalize(n);
  if (kind == 1.0) n = -n;
  bool turned = dot(n, ray) > 0.0;
  if (turned) n = -n;
  bool inside = kind == 1.0 != turned;
  vec4 own_color = texelFetch(colors, ivec2(part % 1024, part / 1024), 0);
  vec3 paint = pow(own_color.rgb, vec3(2.2));
  if (cuts && solid && !gl_FrontFacing) {
    pixel = vec4(mix(own_color.rgb, vec3(0.80, 0.36, 0.25), 0.75), 1.0);
    return;
  }
  float open = kind >= 2.0 ? max(sky.x, sky.y) : (inside ? sky.y : sky.x);
  if (kind >= 3.0) open = 0.6;
  float sunshine = inside && kind < 2.0 ? 0.0 : smoothstep(0.30, 0.62, open);
  vec3 light = daylight(n, open, sunshine);
  vec3 mirrored = reflect(ray, n);
  float facing = -dot(n, ray);
  vec3 tone;
  if (shading == 1 && kind < 2.0) {
    float turn = STRIPES * asin(clamp(dot(mirrored, right), -0.9999, 0.9999));
    float sharp = min(6.0, 1.2 / max(fwidth(turn), 0.0001));
    float stripe = 0.5 + 0.5 * tanh(sharp * cos(turn));
    tone = (0.06 + 0.84 * stripe) * (0.55 + 0.45 * light.g) * mix(vec3(0.97, 0.99, 1.0), paint * 1.25, 0.12);
  } else if (shading == 2 && kind < 2.0) {
    // A few long lamps overhead, mirrored in dark polish.
    float angle = degrees(atan(dot(mirrored, back), max(mirrored.z, 0.001)));
    float lamp = 0.0, soft = max(fwidth(angle), 0.4);
    for (int k = 0; k < 7; k++) {
      lamp = max(lamp, 1.0 - smoothstep(1.4, 1.4 + soft, abs(angle - float(k - 3) * 17.0)));
    }
    lamp *= step(0.0, mirrored.z);
    vec3 polish = paint * 0.28 * (0.5 + 0.5 * light) + 0.05 * clamp(0.4 + mirrored.z, 0.0, 1.0);
    tone = mix(polish, vec3(0.96, 0.98, 1.0), lamp * (0.55 + 0.45 * light.g));
  } else {
    if (inside && kind < 2.0) paint = 0.35 * paint + 0.65 * 0.62 * vec3(0.76, 0.76, 0.74);
    float sheen = (0.03 + 0.3 * pow(1.0 - facing, 5.0)) * clamp(0.3 + mirrored.z, 0.0, 1.0);
    tone = paint * light + sheen * light.g;
  }
  vec3 color = pow(clamp(tone, 0.0, 1.0), vec3(1.0 / 2.2));
  // What a filter leaves out stays as a ghost.
  if (own_color.a < 0.5) color = mix(color, vec3(0.93, 0.935, 0.94), 0.86);
  if (part == selected) color = mix(color, vec3(0.93, 0.43, 0.10), 0.62);
  pixel = vec4(color, 1.0);
}`;

export const LINE_VERTEX = `${COMMON}
in vec3 position; in float part;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform float pull;
out vec3 world; flat out int row;
void main() {
  row = int(part + 0.5);
  world = position;
  if (explode > 0.0) world += shiftOf(row);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(world, 1.0);
  gl_Position.z -= pull * gl_Position.w;
}`;

export const LINE_FRAGMENT = `${COMMON}
in vec3 world; flat in int row;
uniform sampler2D colors; uniform vec4 plane, ink; uniform bool cuts; uniform int only;
out vec4 pixel;
void main() {
  if (cuts && dot(world, plane.xyz) > plane.w) discard;
  if (only >= 0 && row != only) discard;
  float ghost = only < -1 || texelFetch(colors, ivec2(row % 1024, row / 1024), 0).a > 0.5 ? 1.0 : 0.25;
  pixel = vec4(ink.rgb, ink.a * ghost);
}`;

// Parts that are missing, once they are asked for: nothing hides them.
export const GHOST_FRAGMENT = `${COMMON}
in vec3 world; flat in int row;
uniform sampler2D colors; uniform vec4 ink; uniform int selected; uniform bool marked;
out vec4 pixel;
void main() {
  bool asked = marked && texelFetch(colors, ivec2(row % 1024, row / 1024), 0).a > 0.5;
  if (row != selected && !asked) discard;
  pixel = vec4(ink.rgb, row == selected ? ink.a : 0.6 * ink.a);
}`;

// The selected beam or node, through what lies over it.
export const THROUGH_FRAGMENT = `${COMMON}
flat in int row;
uniform int selected;
out vec4 pixel;
void main() {
  if (int(surfaceTexel(row, 1).w + 0.5) != selected) discard;
  pixel = vec4(0.93, 0.43, 0.10, 0.45);
}`;

export const GROUND_VERTEX = `
precision highp float;
in vec3 position; in vec2 uv; uniform mat4 modelViewMatrix, projectionMatrix;
out vec2 place;
void main() { place = uv; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;

export const GROUND_FRAGMENT = `
precision highp float;
in vec2 place; uniform sampler2D shade; out vec4 pixel;
void main() {
  float edge = smoothstep(0.5, 0.36, length(place - 0.5));
  float dark = 1.0 - texture(shade, place).r;
  pixel = vec4(vec3(0.16, 0.18, 0.21), 0.62 * edge * dark);
}`;
