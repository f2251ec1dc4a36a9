// The start, playing, drawing, and what the pointer does.

const message = document.getElementById("message");
const quantities = { bodies: [], flow: [] };
let samples = [];
let current = null;
let filled = null;
let drawing = false;
let again = false;
let stale = true;

function complain(error) {
  message.textContent = error.message ?? String(error);
  message.hidden = false;
  document.body.dataset.state = "failed";
  console.error(error);
}

const ranges = new Map();

// The range of colours of a quantity, in the run or in the frame that is shown.
function rangeNow(part, quantity, frame) {
  if (state.range === "frame") return rangeOf(quantity, [frame]);
  const key = `${part}:${quantity.key}`;
  if (!ranges.has(key)) ranges.set(key, rangeOf(quantity, samples));
  return ranges.get(key);
}

const chosen = (part, key) => quantities[part].find((quantity) => quantity.key === key) ?? quantities[part][0];

// Draws at the next chance: with new contents, or as seen from elsewhere only.
function requestDraw(contents = true) {
  stale ||= contents;
  if (drawing) return void (again = true);
  drawing = true;
  requestAnimationFrame(() => draw().catch(complain).finally(() => {
    drawing = false;
    if (again) requestDraw(false);
  }));
}

async function draw() {
  let place;
  again = false;
  do {
    place = state.place;
    current = await frameAt(place);
  } while (place !== state.place);
  if (stale || !current.shown || filled !== current) fill(current);
  show(current);
  document.body.dataset.state = "ready";
  Object.assign(document.body.dataset, { frame: index.frames.numbers[place], time: current.time, bodies: current.count });
  if (state.playing && place + 1 < frameCount) frameAt(place + 1);
}

function fill(frame) {
  [stale, filled] = [false, frame];
  const [body, flow] = [chosen("bodies", state.colour), chosen("flow", state.flow)];
  frame.shown = [
    { title: "bodies", quantity: body, range: rangeNow("bodies", body, frame) },
    { title: "flow", quantity: flow, range: flow ? rangeNow("flow", flow, frame) : null },
  ].filter(({ quantity }) => quantity);
  fillBodies(frame, body, frame.shown[0].range);
  fillBonds(frame);
  learnForces(state.range === "frame" ? [frame] : samples);
  fillContacts(frame);
  fillPath();
  if (frame.flow) {
    fillFlow(frame, flow, frame.shown[1].range);
    if (state.streams) fillStreams(frame, rangeNow("flow", chosen("flow", "speed"), frame).high);
  }
}

function show(frame, saving = false) {
  fitWindow() && !camera.moved && fitCamera(state.images === "around" ? 1.8 : 1);
  const matrices = beginDrawing(cameraMatrices());
  const flow = chosen("flow", state.flow);
  const images = state.images === "none" || (dimension === 3 && state.images === "seams") ? [] : imageShifts(frame);
  const shifts = [...images, [0, 0, 0]];
  const [cut, fade] = [dimension === 2 && state.images === "seams", state.images === "around" ? 0.55 : 0];
  if (flow) drawFlow(frame, flow, matrices);
  const streams = () => state.streams && frame.flow && drawLines("streams", matrices, [[0, 0, 0]], { clipped: false });
  // what is partly seen through comes after what lies behind it
  if (dimension === 2) streams();
  drawBodies(frame, matrices);
  if (dimension === 3) streams();
  drawLines("bonds", matrices, shifts, { cut, fade });
  drawLines("contacts", matrices, shifts, { cut, fade });
  drawLines("box", matrices, [[0, 0, 0]], { clipped: false });
  drawLines("path", matrices, [[0, 0, 0]]);
  drawLabels(frame, frame.shown, saving);
  showWords(frame);
  // for programs that look at the page: how far the scene is from its left, upper, right and lower edge
  const { left, top, right, bottom } = overlay.getBoundingClientRect();
  document.body.dataset.insets = [left, top, window.innerWidth - right, window.innerHeight - bottom].join(",");
}

function showWords(frame) {
  const words = document.getElementById("clock");
  words.replaceChildren("t = ", element("b", { textContent: number(frame.time) }));
  if (shear) words.append("   strain γ = ", element("b", { textContent: number(rate * frame.time) }));
  document.getElementById("counter").textContent = `${index.frames.numbers[state.place]} / ${index.frames.total - 1}`;
  document.getElementById("scrub").value = state.place;
  document.getElementById("play").classList.toggle("playing", state.playing);
  document.getElementById("speed").value = state.speed;
  showBody(frame);
  drawSeries(frame);
}

function goTo(place) {
  state.place = Math.min(Math.max(place, 0), frameCount - 1);
  requestDraw();
  rememberAddress();
}

const step = (by) => { play(false); goTo(state.place + by); };
const goToTime = (time) => goTo(nearestPlace(index.frames.times, time));

let last = 0;
function play(playing) {
  if (playing && state.place === frameCount - 1) state.place = 0;
  state.playing = playing && frameCount > 1;
  last = performance.now();
  if (state.playing) requestAnimationFrame(tick);
  requestDraw();
  rememberAddress();
}

