// The flow: a coloured sheet, and short streamlines that are wider where they lead to.

function flowSpeed(frame) {
  const [u, v, w] = [frame.flow_across, frame.flow_up, frame.flow_normal];
  return u.map((value, k) => Math.hypot(value, v[k], w ? w[k] : 0));
}

function flowNonAffine(frame) {
  const [columns, rows] = frame.flow.cells;
  const [v, w] = [frame.flow_up, frame.flow_normal];
  return frame.flow_across.map((u, k) => Math.hypot(u - affine(((Math.floor(k / columns) + 0.5) * size[up]) / rows), v[k], w ? w[k] : 0));
}

// Counterclockwise as seen, from differences of the cells beside and one-sided ones at the edges.
function flowVorticity(frame) {
  const [columns, rows] = frame.flow.cells;
  const [dx, dy] = [size[across] / columns, size[up] / rows];
  const [u, v] = [frame.flow_across, frame.flow_up];
  return u.map((_, k) => {
    const [i, j] = [k % columns, Math.floor(k / columns)];
    const [left, right, below, above] = [Math.max(i - 1, 0), Math.min(i + 1, columns - 1), Math.max(j - 1, 0), Math.min(j + 1, rows - 1)];
    const turning = right > left ? (v[j * columns + right] - v[j * columns + left]) / ((right - left) * dx) : 0;
    return turning - (above > below ? (u[above * columns + i] - u[below * columns + i]) / ((above - below) * dy) : 0);
  });
}

const sheetProgram = gl && compiled(`
in vec2 corner; in vec3 origin;
uniform mat4 view, projection; uniform vec3 right, above, shift;
out vec2 part; out vec3 place;
void main() {
  part = 0.5 * (corner + 1.0);
  place = origin + shift + part.x * right + part.y * above;
  gl_Position = projection * view * vec4(place, 1.0);
}`, `
in vec2 part; in vec3 place;
uniform sampler2D sheet; uniform float fade; uniform vec2 box; uniform bool cut;
out vec4 result;
void main() { result = vec4(mix(texture(sheet, part).rgb, vec3(1.0), fade), 1.0); }`);
const sheetInstance = gl && instances(sheetProgram.program, ["origin"], [3]);
const sheetTexture = gl && gl.createTexture();

// The sheet lies a little behind its plane, so that cut spheres stand out.
function sheetOrigin(frame, away) {
  const origin = [0, 0, 0];
  const { axis, part } = state.clip;
  const cut = axis === axisNames[normal] && Math.abs(part - frame.flow.depth) < 0.02;
  if (dimension === 3) origin[normal] = (cut ? part : frame.flow.depth) * size[normal] - Math.sign(cameraAxes()[2][normal]) * away * size[normal];
  return origin;
}

function fillFlow(frame, quantity, range) {
  if (!frame.flow || quantity.kind === "none") return;
  const values = quantity.values(frame);
  const pixels = new Uint8Array(4 * values.length);
  values.forEach((value, k) => pixels.set([...colourOf(quantity, range, value).map(Math.round), 255], 4 * k));
  gl.bindTexture(gl.TEXTURE_2D, sheetTexture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, ...frame.flow.cells, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
}

function drawFlow(frame, quantity, matrices) {
  if (!frame.flow || quantity.kind === "none") return;
  const { uniforms } = sheetProgram;
  useProgram(sheetProgram, matrices);
  sheetInstance.fill(new Float32Array(sheetOrigin(frame, 6e-3)));
  gl.uniform3f(uniforms.right, ...unit(across).map((value) => value * size[across]));
  gl.uniform3f(uniforms.above, ...unit(up).map((value) => value * size[up]));
  gl.bindTexture(gl.TEXTURE_2D, sheetTexture);
  const shifts = state.images === "around" && dimension === 2 ? imageShifts(frame) : [];
  for (const shift of [...shifts, [0, 0, 0]]) {
    gl.uniform3f(uniforms.shift, ...shift);
    gl.uniform1f(uniforms.fade, shift.some((value) => value !== 0) ? 0.55 : 0);
    sheetInstance.draw();
  }
}

// The velocity at a place of the plane, linear between the middles of cells; nothing outside of the box.
function velocityAt(frame, x, y) {
  const [columns, rows] = frame.flow.cells;
  const place = [(x / size[across]) * columns - 0.5, (y / size[up]) * rows - 0.5];
  if (x < 0 || y < 0 || x > size[across] || y > size[up]) return null;
  const [i, j] = [Math.min(Math.max(Math.floor(place[0]), 0), columns - 2), Math.min(Math.max(Math.floor(place[1]), 0), rows - 2)];
  const [a, b] = [Math.min(Math.max(place[0] - i, 0), 1), Math.min(Math.max(place[1] - j, 0), 1)];
  const corner = j * columns + i;
  const value = (field) => (1 - b) * ((1 - a) * field[corner] + a * field[corner + 1]) + b * ((1 - a) * field[corner + columns] + a * field[corner + columns + 1]);
  return [value(frame.flow_across), value(frame.flow_up)];
}

const streamCounts = { longest: 34, steps: 14 };

// Short lines along the flow about evenly spread places, as long as the flow there is fast.
function fillStreams(frame, fastest) {
  const lines = [];
  if (frame.flow && state.streams && Math.min(...frame.flow.cells) > 1) {
    const spacing = Math.max(size[across], size[up]) / streamCounts.longest;
    const counts = [across, up].map((axis) => Math.max(1, Math.round(size[axis] / spacing)));
    const dt = (1.7 * spacing) / fastest / streamCounts.steps;
    const background = sheetOrigin(frame, 3e-3);
    const point = ([x, y]) => { const at = [...background]; at[across] += x; at[up] += y; return at; };
    const colour = state.flow === "none" ? [60, 84, 120] : [20, 24, 34];
    for (let j = 0; j < counts[1]; j++) {
      for (let i = 0; i < counts[0]; i++) {
        const seed = [((i + 0.5 + (j % 2 ? 0.25 : -0.25)) * size[across]) / counts[0], ((j + 0.5) * size[up]) / counts[1]];
        const track = streamline(frame, seed, dt);
        for (let k = 1; k < track.length; k++) {
          const widths = [k - 1, k].map((step) => 0.4 + (2.4 * step) / track.length);
          lines.push(...line(point(track[k - 1]), point(track[k]), [0, 0], widths, colour, 0.12 + (0.6 * k) / track.length));
        }
      }
    }
  }
  lineSets.streams.fill(new Float32Array(lines));
}

function streamline(frame, seed, dt) {
  const half = (sign) => {
    const track = [];
    let at = seed;
    for (let step = 0; step < streamCounts.steps / 2; step++) {
      const first = velocityAt(frame, ...at);
      const middle = first && velocityAt(frame, at[0] + 0.5 * sign * dt * first[0], at[1] + 0.5 * sign * dt * first[1]);
      if (!middle) break;
      at = [at[0] + sign * dt * middle[0], at[1] + sign * dt * middle[1]];
      track.push(at);
    }
    return track;
  };
  return [...half(-1).reverse(), seed, ...half(1)];
}
