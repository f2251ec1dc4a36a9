"use strict";
// Charts of the tables in the page: a read-out under the pointer, a drag zooms, a double click shows all again.
(() => {
  const { tables, charts } = JSON.parse(document.getElementById("data").textContent);
  // M. Okabe and K. Ito, 2008, Color universal design
  const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#14171f", "#8a6d00"];
  const MARGIN = { left: 66, right: 14, top: 12, bottom: 40 };
  const INK = "#14171f", SOFT = "#5a6270", LINE = "#dfe3e9";

  function element(tag, parent, attributes = {}, text = "") {
    const made = parent.appendChild(document.createElement(tag));
    Object.assign(made, attributes);
    if (text) made.textContent = text;
    return made;
  }

  function ticks(low, high) {
    const rough = (high - low) / 5, unit = 10 ** Math.floor(Math.log10(rough));
    const step = unit * [1, 2, 5, 10].find((digit) => unit * digit >= rough * 0.999);
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
    return { values: found, step };
  }

  function label(value, step) {
    if (Math.abs(value) < step * 1e-6) return "0";
    const size = Math.abs(value);
    if (size >= 1e5 || size < 1e-3) return value.toExponential(Math.min(6, Math.max(0, Math.floor(Math.log10(size) + 1e-9) - Math.floor(Math.log10(step) + 1e-9)))).replace("-", "\u2212");
    return value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "\u2212");
  }

  class Chart {
    constructor(host, spec) {
      this.spec = spec;
      this.table = tables[spec.table];
      this.x = this.table.columns.includes(spec.x) ? spec.x : this.table.columns[0];
      this.chosen = new Set(spec.y.slice(0, COLOURS.length));
      this.logarithmic = spec.logarithmic;
      this.window = null;
      this.host = element("div", host, { className: "chart" });
      element("h3", this.host, {}, spec.title);
      this.keys = element("div", this.host, { className: "keys" });
      this.canvas = element("canvas", this.host);
      this.canvas.setAttribute("role", "img");
      this.canvas.setAttribute("aria-label", `${spec.title} over ${this.x}`);
      this.tip = element("div", this.host, { className: "tip", hidden: true });
      this.choices();
      this.listen();
      new ResizeObserver(() => this.draw()).observe(this.canvas);
    }

    /// What a column is called.
    words(name) {
      const place = this.spec.y.indexOf(name);
      return place < 0 ? name.replaceAll("_", " ") : this.spec.words[place];
    }

    column(name) {
      return this.table.values[this.table.columns.indexOf(name)];
    }

    colour(name) {
      const place = this.spec.y.indexOf(name);
      const other = this.table.columns.indexOf(name);
      return COLOURS[(place < 0 ? this.spec.y.length + other : place) % COLOURS.length];
    }

    choices() {
      const details = element("details", this.host, { className: "choices" });
      element("summary", details, {}, "choose columns");
      const axis = element("div", details, { className: "choice" });
      const across = element("label", axis, {}, "abscissa ");
      const select = element("select", across);
      for (const name of this.table.columns) element("option", select, { value: name, selected: name === this.x }, name);
      select.onchange = () => { this.x = select.value; this.window = null; this.draw(); };
      const log = element("label", axis);
      const box = element("input", log, { type: "checkbox", checked: this.logarithmic });
      log.append(" logarithmic ordinate");
      box.onchange = () => { this.logarithmic = box.checked; this.draw(); };
      const columns = element("div", details, { className: "choice" });
      for (const name of this.table.columns) {
        const wrap = element("label", columns);
        const check = element("input", wrap, { type: "checkbox", checked: this.chosen.has(name) });
        wrap.append(` ${name}`);
        check.onchange = () => { check.checked ? this.chosen.add(name) : this.chosen.delete(name); this.draw(); };
      }
    }

    /// Lines of the chosen columns as pairs; no number breaks a line.
    lines() {
      const x = this.column(this.x);
      return [...this.chosen].map((name) => {
        const y = this.column(name);
        const points = x.map((at, place) => [at, this.logarithmic && !(y[place] > 0) ? null : y[place]]);
        return { name, colour: this.colour(name), points };
      });
    }

    /// The band of a mean, where its column and abscissa are shown.
    band() {
      const { band, x, y } = this.spec;
      return band && this.x === x && this.chosen.has(y[0]) && !this.logarithmic ? band : null;
    }

    ranges(lines) {
      const all = this.column(this.x).filter((value) => value !== null);
      let [left, right] = this.window || [Math.min(...all), Math.max(...all)];
      if (!(right > left)) { left -= 0.5; right += 0.5; }
      const band = this.band();
      // what the mean leaves out is not to squeeze the rest, unless it is looked at
      const start = band && !this.window && band.from_to[0] < right ? band.from_to[0] : left;
      const seen = lines.flatMap(({ points }) => points.filter(([at, y]) => y !== null && at !== null && at >= start && at <= right).map(([, y]) => y));
      if (band && band.from_to[1] > left && band.from_to[0] < right) seen.push(...band.interval);
      const scaled = this.logarithmic ? seen.map(Math.log10) : seen;
      let low = scaled.reduce((least, y) => Math.min(least, y), Infinity), high = scaled.reduce((most, y) => Math.max(most, y), -Infinity);
      if (!(high >= low)) [low, high] = [0, 1];
      if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) { const room = Math.abs(low) * 0.1 || 1; low -= room; high += room; }
      else { const room = 0.06 * (high - low); const zero = low >= 0 && low < 0.4 * high && !this.logarithmic; low = zero ? 0 : low - room; high += room; }
      return { left, right, low, high };
    }

    draw(pointer = null, drag = null) {
      const { clientWidth: width, clientHeight: height } = this.canvas, ratio = window.devicePixelRatio || 1;
      if (!width) return;
      this.canvas.width = width * ratio; this.canvas.height = height * ratio;
      const pen = this.canvas.getContext("2d");
      pen.scale(ratio, ratio);
      const lines = this.lines(), range = this.ranges(lines);
      const box = { left: MARGIN.left, right: width - MARGIN.right, top: MARGIN.top, foot: height - MARGIN.bottom };
      const px = (x) => box.left + (x - range.left) / (range.right - range.left) * (box.right - box.left);
      const py = (y) => box.foot - ((this.logarithmic ? Math.log10(y) : y) - range.low) / (range.high - range.low) * (box.foot - box.top);
      this.view = { range, box, px, py, lines };
      this.axes(pen, range, box, px);
      pen.save();
      pen.beginPath(); pen.rect(box.left, box.top - 1, box.right - box.left, box.foot - box.top + 2); pen.clip();
      this.shade(pen, box, px, py);
      for (const line of [...lines].reverse()) this.line(pen, line, px, py);
      if (drag) { pen.fillStyle = "rgba(0, 114, 178, 0.15)"; pen.fillRect(Math.min(...drag), box.top, Math.abs(drag[1] - drag[0]), box.foot - box.top); }
      pen.restore();
      if (pointer !== null) this.readOut(pen, pointer); else this.tip.hidden = true;
      this.keys.replaceChildren();
      for (const { name, colour } of lines) { const key = element("span", this.keys); element("i", key).style.background = colour; key.append(this.words(name)); }
      if (this.band()) { const key = element("span", this.keys); element("i", key).style.cssText = "background: rgba(0, 114, 178, 0.25); height: 9px"; key.append("mean with its 95 % interval; grey: left out"); }
    }

    axes(pen, { left, right, low, high }, box, px) {
      pen.font = "12px Helvetica, Arial, 'Liberation Sans', sans-serif";
      pen.lineWidth = 1; pen.strokeStyle = LINE; pen.fillStyle = SOFT;
      pen.textAlign = "center"; pen.textBaseline = "top";
      const across = ticks(left, right);
      for (const value of across.values) {
        pen.beginPath(); pen.moveTo(px(value), box.top); pen.lineTo(px(value), box.foot); pen.stroke();
        pen.fillText(label(value, across.step), px(value), box.foot + 6);
      }
      pen.textAlign = "right"; pen.textBaseline = "middle";
      const up = ticks(low, high);
      const whole = up.values.filter((value) => Math.abs(value - Math.round(value)) < 1e-9);
      const decades = this.logarithmic && whole.length > 1;
      for (const value of decades ? whole : up.values) {
        const y = box.foot - (value - low) / (high - low) * (box.foot - box.top);
        pen.beginPath(); pen.moveTo(box.left, y); pen.lineTo(box.right, y); pen.stroke();
        const shown = this.logarithmic ? Number((10 ** value).toPrecision(3)).toExponential(decades ? 0 : 1).replace("-", "\u2212") : label(value, up.step);
        pen.fillText(shown, box.left - 7, y);
      }
      pen.strokeStyle = "rgba(20, 23, 31, 0.55)";
      pen.beginPath(); pen.moveTo(box.left, box.top); pen.lineTo(box.left, box.foot); pen.lineTo(box.right, box.foot); pen.stroke();
      pen.fillStyle = INK; pen.textAlign = "center"; pen.textBaseline = "bottom";
      pen.fillText(this.x, (box.left + box.right) / 2, box.foot + MARGIN.bottom - 2);
    }

    shade(pen, box, px, py) {
      const band = this.band();
      if (!band) return;
      const [from, to] = band.from_to.map(px), [low, high] = band.interval.map(py);
      pen.fillStyle = "rgba(90, 98, 112, 0.12)"; pen.fillRect(box.left, box.top, from - box.left, box.foot - box.top);
      pen.fillStyle = "rgba(0, 114, 178, 0.2)"; pen.fillRect(from, high, to - from, low - high);
      pen.strokeStyle = "#0072b2"; pen.setLineDash([6, 4]);
      pen.beginPath(); pen.moveTo(from, py(band.mean)); pen.lineTo(to, py(band.mean)); pen.stroke();
      pen.setLineDash([]);
    }

    line(pen, { points, colour }, px, py) {
      pen.strokeStyle = pen.fillStyle = colour; pen.lineWidth = 1.7; pen.lineJoin = "round";
      pen.beginPath();
      let pens = false;
      points.forEach(([x, y], place) => {
        if (x === null || y === null) { pens = false; return; }
        pens ? pen.lineTo(px(x), py(y)) : pen.moveTo(px(x), py(y));
        const next = points[place + 1];
        if (!pens && !(next && next[0] !== null && next[1] !== null)) { pen.rect(px(x) - 1, py(y) - 1, 2, 2); }
        pens = true;
      });
      pen.stroke();
    }

    readOut(pen, at) {
      const { box, px, py, lines, range } = this.view, x = this.column(this.x);
      let best = -1;
      x.forEach((value, place) => {
        if (value === null || value < range.left || value > range.right) return;
        if (best < 0 || Math.abs(px(value) - at) < Math.abs(px(x[best]) - at)) best = place;
      });
      if (best < 0) { this.tip.hidden = true; return; }
      pen.strokeStyle = "rgba(20, 23, 31, 0.4)"; pen.lineWidth = 1;
      pen.beginPath(); pen.moveTo(px(x[best]), box.top); pen.lineTo(px(x[best]), box.foot); pen.stroke();
      this.tip.replaceChildren();
      element("div", this.tip, {}, `${this.x} ${x[best]}`);
      for (const { name, colour, points } of lines) {
        const y = points[best][1];
        const row = element("div", this.tip);
        element("i", row).style.background = colour;
        row.append(`${this.words(name)} ${y === null ? "none" : y}`);
        if (y !== null) { pen.fillStyle = colour; pen.beginPath(); pen.arc(px(x[best]), py(y), 3.2, 0, 7); pen.fill(); }
      }
      this.tip.hidden = false;
      const right = px(x[best]) > (box.left + box.right) / 2;
      this.tip.style.top = `${this.canvas.offsetTop + box.top + 4}px`;
      this.tip.style.left = right ? "auto" : `${px(x[best]) + 12}px`;
      this.tip.style.right = right ? `${this.canvas.clientWidth - px(x[best]) + 12}px` : "auto";
    }

    listen() {
      const place = (event) => event.clientX - this.canvas.getBoundingClientRect().left;
      let start = null;
      this.canvas.onpointerdown = (event) => { start = place(event); this.canvas.setPointerCapture(event.pointerId); };
      this.canvas.onpointermove = (event) => this.draw(place(event), start === null ? null : [start, place(event)]);
      this.canvas.onpointerleave = () => { if (start === null) this.draw(); };
      this.canvas.onpointerup = (event) => {
        const [from, to] = [start, place(event)].sort((a, b) => a - b);
        start = null;
        if (to - from > 5) {
          const { range, box } = this.view;
          const value = (pixel) => range.left + (pixel - box.left) / (box.right - box.left) * (range.right - range.left);
          this.window = [Math.max(value(from), range.left), Math.min(value(to), range.right)];
        }
        this.draw(place(event));
      };
      this.canvas.ondblclick = () => { this.window = null; this.draw(); };
    }
  }

  const host = document.getElementById("charts");
  const solver = document.getElementById("solver");
  if (host) charts.forEach((spec) => new Chart(spec.of_solver ? solver : host, spec));
})();