// Moves on when a frame's time is over and the one before has been drawn.
function tick(now) {
  if (!state.playing) return;
  const steps = Math.floor(((now - last) * state.speed) / 1000);
  if (steps > 0 && !drawing) {
    last = now;
    state.place = state.place === frameCount - 1 ? 0 : Math.min(state.place + Math.min(steps, 5), frameCount - 1);
    requestDraw();
  }
  requestAnimationFrame(tick);
}

function savePicture() {
  show(current, true);
  const picture = element("canvas", { width: canvas.width, height: canvas.height });
  const ink = picture.getContext("2d");
  ink.drawImage(canvas, 0, 0);
  ink.drawImage(overlay, 0, 0);
  const name = `${index.title.replace(/[^\p{L}\p{N}]+/gu, "-").slice(0, 60)}-${index.frames.numbers[state.place]}.png`;
  picture.toBlob((blob) => {
    const link = element("a", { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  });
  show(current);
}

function listen() {
  let held = null;
  overlay.addEventListener("pointerdown", (event) => {
    held = { x: event.offsetX, y: event.offsetY, far: 0, moves: event.shiftKey || event.button !== 0 };
    overlay.setPointerCapture(event.pointerId);
  });
  overlay.addEventListener("pointermove", (event) => {
    if (!current) return;
    if (!held) {
      pointAt(current, event.offsetX, event.offsetY);
      return drawLabels(current, current.shown, false);
    }
    const [dx, dy] = [event.offsetX - held.x, event.offsetY - held.y];
    held = { ...held, x: event.offsetX, y: event.offsetY, far: held.far + Math.abs(dx) + Math.abs(dy) };
    if (held.far < 4) return;
    overlay.classList.add("held");
    tooltip.hidden = true;
    if (dimension === 2 || held.moves) moveCamera(dx, dy);
    else turnCamera(dx, dy);
    requestDraw(false);
  });
  overlay.addEventListener("pointerup", (event) => {
    overlay.classList.remove("held");
    if (held && held.far < 4 && current) change({ body: bodyAt(current, event.offsetX, event.offsetY) });
    held = null;
    rememberAddress();
  });
  overlay.addEventListener("pointercancel", () => (held = null));
  overlay.addEventListener("pointerleave", () => { pointed.body = null; tooltip.hidden = true; requestDraw(false); });
  overlay.addEventListener("contextmenu", (event) => event.preventDefault());
  overlay.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoomCamera(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0016)), event.offsetX, event.offsetY);
    requestDraw(false);
    rememberAddress();
  }, { passive: false });
  new ResizeObserver(() => filled && show(filled)).observe(document.getElementById("stage"));
  const scrub = document.getElementById("scrub");
  scrub.max = frameCount - 1;
  scrub.oninput = () => { play(false); goTo(Number(scrub.value)); };
  const speed = document.getElementById("speed");
  speed.append(...speeds.map((value) => new Option(`${value} frames/s`, value)));
  speed.onchange = () => change({ speed: Number(speed.value) });
  const buttons = { first: () => goTo(0), back: () => step(-1), play: () => play(!state.playing), forth: () => step(1), last: () => goTo(frameCount - 1), save: savePicture, toggle: togglePanel };
  for (const [name, act] of Object.entries(buttons)) document.getElementById(name).onclick = act;
}

// What the scene says is coloured, and what its frames have.
function chooseStart() {
  const has = (part, key) => quantities[part].some((quantity) => quantity.key === key);
  if (index.coloured === "vorticity" && has("flow", "vorticity")) Object.assign(state, { colour: "plain", flow: "vorticity" });
  else if (index.coloured === "species" && has("bodies", "species")) state.colour = "species";
  else if (has("bodies", "chain")) state.colour = "chain";
  else if (index.coloured === "nonaffine" && has("bodies", "nonaffine")) state.colour = "nonaffine";
  if (dimension === 3) state.images = "none";
  state.speed = speeds.find((speed) => speed >= frameCount / 7) ?? 50;
}

async function start() {
  document.getElementById("title").textContent = index.title;
  if (!gl) throw new Error("This browser shows no WebGL 2, which draws the bodies; switch it on, or take another browser.");
  if (!window.DecompressionStream) throw new Error("This browser cannot inflate the frames (DecompressionStream); take a newer one.");
  samples = await sampleFrames(dimension === 2 ? 16 : 8);
  learnRadii(samples[0]);
  learnSpeeds(samples);
  quantities.bodies = bodyQuantities.filter(({ where }) => !where || where(samples));
  quantities.flow = samples.some((frame) => frame.flow) ? flowQuantities.filter(({ where }) => !where || where(samples)) : [];
  samples = samples.filter((frame) => frame.flow || quantities.flow.length === 0);
  chooseStart();
  beginSeries();
  Object.assign(initial, state);
  buildPanel(samples);
  fitWindow();
  fitCamera();
  fillBox();
  listen();
  applyAddress();
}

start().catch(complain);
