// What is written and drawn over the scene: axes, the scale bar, colour bars, time, membranes and marks.

const labelInk = "#3b4252";
const faint = "#8a93a3";

function label(text, x, y, { align = "left", base = "alphabetic", font = "12px", colour = labelInk, weight = "" } = {}) {
  pen.font = `${weight} ${font} system-ui, sans-serif`;
  [pen.textAlign, pen.textBaseline, pen.fillStyle] = [align, base, colour];
  pen.lineJoin = "round";
  pen.strokeStyle = "rgba(255,255,255,0.85)";
  pen.lineWidth = 3;
  pen.strokeText(text, x, y);
  pen.fillText(text, x, y);
}

function stroke(points, colour, width = 1, dash = []) {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  [pen.strokeStyle, pen.lineWidth] = [colour, width];
  pen.setLineDash(dash);
  pen.stroke();
  pen.setLineDash([]);
}

function drawLabels(frame, shown, saving) {
  pen.setTransform(camera.dense, 0, 0, camera.dense, 0, 0);
  pen.clearRect(0, 0, ...camera.window);
  const matrices = cameraMatrices();
  if (state.membranes) drawMembranes(frame, matrices);
  drawOffset(frame, matrices);
  drawMarks(frame, matrices);
  if (dimension === 2) drawAxes(matrices);
  else drawTriad(matrices);
  drawBars(frame, shown);
  if (saving) {
    label(index.title, 14, 20, { font: "15px", weight: "600" });
    label(clock(frame), camera.window[0] - 14, 20, { font: "13px", align: "right" });
  }
}

const clock = (frame) => `t = ${number(frame.time)}${shear ? `   γ = ${number(rate * frame.time)}` : ""}`;

// Ticks along the lower and the left side of the box, where they can be seen.
function drawAxes(matrices) {
  const [width, height] = camera.window;
  const [from, to] = [project([0, 0, 0], matrices), project(size, matrices)];
  const foot = Math.min(from.y, height - margins.bottom + 8);
  const side = Math.max(from.x, margins.left - 8);
  const range = (low, high, axis) => [Math.max(0, low), Math.min(size[axis], high)];
  const [left, bottom] = planePoint(margins.left - 8, height - margins.bottom + 8);
  const [right, top] = planePoint(width - margins.right + 20, margins.top - 12);
  for (const x of ticks(...range(left, right, 0), Math.max(2, Math.min(to.x - from.x, width) / 110))) {
    const at = project([x, 0, 0], matrices).x;
    stroke([[at, foot + 3], [at, foot + 8]], faint);
    label(number(x), at, foot + 11, { align: "center", base: "top" });
  }
  for (const y of ticks(...range(bottom, top, 1), Math.max(2, Math.min(from.y - to.y, height) / 80))) {
    const at = project([0, y, 0], matrices).y;
    stroke([[side - 3, at], [side - 8, at]], faint);
    label(number(y), side - 11, at, { align: "right", base: "middle" });
  }
  label("x", (Math.max(from.x, 0) + Math.min(to.x, width - margins.right + 20)) / 2, foot + 26, { align: "center", base: "top", colour: faint });
  label("y", side - 46, (Math.max(to.y, 0) + foot) / 2, { base: "middle", colour: faint });
}

// Directions of the axes and a length, at the middle of the scene.
function drawTriad(matrices) {
  const height = camera.window[1];
  const origin = [46, height - 46];
  const colours = ["#b2452f", "#2f7d4f", "#2b5f9e"];
  const far = [0, 1, 2].sort((one, other) => matrices.axes[2][one] - matrices.axes[2][other]);
  for (const axis of far) {
    const end = [origin[0] + 30 * matrices.axes[0][axis], origin[1] - 30 * matrices.axes[1][axis]];
    stroke([origin, end], colours[axis], 2.5);
    label(axisNames[axis], end[0] + 8 * matrices.axes[0][axis], end[1] - 8 * matrices.axes[1][axis], { align: "center", base: "middle", colour: colours[axis], weight: "600" });
  }
  const { pixels } = project(camera.target, matrices);
  const length = roundBelow(130 / pixels);
  const [left, foot] = [106, height - 30];
  stroke([[left, foot - 4], [left, foot], [left + length * pixels, foot], [left + length * pixels, foot - 4]], labelInk, 1.5);
  label(`${number(length)} (at mid depth)`, left, foot - 9);
}

