// The body under the pointer, and the one that was clicked with its history.

const pointed = { body: null };
const tooltip = document.getElementById("tooltip");

// The body seen at a place in the window, the nearest one in 3D; its images in the box and around it count as itself.
function bodyAt(frame, x, y) {
  const matrices = cameraMatrices();
  const shifts = state.images === "none" || dimension === 3 ? [[0, 0, 0]] : [[0, 0, 0], ...imageShifts(frame)];
  let [found, nearest] = [null, Infinity];
  const { axis, part } = state.clip;
  const clipped = dimension === 3 && axis !== "none" ? axisNames.indexOf(axis) : -1;
  for (const shift of shifts) {
    for (let body = 0; body < frame.count; body++) {
      const point = along3(centre(frame, body), shift);
      if (clipped >= 0 && beyondClip(point[clipped], part * size[clipped], matrices.axes[2][clipped], frame.radius[body])) continue;
      const at = project(point, matrices);
      const reach = Math.max(frame.radius[body] * state.size * at.pixels, 3);
      if (at.depth < nearest && Math.abs(at.x - x) < reach && Math.hypot(at.x - x, at.y - y) < reach) [found, nearest] = [body, at.depth];
      if (dimension === 2 && found !== null) return found;
    }
  }
  return found;
}

const beyondClip = (place, plane, facing, radius) => (facing < 0 ? plane - place : place - plane) > radius;

function pointAt(frame, x, y) {
  pointed.body = bodyAt(frame, x, y);
  overlay.classList.toggle("over", pointed.body !== null);
  if (pointed.body === null) {
    tooltip.hidden = true;
    return;
  }
  const [name, ...facts] = bodyFacts(frame, pointed.body);
  tooltip.textContent = [name[1], ...facts.slice(0, 6).map(([key, value]) => `${key}  ${value}`)].join("\n");
  tooltip.hidden = false;
  const [width, height] = [tooltip.offsetWidth, tooltip.offsetHeight];
  tooltip.style.left = `${x + 16 + width > camera.window[0] ? x - width - 12 : x + 16}px`;
  tooltip.style.top = `${Math.max(4, Math.min(y + 14, camera.window[1] - height - 4))}px`;
}

const vector = (frame, name, body) => `(${axisNames.map((axis) => number(frame[name ? `${name}_${axis}` : axis][body], dimension === 2 ? 4 : 3)).join(", ")})`;

function bodyFacts(frame, body) {
  const facts = [["", `body ${body}`], ["radius", number(frame.radius[body])], ["position", vector(frame, "", body)], ["velocity", vector(frame, "velocity", body)], ["speed", number(length(frame, "velocity", body))]];
  if (shear) facts.push(["non-affine speed", number(nonAffine(frame)[body])]);
  facts.push(["spin", dimension === 2 ? number(frame.spin_z[body]) : vector(frame, "spin", body)]);
  if (frame.contact_body) facts.push(["contacts", `${frame.touches[body]}`]);
  const tied = chains(frame)[body];
  if (tied >= 0) facts.push([tiedName, `${tied}`]);
  if (length(frame, "force", body) > forceFloor.value) facts.push(["fluid force", vector(frame, "force", body)]);
  return facts;
}

const history_ = { body: null, rows: [] };

// Follows the body that is selected through all frames.
async function follow(body) {
  if (history_.body === body) return;
  Object.assign(history_, { body, rows: [] });
  if (body === null) return;
  const note = document.getElementById("body-note");
  const rows = [];
  for (let place = 0; place < frameCount; place++) {
    const frame = await frameAt(place);
    if (history_.body !== body) return;
    if (body < frame.count) rows.push({ time: frame.time, at: centre(frame, body), speed: length(frame, "velocity", body) });
    note.textContent = `Reading its path: frame ${place + 1} of ${frameCount}`;
  }
  history_.rows = rows;
  note.textContent = `speed (${ofScene}) over time; the path is drawn in the scene`;
  requestDraw();
}

// The path as lines; it breaks where the body enters the box on the other side.
function fillPath() {
  const lines = [];
  const rows = state.body === history_.body ? history_.rows : [];
  for (let k = 1; k < rows.length; k++) {
    const [from, to] = [rows[k - 1].at, rows[k].at];
    if (axisNames.some((_, axis) => periodic[axis] && Math.abs(to[axis] - from[axis]) > size[axis] / 2)) continue;
    lines.push(...line(from, to, [0, 0], [2.2, 2.2], [213, 94, 0], 0.9));
  }
  lineSets.path.fill(new Float32Array(lines));
}

const bodyChart = document.getElementById("body-chart");
let bodyTime = null;

function showBody(frame) {
  const card = document.getElementById("body");
  card.hidden = state.body === null || state.body >= frame.count;
  if (card.hidden) return;
  const [name, ...facts] = bodyFacts(frame, state.body);
  document.getElementById("body-name").textContent = name[1][0].toUpperCase() + name[1].slice(1);
  const entry = (tag, text) => Object.assign(document.createElement(tag), { textContent: text });
  document.getElementById("body-facts").replaceChildren(...facts.flatMap(([key, value]) => [entry("dt", key), entry("dd", value)]));
  const { rows } = history_;
  if (rows.length) bodyTime = drawChart(bodyChart, { xs: rows.map((row) => row.time), ys: rows.map((row) => row.speed), xName: "time", now: frame.time });
}

bodyChart.onclick = (event) => bodyTime && goToTime(bodyTime(event.offsetX));
document.getElementById("body-close").onclick = () => change({ body: null });
