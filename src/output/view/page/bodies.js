// Disks, and spheres found by rays that meet them.

const bodyVertex = `
in vec2 corner; in vec4 ball; in vec3 colour; in vec4 turn;
uniform mat4 view, projection; uniform vec3 shift; uniform float size; uniform bool solid;
out vec2 local; out vec3 tint, ray, middle, place; out vec4 rotation; flat out float radius;
void main() {
  vec3 at = ball.xyz + shift;
  vec4 c = view * vec4(at, 1.0);
  float r = ball.w * size;
  tint = colour; rotation = turn; middle = c.xyz; radius = r; local = 1.04 * corner;
  vec3 p = c.xyz + vec3(r * local, 0.0);
  if (solid) {
    float d2 = dot(c.xyz, c.xyz), s = sqrt(max(1.0 - r * r / d2, 1e-6));
    vec3 n = normalize(c.xyz), x = normalize(cross(n, vec3(0.0, 1.0, 0.001))), y = cross(x, n);
    p = c.xyz * s * s + r * s * (local.x * x + local.y * y);
  }
  ray = p; place = at + vec3(r * local, 0.0);
  gl_Position = projection * vec4(p, 1.0);
}`;

const diskFragment = `
in vec2 local; in vec3 tint, ray, middle, place; in vec4 rotation; flat in float radius;
uniform vec2 box; uniform bool cut; uniform float fade, pale, marks, pixels;
out vec4 result;
void main() {
  if (cut && (any(lessThan(place.xy, vec2(0.0))) || any(greaterThan(place.xy, box)))) discard;
  float d = length(local), w = fwidth(d), r = radius * pixels;
  vec3 c = mix(tint, vec3(1.0), pale);
  float rim = smoothstep(1.0 - max(1.6 / r, 0.05) - w, 1.0 - max(1.6 / r, 0.05), d);
  c = mix(c, 0.62 * c, r > 2.5 ? 0.9 * rim : 0.0);
  vec2 m = local - 0.58 * vec2(cos(rotation.x), sin(rotation.x));
  float mark = marks * step(4.0, r) * (1.0 - smoothstep(0.15 - 0.5 * w, 0.15 + 0.5 * w, length(m)));
  c = mix(c, vec3(1.0), 0.85 * mark);
  result = vec4(mix(c, vec3(1.0), fade), 1.0 - smoothstep(1.0 - w, 1.0, d));
}`;

const sphereFragment = `
in vec2 local; in vec3 tint, ray, middle, place; in vec4 rotation; flat in float radius;
uniform mat4 view, projection; uniform vec4 clip; uniform vec2 depths; uniform float fade, pale, marks, pixels;
out vec4 result;
vec3 turned(vec4 q, vec3 v) { vec3 t = 2.0 * cross(-q.xyz, v); return v + q.w * t + cross(-q.xyz, t); }
void main() {
  vec3 dir = normalize(ray);
  float b = dot(dir, middle), away = sqrt(max(dot(middle, middle) - b * b, 0.0));
  float half_ = sqrt(max(radius * radius - away * away, 0.0)), near = b - half_, far = b + half_;
  float edge = clamp((radius - away) / max(fwidth(away), 1e-9) + 0.5, 0.0, 1.0);
  if (edge <= 0.0) discard;
  vec3 p = dir * near, n = normalize(p - middle);
  bool capped = false;
  if (dot(clip.xyz, p) > clip.w) {
    float t = clip.w / dot(clip.xyz, dir);
    if (t < near || t > far) discard;
    p = dir * t; n = clip.xyz; capped = true; edge = 1.0;
  }
  vec3 c = mix(tint, vec3(1.0), pale);
  if (capped) {
    float height = dot(clip.xyz, middle) - clip.w;
    float rim = sqrt(max(dot(p - middle, p - middle) - height * height, 0.0)), inner = sqrt(max(radius * radius - height * height, 0.0));
    c = mix(mix(c, vec3(1.0), 0.12), 0.45 * c, smoothstep(inner - max(0.05 * inner, fwidth(rim)), inner, rim));
  } else {
    vec3 own = abs(turned(rotation, transpose(mat3(view)) * n));
    float spot = smoothstep(0.968, 0.976, max(own.x, max(own.y, own.z))) * step(7.0, radius / -middle.z * pixels);
    c = mix(c, 0.6 * c, marks * spot);
    float key = 0.5 + 0.5 * dot(n, normalize(vec3(-0.35, 0.75, 0.6))), front = max(n.z, 0.0);
    float shine = pow(max(dot(n, normalize(vec3(-0.3, 0.65, 1.1))), 0.0), 40.0);
    c = c * (0.30 + 0.58 * key * key + 0.22 * front) * mix(0.55, 1.0, smoothstep(0.0, 0.42, front)) + 0.16 * shine;
  }
  float depth = clamp((-p.z - depths.x) / (depths.y - depths.x), 0.0, 1.0);
  c = mix(c, vec3(0.93, 0.95, 0.97), 0.42 * depth * depth);
  vec4 at = projection * vec4(p, 1.0);
  gl_FragDepth = 0.5 * at.z / at.w + 0.5;
  result = vec4(mix(c, vec3(1.0), fade), edge);
}`;

