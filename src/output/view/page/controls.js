// The panel, the keys, and the part of the address that names what is shown.

const state = {
  place: 0, playing: false, speed: 10, colour: "speed", range: "run", flow: "none", streams: false, contacts: false, bonds: true, membranes: true,
  marks: true, images: "seams", size: 1, clip: { axis: "none", part: 0.5 }, body: null, series: null,
};

// Called with what changes of the state.
function change(changes) {
  Object.assign(state, changes);
  if ("body" in changes) follow(state.body).catch(complain);
  // the sheet of the flow is seen where spheres are cut
  const hidden = dimension === 3 && state.clip.axis === "none" && !("clip" in changes);
  if (hidden && (changes.streams || (changes.flow ?? "none") !== "none")) state.clip = { axis: axisNames[normal], part: samples[0].flow?.depth ?? 0.5 };
  if ("images" in changes && !camera.moved) fitCamera(state.images === "around" ? 1.8 : 1);
  showControls();
  requestDraw();
  rememberAddress();
}

const controls = [];

function control(key, element, read, write) {
  controls.push(() => write(element, state[key]));
  element.id = `choice-${key}`;
  element.oninput = () => change({ [key]: read(element), ...element.also?.(read(element)) });
  return element;
}

const element = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};
const row = (name, ...children) => element("label", { className: "row" }, element("span", { textContent: name }), ...children);
const choice = (key, options) => control(key, element("select", {}, ...options.map(([value, text]) => new Option(text, value))), (one) => one.value, (one, value) => (one.value = value));
const check = (key, text) => element("label", {}, control(key, element("input", { type: "checkbox" }), (one) => one.checked, (one, value) => (one.checked = value)), text);

function buildPanel(frames) {
  const panel = document.getElementById("choices");
  const heading = (text) => element("h2", { textContent: text });
  const checks = [check("marks", "marks of rotation")];
  if (frames.some((frame) => frame.contact_body)) checks.unshift(check("contacts", "contacts"));
  if (frames[0].bond_chain.length) checks.unshift(check("bonds", "bonds"));
  if (frames[0].face_size.length) checks.unshift(check("membranes", "membranes"));
  panel.append(heading("Bodies"), row("colour by", choice("colour", quantities.bodies.map(({ key, label }) => [key, label]))));
  panel.append(row("range", choice("range", [["run", "of the run"], ["frame", "of this frame"]])), row("size", slider("size", 0.15, 1)));
  panel.append(element("div", { className: "checks" }, ...checks));
  if (quantities.flow.length > 1) {
    panel.append(heading(dimension === 2 ? "Flow" : "Flow in a plane"), row("colour by", choice("flow", quantities.flow.map(({ key, label }) => [key, label]))));
    panel.append(element("div", { className: "checks" }, check("streams", "short streamlines")));
  }
  if (periodic.some(Boolean)) {
    const options = [["none", "none"], ["seams", "at the sides"], ["around", "all around"]].filter(([key]) => dimension === 2 || key !== "seams");
    panel.append(heading("Periodic box"), row("images", choice("images", options)));
  }
  if (dimension === 3) {
    const axis = element("select", {}, ...["none", ...axisNames].map((name) => new Option(name === "none" ? "whole" : `cut across ${name}`, name)));
    const part = element("input", { type: "range", min: 0, max: 1, step: 0.005 });
    axis.oninput = part.oninput = () => change({ clip: { axis: axis.value, part: Number(part.value) } });
    controls.push(() => { [axis.value, part.value, part.disabled] = [state.clip.axis, state.clip.part, state.clip.axis === "none"]; });
    panel.append(heading("View"), row("cut", axis), row("at", part));
  }
  panel.append(element("div", { className: "checks" }, element("button", { textContent: "Reset the view (R)", onclick: resetView })));
  writeAbout();
}

function slider(key, min, max) {
  return control(key, element("input", { type: "range", min, max, step: 0.01 }), (one) => Number(one.value), (one, value) => (one.value = value));
}

const showControls = () => controls.forEach((show) => show());

function writeAbout() {
  const { numbers, total, served } = index.frames;
  const paragraphs = [];
  if (numbers.length < total) paragraphs.push(`This page holds ${numbers.length} of the ${total} frames, evenly spread. For all: turbid view --frames ${total}, or --serve.`);
  if (!index.finished) paragraphs.push(`The run had not finished when this page was ${served ? "loaded" : "written"}.`);
  if (series?.stride > 1) paragraphs.push(`The series shows every ${series.stride}th step.`);
  if (shear) paragraphs.push("γ̇ is the shear rate, a the mean radius, η the viscosity of the fluid.");
  const keys = [["space", "play"], ["← →", "step"], ["[ ]", "speed"], ["C", "colour"], ["F", "flow"], ["T", "streamlines"], ["N", "contacts"], ["I", "images"], ["S", "save"], ["P", "panel"], ["R", "view"]];
  const about = document.getElementById("about");
  about.replaceChildren(...paragraphs.map((text) => element("p", { textContent: text })));
  about.append(element("p", {}, ...keys.flatMap(([key, word]) => [element("kbd", { textContent: key }), ` ${word}  `])));
  const hands = dimension === 2 ? "Drag to move, turn the wheel to zoom, click a body for its history." : "Drag to turn, with Shift to move, turn the wheel to zoom, click a body for its history.";
  about.append(element("p", { textContent: `${hands} The address of the page names what is shown: copy it to share a moment.` }));
}