// Filled outlines of membranes in two dimensions, and shaded triangles in three from the far ones to the near.
function drawMembranes(frame, matrices) {
  let start = 0;
  const faces = [];
  const inside = camera.window;
  for (const count of frame.face_size) {
    const corners = [];
    let at = centre(frame, frame.face_body[start]);
    for (let k = 0; k < count; k++) {
      at = along3(at, nearestWay(frame, at, centre(frame, frame.face_body[start + k])));
      corners.push(at);
    }
    start += count;
    faces.push(corners);
  }
  const shifts = state.images === "none" || dimension === 3 ? [[0, 0, 0]] : [[0, 0, 0], ...imageShifts(frame)];
  pen.save();
  if (dimension === 2 && state.images === "seams") clipToBox(matrices);
  const seen = faces.flatMap((corners) => shifts.map((shift) => corners.map((corner) => project(along3(corner, shift), matrices))));
  const depth = (corners) => corners.reduce((sum, corner) => sum + corner.depth, 0);
  if (dimension === 3) seen.sort((one, other) => depth(other) - depth(one));
  for (const corners of seen) {
    if (corners.every(({ x, y }) => x < 0 || y < 0 || x > inside[0] || y > inside[1])) continue;
    pen.beginPath();
    corners.forEach(({ x, y }) => pen.lineTo(x, y));
    pen.closePath();
    pen.fillStyle = dimension === 2 ? "rgba(196,60,60,0.16)" : "rgba(196,60,60,0.10)";
    pen.fill();
  }
  pen.restore();
}

function clipToBox(matrices) {
  const [from, to] = [project([0, 0, 0], matrices), project(size, matrices)];
  pen.beginPath();
  pen.rect(from.x, to.y, to.x - from.x, from.y - to.y);
  pen.clip();
}

// Where images slide: how far the box above lies to the right, and its outline where images are shown around.
function drawOffset(frame, matrices) {
  if (frame.offset === null) return;
  const front = dimension === 3 ? size[2] : 0;
  const corner = (x, y) => { const at = project([x, y, front], matrices); return [at.x, at.y]; };
  const colour = "#0072b2";
  const lift = (0.024 * size[1] * (dimension === 3 ? 1.3 : 1));
  const [from, to] = [corner(0, size[1] + lift), corner(frame.offset, size[1] + lift)];
  stroke([from, to], colour, 2);
  for (const [at, x] of [[from, 0], [to, frame.offset]]) stroke([corner(x, size[1]), [at[0], at[1] - 4]], colour, 1.5);
  const text = `box above displaced by ${number(frame.offset, 3)}`;
  const roomy = Math.hypot(to[0] - from[0], to[1] - from[1]) > 180;
  label(text, roomy ? (from[0] + to[0]) / 2 : to[0] + 8, roomy ? (from[1] + to[1]) / 2 - 5 : to[1] + 3, { colour, align: roomy ? "center" : "left" });
  if (state.images !== "around") return;
  for (const row of [-1, 1]) {
    for (const boxes of [-1, 0]) {
      const [x, y] = [boxes * size[0] + row * frame.offset + (row < 0 ? size[0] : 0), row * size[1]];
      stroke([corner(x, y), corner(x + size[0], y), corner(x + size[0], y + size[1]), corner(x, y + size[1]), corner(x, y)], faint, 1, [4, 4]);
    }
  }
}

// Rings around the body that is selected and the one under the pointer.
function drawMarks(frame, matrices) {
  for (const [body, colour, width] of [[pointed.body, "#1f2530", 1.5], [state.body, "#d55e00", 3]]) {
    if (body === null || body >= frame.count) continue;
    const at = project(centre(frame, body), matrices);
    pen.beginPath();
    pen.arc(at.x, at.y, Math.max(state.size * frame.radius[body] * at.pixels, 3) + 2, 0, 2 * Math.PI);
    [pen.strokeStyle, pen.lineWidth] = [colour, width];
    pen.stroke();
  }
}

