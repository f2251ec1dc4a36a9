// The facts of the run and its frames, inflated when they are asked for.

const index = JSON.parse(document.getElementById("index").textContent);
const dimension = index.dimension;
const axisNames = ["x", "y", "z"].slice(0, dimension);
const size = [0, 1, 2].map((axis) => index.size[axis] ?? 0);
const periodic = axisNames.map((_, axis) => index.bounds[axis] === "periodic");
const [across, up] = index.plane;
const normal = dimension === 3 ? 3 - across - up : 2;
const frameCount = index.frames.times.length;
const duration = index.frames.times[frameCount - 1] - index.frames.times[0];

// Most bytes of frames that are kept inflated.
const mostKept = 4e8;

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

async function packedFrame(place) {
  if (index.frames.served) {
    const answer = await fetch(`frame/${index.frames.numbers[place]}`);
    if (!answer.ok) throw new Error(`frame ${index.frames.numbers[place]}: ${await answer.text()}`);
    return new Uint8Array(await answer.arrayBuffer());
  }
  const text = atob(document.getElementById(`frame-${place}`).textContent);
  return Uint8Array.from(text, (letter) => letter.charCodeAt(0));
}

const wholeNumbers = { 1: Uint8Array, 2: Uint16Array, 4: Uint32Array };

function column({ count, bytes, low, step }, buffer, start) {
  const values = new Float32Array(count).fill(low);
  if (bytes > 0) {
    const whole = new wholeNumbers[bytes](buffer.slice(start, start + count * bytes));
    for (let k = 0; k < count; k++) values[k] = low + step * whole[k];
  }
  return values;
}

async function inflatedFrame(place) {
  const first = place > 0 ? await frameAt(0) : null;
  const buffer = await inflate(await packedFrame(place));
  const length = new DataView(buffer).getUint32(0, true);
  const { columns, ...facts } = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const frame = { ...facts, place, bytes: buffer.byteLength };
  let start = 4 + length;
  for (const description of columns) {
    frame[description.name] = description.first ? first[description.name] : column(description, buffer, start);
    start += description.first ? 0 : description.count * description.bytes;
  }
  frame.count = frame.radius.length;
  return frame;
}

const kept = new Map();

// The frame at a place among those that are shown. The first one stays: others refer to it.
function frameAt(place) {
  const known = kept.get(place);
  if (known) {
    kept.delete(place);
    kept.set(place, known);
    return known.promise;
  }
  const entry = { bytes: 0, promise: inflatedFrame(place) };
  kept.set(place, entry);
  entry.promise.then((frame) => {
    entry.bytes = 2 * frame.bytes;
    let total = [...kept.values()].reduce((sum, one) => sum + one.bytes, 0);
    for (const [other, { bytes }] of kept) {
      if (total <= mostKept || kept.size < 4) break;
      if (other === 0 || other === place) continue;
      kept.delete(other);
      total -= bytes;
    }
  }, () => kept.delete(place));
  return entry.promise;
}

// Evenly spread frames, from which ranges of colours are found.
async function sampleFrames(most) {
  const places = new Set();
  const samples = Math.min(most, frameCount);
  for (let k = 0; k < samples; k++) places.add(Math.round((k * (frameCount - 1)) / Math.max(samples - 1, 1)));
  return Promise.all([...places].map(frameAt));
}

// The way from one point to another's nearest image; where images slide, the box above lies displaced by the frame's offset.
function nearestWay(frame, from, to) {
  const way = axisNames.map((_, axis) => to[axis] - from[axis]);
  if (frame.offset !== null && dimension > 1 && periodic[1]) {
    const boxes = Math.round(way[1] / size[1]);
    way[1] -= boxes * size[1];
    way[0] -= boxes * frame.offset;
  }
  return way.map((length, axis) => (periodic[axis] ? length - Math.round(length / size[axis]) * size[axis] : length));
}

const centre = (frame, body) => [frame.x[body], frame.y[body], frame.z ? frame.z[body] : 0];

// Displacements of the periodic images that are drawn besides the box itself; in 3D of those that do not hide it.
function imageShifts(frame) {
  const all = allImageShifts(frame);
  return dimension === 2 ? all : all.filter((shift) => dot(shift, cameraAxes()[2]) <= 0);
}

function allImageShifts(frame) {
  const counts = [0, 1, 2].map((axis) => (periodic[axis] ? [-1, 0, 1] : [0]));
  const shifts = [];
  for (const i of counts[0]) {
    for (const j of counts[1]) {
      for (const k of counts[2]) {
        if (i || j || k) shifts.push([i * size[0] + j * (frame.offset ?? 0), j * size[1], k * size[2]]);
      }
    }
  }
  // a box displaced to the right by most of its length leaves a corner bare
  if (frame.offset) for (const j of [-1, 1]) shifts.push([-j * 2 * size[0] + j * frame.offset, j * size[1], 0]);
  return shifts;
}