const bodyProgram = gl && compiled(bodyVertex, dimension === 2 ? diskFragment : sphereFragment);
const bodyInstances = gl && instances(bodyProgram.program, ["ball", "colour", "turn"], [4, 3, 4]);

// What bodies were coloured by last.
let painted = null;

// Gives the bodies of a frame, or their images so many boxes above, their places and colours.
function fillBodies(frame, quantity, range, boxes = 0) {
  painted = { quantity, range };
  const values = valuesOfImages(frame, quantity, boxes);
  const entries = new Float32Array(11 * frame.count);
  for (let body = 0; body < frame.count; body++) {
    const colour = colourOf(quantity, range, values?.[body]);
    const start = 11 * body;
    entries.set(centre(frame, body), start);
    entries[start + 3] = frame.radius[body];
    for (let k = 0; k < 3; k++) entries[start + 4 + k] = colour[k] / 255;
    if (frame.angle) {
      entries[start + 7] = frame.angle[body];
    } else {
      const turn = [frame.turn_x[body], frame.turn_y[body], frame.turn_z[body]];
      entries.set([...turn, Math.sqrt(Math.max(0, 1 - dot(turn, turn)))], start + 7);
    }
  }
  bodyInstances.fill(entries);
}

function drawBodies(frame, matrices) {
  const { uniforms } = bodyProgram;
  useProgram(bodyProgram, matrices);
  gl.uniform1i(uniforms.solid, dimension === 3 ? 1 : 0);
  gl.uniform1f(uniforms.size, state.size);
  gl.uniform1f(uniforms.marks, state.marks ? 1 : 0);
  gl.uniform1f(uniforms.pale, dimension === 2 && state.contacts && frame.contact_body?.length ? 0.45 : 0);
  gl.uniform1f(uniforms.pixels, dimension === 2 ? camera.pixels : camera.window[1] / 2 / opening);
  gl.uniform2f(uniforms.box, size[0], size[1]);
  gl.uniform2f(uniforms.depths, camera.distance - 0.5 * diagonal, camera.distance + 0.6 * diagonal);
  // coverage makes edges smooth: blending would show what lies behind the bodies that are drawn later
  if (dimension === 3) [gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE), gl.disable(gl.BLEND)];
  const draw = (shift, fade, cut) => {
    gl.uniform3f(uniforms.shift, ...shift);
    gl.uniform1f(uniforms.fade, fade);
    gl.uniform1i(uniforms.cut, cut ? 1 : 0);
    bodyInstances.draw();
  };
  const seams = state.images === "seams" && dimension === 2;
  if (state.images === "around" || seams) {
    const repaint = (boxes) => painted.quantity.key === "speed" && frame.offset !== null && fillBodies(frame, painted.quantity, painted.range, boxes);
    for (const boxes of [-1, 1, 0]) {
      const shifts = imageShifts(frame).filter((shift) => Math.round(shift[1] / size[1]) === boxes);
      repaint(boxes);
      shifts.forEach((shift) => draw(shift, seams ? 0 : 0.55, seams));
    }
  }
  draw([0, 0, 0], 0, seams);
  gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  gl.enable(gl.BLEND);
}