function drawBars(frame, shown) {
  const height = camera.window[1];
  const bars = shown.filter(({ quantity }) => quantity.kind !== "none");
  if (state.contacts && contactScale.known) bars.push({ contacts: true });
  const room = Math.min((height - 40) / Math.max(bars.length, 1), 310);
  if (bars.length === 0) return;
  pen.fillStyle = "rgba(255,255,255,0.82)";
  pen.fillRect(camera.window[0] - 106, 6, 106, 18 + bars.length * room);
  bars.forEach((bar, k) => {
    const top = 24 + k * room;
    if (bar.contacts) drawForceKey(frame, top);
    else if (bar.quantity.kind === "category") drawLegend(bar, top);
    else drawBar(bar, top, Math.min(220, room - 74));
  });
}

function drawBar({ quantity, range, title }, top, height) {
  const left = camera.window[0] - 92;
  const { unit, name } = scales[quantity.scale]();
  const map = mapOf(range);
  label(title, left - 8, top, { colour: faint, font: "11px" });
  label(quantity.symbol, left - 8, top + 17, { font: "14px", weight: "600" });
  const foot = top + 32 + height;
  if (height < 30) return;
  const rows = Math.round(height);
  // counts have a block each, which stands about its number
  const blocks = quantity.kind === "count" ? Math.round(range.high) + 1 : 0;
  for (let row = 0; row < rows; row++) {
    const part = (row + 0.5) / rows;
    pen.fillStyle = written(shade(map, blocks > 1 ? Math.floor(part * blocks) / (blocks - 1) : part));
    pen.fillRect(left, foot - row - 1, 15, 1.3);
  }
  pen.strokeStyle = faint;
  pen.lineWidth = 0.75;
  pen.strokeRect(left, foot - height, 15, height);
  const wanted = Math.max(2, height / 45);
  const marks = blocks > 1 ? ticks(0, blocks - 1, Math.max(wanted, Math.min(blocks - 1, height / 18))).filter(Number.isInteger) : ticks(range.low / unit, range.high / unit, wanted);
  for (const tick of marks) {
    const part = blocks > 1 ? (tick + 0.5) / blocks : (tick * unit - range.low) / (range.high - range.low);
    const y = foot - part * height;
    stroke([[left + 15, y], [left + 19, y]], faint);
    label(number(tick, 3), left + 23, y, { base: "middle" });
  }
  label(range.atRest ? "at rest" : name, camera.window[0] - 8, foot + 15, { font: "11px", colour: faint, align: "right" });
}

function drawLegend({ quantity }, top) {
  const left = camera.window[0] - 100;
  label("bodies", left, top, { colour: faint, font: "11px" });
  label(quantity.symbol, left, top + 17, { font: "13px", weight: "600" });
  if (quantity.key !== "species") return label("by number", left, top + 33, { font: "11px", colour: faint });
  radiusScale.classes.forEach((radius, k) => {
    pen.fillStyle = written(distinct(k));
    pen.beginPath();
    pen.arc(left + 7, top + 36 + 19 * k, 6, 0, 2 * Math.PI);
    pen.fill();
    label(`${number(radius)} (${radiusScale.counts[k]})`, left + 19, top + 36 + 19 * k, { base: "middle" });
  });
}

function drawForceKey(frame, top) {
  const left = camera.window[0] - 100;
  label("contacts", left, top, { colour: faint, font: "11px" });
  label("force", left, top + 17, { font: "14px", weight: "600" });
  const pixels = project(camera.target).pixels;
  [0.25, 0.5, 1].forEach((part, k) => {
    const y = top + 36 + 20 * k;
    stroke([[left, y], [left + 24, y]], written([140, 30, 24], 0.5 + 0.45 * part), Math.min(Math.max(0.75 * radiusScale.mean * part * pixels, 0.8), 16));
    label(number(part * contactScale.force, 3), left + 31, y, { base: "middle" });
  });
  label(ofScene, camera.window[0] - 8, top + 98, { font: "11px", colour: faint, align: "right" });
}
