// Charts of one line with a mark at the time that is shown.

// Draws y over x, and returns the x of a place across.
function drawChart(chart, { xs, ys, xName, now }) {
  const dense = Math.min(window.devicePixelRatio || 1, 2);
  const [width, height] = [chart.clientWidth, chart.clientHeight];
  [chart.width, chart.height] = [width * dense, height * dense];
  const ink = chart.getContext("2d");
  ink.scale(dense, dense);
  const known = ys.filter(Number.isFinite);
  if (known.length === 0 || width === 0) return null;
  let [low, high] = known.reduce(([low, high], y) => [Math.min(low, y), Math.max(high, y)], [Infinity, -Infinity]);
  // what varies by rounding alone is a straight line
  if (high - low < 1e-9 * Math.max(Math.abs(low), Math.abs(high)) || high === low) {
    const middle = (low + high) / 2;
    [low, high] = [middle - (Math.abs(middle) || 1) / 2, middle + (Math.abs(middle) || 1) / 2];
  }
  const [left, right, top, foot] = [46, width - 8, 8, height - 20];
  const [first, last] = [xs[0], xs[xs.length - 1]];
  const spread = last > first ? last - first : 1;
  const across_ = (x) => left + ((x - first) / spread) * (right - left);
  const above = (y) => foot - ((y - low) / (high - low)) * (foot - top);
  ink.font = "10.5px system-ui, sans-serif";
  ink.lineWidth = 1;
  for (const tick of ticks(low, high, 3)) {
    ink.strokeStyle = "#eceff4";
    ink.beginPath();
    ink.moveTo(left, above(tick));
    ink.lineTo(right, above(tick));
    ink.stroke();
    [ink.fillStyle, ink.textAlign, ink.textBaseline] = ["#5b6475", "right", "middle"];
    ink.fillText(number(tick, 4), left - 5, above(tick));
  }
  [ink.textBaseline, ink.textAlign] = ["alphabetic", "left"];
  ink.fillText(number(first, 3), left, height - 5);
  ink.textAlign = "center";
  ink.fillText(xName, (left + right) / 2, height - 5);
  ink.textAlign = "right";
  ink.fillText(number(last, 3), right, height - 5);
  ink.save();
  ink.beginPath();
  ink.rect(left - 1, top - 4, right - left + 2, foot - top + 8);
  ink.clip();
  ink.beginPath();
  let drawn = false;
  xs.forEach((x, k) => {
    if (!Number.isFinite(ys[k])) return void (drawn = false);
    if (drawn) ink.lineTo(across_(x), above(ys[k]));
    else ink.moveTo(across_(x), above(ys[k]));
    drawn = true;
  });
  [ink.strokeStyle, ink.lineWidth, ink.lineJoin] = ["#0072b2", 1.5, "round"];
  ink.stroke();
  ink.restore();
  const nearest = xs.reduce((best, x, k) => (Number.isFinite(ys[k]) && Math.abs(x - now) < Math.abs(xs[best] - now) ? k : best), ys.findIndex(Number.isFinite));
  ink.strokeStyle = "#b9c0cc";
  ink.lineWidth = 1;
  ink.beginPath();
  ink.moveTo(across_(now), top);
  ink.lineTo(across_(now), foot);
  ink.stroke();
  ink.fillStyle = "#d55e00";
  ink.beginPath();
  ink.arc(across_(xs[nearest]), above(ys[nearest]), 3.5, 0, 2 * Math.PI);
  ink.fill();
  [ink.textAlign, ink.fillStyle, ink.font] = [across_(xs[nearest]) > (left + right) / 2 ? "right" : "left", "#21252f", "600 11px system-ui, sans-serif"];
  const beside = ink.textAlign === "right" ? -7 : 7;
  const value = above(ys[nearest]);
  ink.fillText(number(ys[nearest]), across_(xs[nearest]) + beside, value < top + 20 ? value + 15 : value - 7);
  return (place) => first + ((place - left) / (right - left)) * spread;
}

const series = index.series;
const seriesChoice = document.getElementById("series-choice");
const seriesChart = document.getElementById("series-chart");
let seriesTime = null;

// Columns that vary, the first of those that answer what most scenes ask for chosen.
function beginSeries() {
  if (!series || series.rows.length < 2) return;
  const unshown = ["step", "time", "last_step", "seconds", "strain", "kkt_residual", "contact_solver"];
  const varies = (_, column) => new Set(series.rows.map((row) => row[column]).filter((value) => value !== null)).size > 1;
  const names = series.names.filter((name, column) => varies(name, column) && !unshown.includes(name));
  if (names.length === 0) return;
  document.getElementById("series").hidden = false;
  seriesChoice.replaceChildren(...names.map((name) => new Option(name.replaceAll("_", " "), name)));
  const wanted = [state.series, "viscosity", "drag_0", "kinetic_energy", "inclination", "contacts"];
  state.series = wanted.find((name) => names.includes(name)) ?? names[0];
  seriesChoice.value = state.series;
  seriesChoice.onchange = () => change({ series: seriesChoice.value });
  seriesChart.onclick = (event) => seriesTime && goToTime(seriesTime(event.offsetX) / (seriesOverStrain() ? rate : 1));
}

const seriesOverStrain = () => shear !== null && series.names.includes("strain");

function drawSeries(frame) {
  if (!state.series) return;
  const [x, y] = [series.names.indexOf(seriesOverStrain() ? "strain" : "time"), series.names.indexOf(state.series)];
  const rows = series.rows.filter((row) => row[x] !== null);
  const now = frame.time * (seriesOverStrain() ? rate : 1);
  seriesTime = drawChart(seriesChart, { xs: rows.map((row) => row[x]), ys: rows.map((row) => row[y] ?? NaN), xName: seriesOverStrain() ? "strain" : "time", now });
}
