// What bodies and flow are coloured by: values, symbols, units and ranges.

const radiusScale = { mean: 1, classes: [] };

// Sizes of the bodies, which give the scales.
function learnRadii(frame) {
  const counts = new Map();
  for (const radius of frame.radius) {
    const class_ = Number(radius.toPrecision(4));
    counts.set(class_, (counts.get(class_) ?? 0) + 1);
  }
  if (frame.count > 0) radiusScale.mean = frame.radius.reduce((sum, radius) => sum + radius, 0) / frame.count;
  radiusScale.classes = [...counts.keys()].sort((one, other) => one - other);
  radiusScale.counts = radiusScale.classes.map((class_) => counts.get(class_));
}

const shear = index.shear;
const rate = shear ? Math.abs(shear.rate) : 0;
const ofScene = "units of the scene";
const scales = {
  speed: () => (shear ? { unit: rate * radiusScale.mean, name: "in units of γ̇a" } : { unit: 1, name: ofScene }),
  spin: () => (shear ? { unit: rate, name: "in units of γ̇" } : { unit: 1, name: ofScene }),
  stress: () => (shear && !index.dry ? { unit: index.viscosity * rate, name: "in units of ηγ̇" } : { unit: 1, name: ofScene }),
  none: () => ({ unit: 1, name: "" }),
  force: () => ({ unit: 1, name: ofScene }),
  scene: () => ({ unit: 1, name: ofScene }),
};

// What moves less than a thousandth of a radius, or turns less than a thousandth of a radian, in the whole run counts as at rest.
const restful = {
  speed: () => (duration > 0 ? (1e-3 * radiusScale.mean) / duration : 0),
  spin: () => (duration > 0 ? 1e-3 / duration : 0),
  stress: () => (shear && !index.dry ? 1e-6 * index.viscosity * rate : 0),
  none: () => 0,
  scene: () => 0,
  force: () => forceFloor.value,
};

// Forces a thousandth of what the fastest body would meet are those that the solver leaves on free ones.
const forceFloor = { value: 0 };

function learnSpeeds(frames) {
  const fastest = frames.reduce((top, frame) => each(frame, (body) => length(frame, "velocity", body)).reduce((one, other) => Math.max(one, other), top), 0);
  forceFloor.value = 1e-3 * index.viscosity * fastest * radiusScale.mean ** (dimension - 2);
}

const length = (frame, name, body) => Math.hypot(frame[`${name}_x`][body], frame[`${name}_y`][body], frame[`${name}_z`] ? frame[`${name}_z`][body] : 0);
const each = (frame, value) => Float32Array.from({ length: frame.count }, (_, body) => value(body));

// The velocity that the shear gives at a height.
const affine = (height) => shear.base + shear.rate * height;

function nonAffine(frame) {
  const [flow, height] = [axisNames[shear.flow], frame[axisNames[shear.gradient]]];
  const velocities = axisNames.map((axis) => frame[`velocity_${axis}`]);
  const own = (axis, body) => velocities[axis][body] - (axisNames[axis] === flow ? affine(height[body]) : 0);
  return each(frame, (body) => Math.hypot(...axisNames.map((_, axis) => own(axis, body))));
}

// Minus the mean of the normal stresses by contacts: the forces times the arms from the centre, over the volume of the body.
function contactPressure(frame) {
  const pressure = new Float32Array(frame.count);
  const add = (body, force, gap) => {
    const radius = frame.radius[body];
    const volume = dimension === 2 ? Math.PI * radius ** 2 : (4 / 3) * Math.PI * radius ** 3;
    pressure[body] += (force * (radius + 0.5 * gap)) / (dimension * volume);
  };
  for (let k = 0; k < frame.contact_body.length; k++) {
    const [force, gap, partner] = [frame.contact_force[k], frame.contact_gap[k], frame.contact_partner[k]];
    add(frame.contact_body[k], force, gap);
    if (partner >= 0) add(partner, force, gap);
  }
  return pressure;
}

// Of each body the number of its chain, cell or cluster, or -1.
function chains(frame) {
  const numbers = new Float32Array(frame.count).fill(-1);
  for (let k = 0; k < frame.bond_chain.length; k++) numbers[frame.bond_from[k]] = numbers[frame.bond_to[k]] = frame.bond_chain[k];
  return numbers;
}

const species = (frame) => each(frame, (body) => radiusScale.classes.indexOf(Number(frame.radius[body].toPrecision(4))));
const spin = (frame) => (dimension === 2 ? frame.spin_z : each(frame, (body) => length(frame, "spin", body)));
const force = (frame) => each(frame, (body) => length(frame, "force", body));
// Sizes that have colours of their own; of more the radius is a magnitude.
const mostClasses = 7;
const tiedName = index.tied.join(" or ") || "chain";