function resetView() {
  Object.assign(camera, { azimuth: 0.45, elevation: 0.32 });
  fitCamera(state.images === "around" ? 1.8 : 1);
  requestDraw();
  rememberAddress();
}

// The next of the choices of a menu.
function cycle(key) {
  const menu = document.getElementById(`choice-${key}`);
  if (!menu) return;
  const values = [...menu.options].map((option) => option.value);
  change({ [key]: values[(values.indexOf(state[key]) + 1) % values.length] });
}

// What a run does not have has no box to tick.
const flip = (key) => document.getElementById(`choice-${key}`) && change({ [key]: !state[key] });

const speeds = [1, 2, 5, 10, 15, 25, 50];
const keys = {
  " ": () => play(!state.playing), ArrowRight: (event) => step(event.shiftKey ? 10 : 1), ArrowLeft: (event) => step(event.shiftKey ? -10 : -1),
  Home: () => goTo(0), End: () => goTo(frameCount - 1), c: () => cycle("colour"), f: () => cycle("flow"), i: () => cycle("images"), r: resetView, s: savePicture,
  t: () => flip("streams"), n: () => flip("contacts"), p: togglePanel, Escape: () => change({ body: null }),
  "[": () => changeSpeed(-1), "]": () => changeSpeed(1),
};

function changeSpeed(by) {
  const place = speeds.findIndex((speed) => speed >= state.speed) + by;
  change({ speed: speeds[Math.min(Math.max(place, 0), speeds.length - 1)] });
}

function togglePanel() {
  document.body.classList.toggle("bare");
  requestDraw();
}

window.addEventListener("keydown", (event) => {
  const menus = ["SELECT", "INPUT", "BUTTON"].includes(event.target.tagName);
  const typed = event.target.tagName === "SELECT" || (event.target.type === "range" && event.key.startsWith("Arrow")) || (menus && event.key === " ");
  const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!act || typed || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  act(event);
});

// What the address may name, as text and back; what is as at the start is left out.
const flags = ["streams", "contacts", "bonds", "membranes", "marks"];
const initial = {};

function addressWords() {
  const words = { frame: index.frames.numbers[state.place] };
  for (const key of ["colour", "range", "flow", "images", "speed", "series", "size", "body"]) if (state[key] !== initial[key] && state[key] !== null) words[key] = state[key];
  for (const key of flags) if (state[key] !== initial[key]) words[key] = state[key] ? 1 : 0;
  if (state.clip.axis !== "none") words.clip = `${state.clip.axis}:${state.clip.part}`;
  if (camera.moved) words.view = (dimension === 2 ? [...camera.target.slice(0, 2), camera.pixels / camera.window[1]] : [...camera.target, camera.azimuth, camera.elevation, camera.distance]).map((value) => Number(value.toPrecision(5))).join(",");
  return words;
}

let remembered = "";
let remembering = null;

function rememberAddress() {
  clearTimeout(remembering);
  remembering = setTimeout(() => {
    remembered = `#${new URLSearchParams(addressWords()).toString().replaceAll("%2C", ",").replaceAll("%3A", ":")}`;
    if (!state.playing && location.hash !== remembered) history.replaceState(null, "", remembered);
  }, 300);
}

// The state that an address asks for; words that mean nothing are passed over.
function readAddress() {
  const words = new URLSearchParams(location.hash.slice(1));
  const changes = {};
  const among = { colour: quantities.bodies.map(({ key }) => key), flow: quantities.flow.map(({ key }) => key), images: ["none", "seams", "around"], range: ["run", "frame"], series: series?.names ?? [] };
  for (const [key, known] of Object.entries(among)) if (known.includes(words.get(key))) changes[key] = words.get(key);
  for (const key of flags) if (words.has(key)) changes[key] = words.get(key) === "1";
  const value = (key) => (words.has(key) && words.get(key) !== "" ? Number(words.get(key)) : NaN);
  if (value("frame") >= 0) changes.place = nearestPlace(index.frames.numbers, value("frame"));
  if (value("size") > 0 && value("size") <= 1) changes.size = value("size");
  if (value("speed") > 0) changes.speed = speeds.find((speed) => speed >= value("speed")) ?? 50;
  if (Number.isInteger(value("body")) && value("body") >= 0) changes.body = value("body");
  const [axis, part] = (words.get("clip") ?? "").split(":");
  if (axisNames.includes(axis) && Number(part) >= 0 && Number(part) <= 1) changes.clip = { axis, part: Number(part) };
  const view = (words.get("view") ?? "").split(",").map(Number);
  if (view.length === (dimension === 2 ? 3 : 6) && view.every(Number.isFinite) && view.at(-1) > 0) changes.view = view;
  if (words.get("play") === "1") changes.playing = true;
  if (words.get("panel") === "0") changes.bare = true;
  return changes;
}

function nearestPlace(values, wanted) {
  return values.reduce((best, value, place) => (Math.abs(value - wanted) < Math.abs(values[best] - wanted) ? place : best), 0);
}

function applyAddress() {
  const { view, playing, bare, ...changes } = readAddress();
  document.body.classList.toggle("bare", bare ?? document.body.classList.contains("bare"));
  fitWindow();
  change(changes);
  if (view && dimension === 2) Object.assign(camera, { target: [view[0], view[1], 0], pixels: view[2] * camera.window[1], moved: true });
  if (view && dimension === 3) Object.assign(camera, { target: view.slice(0, 3), azimuth: view[3], elevation: view[4], distance: view[5], moved: true });
  if (playing) play(true);
}

window.addEventListener("hashchange", () => location.hash !== remembered && applyAddress());
