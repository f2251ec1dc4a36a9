// Lines as wide as a length in the box or as so many pixels, whichever is wider: the box, bonds, contacts, streamlines and paths.

const lineVertex = `
in vec2 corner; in vec3 from, to; in vec4 widths, paint;
uniform mat4 view, projection; uniform vec3 shift; uniform vec2 window; uniform float pixels; uniform bool solid;
out vec4 tint; out vec3 place, seen;
void main() {
  vec4 a = view * vec4(from + shift, 1.0), b = view * vec4(to + shift, 1.0);
  vec4 pa = projection * a, pb = projection * b;
  vec2 way = (pb.xy / pb.w - pa.xy / pa.w) * window, side = normalize(length(way) > 1e-4 ? vec2(-way.y, way.x) : vec2(0.0, 1.0));
  float part = 0.5 * (corner.x + 1.0);
  vec4 p = mix(pa, pb, part);
  float scale = solid ? pixels / p.w : pixels;
  float wide = max(mix(widths.x, widths.y, part) * scale, mix(widths.z, widths.w, part));
  // opaque lines that follow each other meet without gaps
  vec2 reach = corner.x * normalize(way + vec2(1e-6, 0.0)) * min(0.25 * wide, 2.0) * step(0.999, paint.a);
  p.xy += (corner.y * side * 0.5 * wide + reach) * 2.0 / window * p.w;
  tint = paint; place = mix(from, to, part) + shift; seen = mix(a, b, part).xyz;
  gl_Position = p;
}`;

const lineFragment = `
in vec4 tint; in vec3 place, seen;
uniform vec2 box; uniform bool cut; uniform vec4 clip; uniform float fade;
out vec4 result;
void main() {
  if (cut && (any(lessThan(place.xy, vec2(-1e-4))) || any(greaterThan(place.xy, box + 1e-4)))) discard;
  if (dot(clip.xyz, seen) > clip.w) discard;
  result = vec4(mix(tint.rgb, vec3(1.0), fade), tint.a);
}`;

const lineProgram = gl && compiled(lineVertex, lineFragment);
const lineSet = () => gl && instances(lineProgram.program, ["from", "to", "widths", "paint"], [3, 3, 4, 4]);
const lineSets = { box: lineSet(), streams: lineSet(), bonds: lineSet(), contacts: lineSet(), path: lineSet() };

// One line: its ends, widths at both in lengths and in pixels, and its colour.
const line = (from, to, lengths, pixels, colour, alpha = 1) => [...from, ...to, ...lengths, ...pixels, ...colour.map((value) => value / 255), alpha];

function drawLines(name, matrices, shifts, { cut = false, fade = 0, clipped = true } = {}) {
  const set = lineSets[name];
  if (!set.count) return;
  const { uniforms } = lineProgram;
  useProgram(lineProgram, matrices);
  if (!clipped) gl.uniform4f(uniforms.clip, 0, 0, 0, 1e30);
  gl.uniform2f(uniforms.window, camera.window[0], camera.window[1]);
  gl.uniform1f(uniforms.pixels, dimension === 2 ? camera.pixels : camera.window[1] / 2 / opening);
  gl.uniform1i(uniforms.solid, dimension === 3 ? 1 : 0);
  gl.uniform2f(uniforms.box, size[0], size[1]);
  gl.uniform1i(uniforms.cut, cut ? 1 : 0);
  for (const shift of shifts) {
    gl.uniform3f(uniforms.shift, ...shift);
    gl.uniform1f(uniforms.fade, shift.some((value) => value !== 0) ? fade : 0);
    set.draw();
  }
}

// The edges of the box: walls are thick, what repeats or is open is thin.
function fillBox() {
  const lines = [];
  const wide = dimension === 2 ? 3 : 1.6;
  const corner = (bits) => [0, 1, 2].map((axis) => (bits & (1 << axis) ? size[axis] : 0));
  for (let bits = 0; bits < 2 ** dimension; bits++) {
    for (let axis = 0; axis < dimension; axis++) {
      if (bits & (1 << axis)) continue;
      // in 2D an edge bounds the other axis; in 3D it belongs to the faces of two others
      const others = [0, 1, 2].filter((other) => other !== axis && other < dimension);
      const wall = others.some((other) => index.bounds[other] === "walls");
      lines.push(...line(corner(bits), corner(bits | (1 << axis)), [0, 0], wall ? [wide, wide] : [1.2, 1.2], wall ? ink : [150, 158, 170]));
    }
  }
  lineSets.box.fill(new Float32Array(lines));
}

function fillBonds(frame) {
  const lines = [];
  for (let k = 0; k < frame.bond_from.length && state.bonds; k++) {
    const [from, to] = [frame.bond_from[k], frame.bond_to[k]].map((body) => centre(frame, body));
    const wide = 0.42 * frame.radius[frame.bond_from[k]];
    const end = along3(from, nearestWay(frame, from, to));
    const colour = state.colour === "chain" ? distinct(frame.bond_chain[k]).map((value) => 0.6 * value) : [70, 78, 94];
    lines.push(...line(from, end, [wide, wide], [1, 1], colour));
  }
  lineSets.bonds.fill(new Float32Array(lines));
}

const along3 = (from, way) => [0, 1, 2].map((axis) => from[axis] + (way[axis] ?? 0));
const contactScale = { force: 1, known: false };

// Red where a contact bears no friction, to orange where friction is as large, over the normal force, as at any contact of the frame; blue where it pulls.
function contactColour(frame, k, most) {
  if (frame.contact_force[k] < 0) return [0, 114, 178];
  const part = most > 0 ? frame.contact_friction[k] / frame.contact_force[k] / most : 0;
  return [140 + 90 * part, 30 + 129 * part, 24 - 24 * part];
}

// The largest force of friction over the normal force.
function mostFriction(frame) {
  return frame.contact_friction ? frame.contact_friction.reduce((most, friction, k) => Math.max(most, frame.contact_force[k] > 0 ? friction / frame.contact_force[k] : 0), 0) : 0;
}

// Contacts from centre to centre, as wide as their force.
function fillContacts(frame) {
  const [lines, most] = [[], mostFriction(frame)];
  for (let k = 0; k < (frame.contact_body?.length ?? 0) && state.contacts; k++) {
    const [body, partner] = [frame.contact_body[k], frame.contact_partner[k]];
    const reach = frame.radius[body] + frame.contact_gap[k] + (partner < 0 ? 0 : frame.radius[partner]);
    const from = centre(frame, body);
    const to = along3(from, axisNames.map((axis) => reach * frame[`contact_${axis}`][k]));
    const part = Math.min(Math.abs(frame.contact_force[k]) / contactScale.force, 1.5);
    const wide = 0.75 * radiusScale.mean * part;
    lines.push(...line(from, to, [wide, wide], [0.8, 0.8], contactColour(frame, k, most), 0.5 + 0.45 * Math.min(part, 1)));
  }
  lineSets.contacts.fill(new Float32Array(lines));
}

// The force whose line is three quarters of a radius wide: large ones of a frame in the middle of the run.
function learnForces(frames) {
  const tops = frames.filter((frame) => frame.contact_force?.length).map((frame) => robustMaximum(thinned(frame.contact_force, 50000).map(Math.abs), 0.95));
  contactScale.known = tops.length > 0;
  contactScale.force = tops.sort((one, other) => one - other)[Math.floor(tops.length / 2)] || 1;
}