// kind: magnitude from zero up, signed about zero, count of things, category without an order.
const bodyQuantities = [
  { key: "plain", label: "nothing", kind: "none" },
  { key: "speed", label: "speed", symbol: "|v|", kind: "magnitude", scale: "speed", values: (frame) => each(frame, (body) => length(frame, "velocity", body)) },
  { key: "nonaffine", label: "non-affine speed", symbol: "|v − γ̇y eₓ|", kind: "magnitude", scale: "speed", values: nonAffine, where: () => shear !== null },
  { key: "spin", label: "spin", symbol: dimension === 2 ? "ω" : "|ω|", kind: dimension === 2 ? "signed" : "magnitude", scale: "spin", values: spin },
  { key: "contacts", label: "number of contacts", symbol: "contacts", kind: "count", scale: "none", values: (frame) => frame.touches, where: (frames) => frames.some((frame) => frame.contact_body) },
  { key: "pressure", label: "contact pressure", symbol: "p (contacts)", kind: "signed", scale: "stress", values: contactPressure, where: (frames) => frames.some((frame) => frame.contact_body?.length) },
  { key: "force", label: "fluid force", symbol: "|F|", kind: "magnitude", scale: "force", values: force, where: (frames) => frames.some((frame) => force(frame).some((value) => value > forceFloor.value)) },
  { key: "chain", label: tiedName, symbol: tiedName, kind: "category", values: chains, where: (frames) => frames[0].bond_chain.length > 0 },
  { key: "species", label: "species (radius)", symbol: "radius", kind: "category", values: species, where: () => radiusScale.classes.length > 1 && radiusScale.classes.length <= mostClasses },
  { key: "radius", label: "radius", symbol: "a", kind: "magnitude", scale: "scene", values: (frame) => frame.radius, where: () => radiusScale.classes.length > mostClasses },
];

const flowQuantities = [
  { key: "none", label: "nothing", kind: "none" },
  { key: "speed", label: "speed", symbol: "|u|", kind: "magnitude", scale: "speed", values: flowSpeed },
  { key: "nonaffine", label: "non-affine speed", symbol: "|u − γ̇y eₓ|", kind: "magnitude", scale: "speed", values: flowNonAffine, where: () => shear !== null && shear.flow === across && shear.gradient === up },
  { key: "vorticity", label: "vorticity", symbol: "∇×u", kind: "signed", scale: "spin", values: flowVorticity, shown: 0.98 },
  { key: "pressure", label: "pressure", symbol: "p", kind: "signed", scale: "stress", values: (frame) => frame.flow_pressure, shown: 0.98 },
];

// From which value to which the colours go: all the run's, from some of its frames, but for a few outliers.
function rangeOf(quantity, frames) {
  if (quantity.kind === "none" || quantity.kind === "category") return { low: 0, high: 1 };
  const all = frames.flatMap((frame) => [...thinned(quantity.values(frame).map(Math.abs), 50000)]);
  if (quantity.kind === "count") return { low: 0, high: all.reduce((top, value) => Math.max(top, value), 1) };
  const found = robustMaximum(all, quantity.shown ?? 0.995);
  const negative = quantity.kind === "signed" && frames.some((frame) => quantity.values(frame).some((value) => value < -1e-3 * found));
  const rest = restful[quantity.scale]();
  const high = found > rest && found > 0 ? found : rest || 1;
  return { low: negative ? -high : 0, high, atRest: high !== found };
}

function thinned(values, most) {
  const stride = Math.ceil(values.length / most);
  return stride > 1 ? values.filter((_, k) => k % stride === 0) : values;
}

const mapOf = (range) => (range.low < 0 ? index.maps.diverging : index.maps.sequential);

// How fast the box above moves past this one, where images slide.
const slide = () => (shear ? shear.rate * size[shear.gradient] : 0);

// Values of images so many boxes above: these are faster.
function valuesOfImages(frame, quantity, boxes) {
  if (quantity.key !== "speed" || boxes === 0 || frame.offset === null) return quantity.values?.(frame);
  return each(frame, (body) => Math.hypot(frame.velocity_x[body] + boxes * slide(), frame.velocity_y[body], frame.velocity_z ? frame.velocity_z[body] : 0));
}

// The colour of a value.
function colourOf(quantity, range, value) {
  if (quantity.kind === "none") return plain;
  if (quantity.kind === "category") return value < 0 ? plain : distinct(value);
  return shade(mapOf(range), (value - range.low) / (range.high - range.low));
}
