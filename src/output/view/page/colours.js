// Colour maps, colours of things without an order, round ticks and the writing of numbers.

const ink = [33, 37, 48];
const plain = [96, 108, 128];

// The colour of a part, from zero to one, of a map.
function shade(map, part) {
  const place = Math.min(Math.max(part, 0), 1) * (map.length - 1);
  const low = Math.min(Math.floor(place), map.length - 2);
  return map[low].map((value, k) => value + (place - low) * (map[low + 1][k] - value));
}

const distinct = (number) => index.maps.distinct[number % index.maps.distinct.length];
const written = ([red, green, blue], alpha = 1) => `rgba(${Math.round(red)},${Math.round(green)},${Math.round(blue)},${alpha})`;
const mixed = (one, other, part) => one.map((value, k) => value + part * (other[k] - value));

const superscripts = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

// A number with so many significant digits, for people.
function number(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const power = Math.floor(Math.log10(Math.abs(value)) + 1e-12);
  if (power >= -3 && power < 6) {
    const text = value.toFixed(Math.max(0, digits - 1 - power));
    return signed(text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  }
  const raised = [...String(power)].map((sign) => superscripts[sign]).join("");
  return signed(`${(value / 10 ** power).toFixed(2).replace(/\.?0+$/, "")}·10${raised}`);
}

const signed = (text) => text.replace("-", "−");

// Round values within a range, about so many.
function ticks(low, high, wanted = 4) {
  const range = high - low;
  if (!(range > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(range / wanted));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((step) => range / step <= wanted + 0.5) ?? 10 * power;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= Math.floor(high / step + 1e-9); k++) found.push(k * step);
  return found;
}

// The largest of 1, 2 and 5 times powers of ten that is not above a positive value.
function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].map((digit) => digit * power).find((candidate) => candidate <= value * (1 + 1e-9)) ?? power;
}

// A value that all but a part of the values do not exceed.
function robustMaximum(values, part) {
  const sorted = Float32Array.from(values).sort();
  if (sorted.length === 0) return 0;
  const percentile = sorted[Math.ceil(part * (sorted.length - 1))];
  return percentile > 0 ? percentile : sorted[sorted.length - 1];
}
