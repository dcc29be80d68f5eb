// Columns of numbers that grow, and pictures of them over time on a canvas.

// The samples of one axis: a column of doubles for each field.
export class Columns {
  constructor(fields) {
    this.length = 0;
    this.capacity = 4096;
    this.column = {};
    for (const field of fields) this.column[field] = new Float64Array(this.capacity);
    this.columns = Object.values(this.column);  // the same, in the order of a row
  }

  // `row` has, from `first` on, a number for each field in their order; null is not known.
  push(row, first) {
    if (this.length === this.capacity) this.#grow();
    this.columns.forEach((column, place) => { column[this.length] = row[first + place] ?? NaN; });
    ++this.length;
  }

  // Forgets the oldest so that about `most` remain.
  keep(most) {
    if (this.length <= 1.25 * most) return;
    const gone = this.length - most;
    for (const field in this.column) this.column[field].copyWithin(0, gone, this.length);
    this.length = most;
  }

  clear() { this.length = 0; }

  // The first place whose time is `time` or later.
  find(time) {
    const times = this.column.time_s;
    let low = 0, high = this.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < time) low = middle + 1; else high = middle;
    }
    return low;
  }

  last(field) { return this.length === 0 ? NaN : this.column[field][this.length - 1]; }

  #grow() {
    this.capacity *= 2;
    for (const field in this.column) {
      const larger = new Float64Array(this.capacity);
      larger.set(this.column[field]);
      this.column[field] = larger;
    }
    this.columns = Object.values(this.column);
  }
}

// A number with so many significant digits and its unit, with the prefix that suits it.
export function quantity(value, unit, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return `0 ${unit}`;
  const prefixes = { "-9": "n", "-6": "µ", "-3": "m", "0": "", "3": "k", "6": "M" };
  const exponent = Math.min(6, Math.max(-9, 3 * Math.floor(Math.log10(Math.abs(value)) / 3)));
  const number = (value / 10 ** exponent).toPrecision(digits).replace("-", "−");
  return `${number} ${prefixes[exponent]}${unit}`;
}

// About `count` round numbers in [low, high].
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= rough);
  const all = [];
  for (let n = Math.ceil(low / step); n * step <= high + 1e-9 * step; ++n) all.push(n * step);
  return all;
}

function tickText(value, all) {
  const step = all.length > 1 ? Math.abs(all[1] - all[0]) : Math.abs(value) || 1;
  if (value !== 0 && (Math.abs(value) >= 1e5 || step < 1e-8)) return value.toExponential(2);
  if (Math.abs(value) < 1e-9 * step) return "0";
  return value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
}

const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// One picture. `lines`: [{ of(columns, place), color, label }]. `scale`: "linear" or "log", whose values are positive.
// `least`: the least range that a linear scale shows, in the unit.
export class Chart {
  static left = 80;
  static right = 8;

  constructor(parent, { title, unit, lines, scale = "linear", least = 1, height = 150, bands = null, marks = null,
    timeline = false }) {
    Object.assign(this, { title, unit, lines, scale, least, height, bands, marks, timeline });
    this.figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    const name = document.createElement("b");
    name.textContent = unit ? `${title} [${unit}]` : title;
    caption.append(name);
    for (const line of lines) {
      line.caption = document.createElement("span");
      line.caption.className = line.color;
      line.caption.textContent = line.label;
      line.caption.hidden = true;  // until it is drawn
      caption.append(line.caption);
    }
    this.canvas = document.createElement("canvas");
    this.figure.append(caption, this.canvas);
    parent.append(this.figure);
  }

  // The time under a pointer, of the view that was drawn last.
  timeAt(clientX) {
    const box = this.canvas.getBoundingClientRect();
    const share = (clientX - box.left - Chart.left) / (box.width - Chart.left - Chart.right);
    return this.from + Math.min(1, Math.max(0, share)) * (this.to - this.from);
  }

  // Draws [from, to]; `origin` is the time that is shown as 0, `marked` a time or a pair of times to mark.
  draw(columns, { from, to, origin, marked }) {
    Object.assign(this, { from, to });
    const ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth;
    const height = this.height + (this.timeline ? 20 : 0);
    this.canvas.style.height = `${height}px`;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    const context = this.canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.font = "12px system-ui, 'DejaVu Sans', sans-serif";
    this.context = context;
    const inside = Math.max(1, width - Chart.left - Chart.right);
    this.plot = { left: Chart.left, width: inside, top: 8, height: this.height - 16 };
    const first = Math.max(0, columns.find(from) - 1);
    const last = Math.min(columns.length, columns.find(to) + 1);
    this.#drawBands(columns, first, last);
    const range = this.#range(columns, first, last);
    if (this.lines.length > 0) this.#drawGrid(range);
    this.#drawTimes(origin);
    context.save();
    context.beginPath();
    context.rect(this.plot.left, this.plot.top - 2, this.plot.width, this.plot.height + 4);
    context.clip();
    if (range) for (const line of this.lines) this.#drawLine(columns, first, last, line, range);
    if (this.marks) this.#drawMarks(columns, first, last);
    this.#drawMarked(marked);
    context.restore();
    context.strokeStyle = color("line");
    context.strokeRect(this.plot.left, this.plot.top, this.plot.width, this.plot.height);
  }

  #x(time) { return this.plot.left + (time - this.from) / (this.to - this.from) * this.plot.width; }

  #shown(value) { return this.scale === "log" ? Math.log10(value) : value; }

  #y(value, range) {
    const share = (this.#shown(value) - range.low) / (range.high - range.low);
    return this.plot.top + (1 - Math.min(1.05, Math.max(-0.05, share))) * this.plot.height;
  }

  // Of what is shown; on a logarithmic scale in decades. Nothing where nothing is known.
  #range(columns, first, last) {
    let low = Infinity, high = -Infinity;
    for (const line of this.lines)
      for (let place = first; place < last; ++place) {
        const value = this.#shown(line.of(columns.column, place));
        if (!Number.isFinite(value)) continue;
        if (value < low) low = value;
        if (value > high) high = value;
      }
    if (low > high) return null;
    if (this.scale === "log") return { low: Math.floor(low), high: Math.max(Math.ceil(high), Math.floor(low) + 1) };
    const margin = Math.max(0.06 * (high - low), this.least / 2 - (high - low) / 2);
    return { low: low - margin, high: high + margin };
  }

  #drawGrid(range) {
    const { context, plot } = this;
    context.fillStyle = color("soft");
    context.textAlign = "right";
    context.textBaseline = "middle";
    if (!range) {
      context.textAlign = "center";
      context.fillText("not known from this source", plot.left + plot.width / 2, plot.top + plot.height / 2);
      return;
    }
    context.strokeStyle = color("line");
    const log = this.scale === "log";
    const all = log ? ticks(range.low, range.high, 4).filter(Number.isInteger) : ticks(range.low, range.high, 5);
    for (const tick of all) {
      const y = this.#y(log ? 10 ** tick : tick, range);
      context.beginPath();
      context.moveTo(plot.left, y);
      context.lineTo(plot.left + plot.width, y);
      context.stroke();
      const text = log ? quantity(10 ** tick, this.unit, 1 + (tick % 3 + 3) % 3) : tickText(tick, all);
      context.fillText(text, plot.left - 6, y);
    }
  }

  #drawTimes(origin) {
    const { context, plot } = this;
    const all = ticks(this.from - origin, this.to - origin, Math.max(2, Math.floor(plot.width / 110)));
    context.strokeStyle = color("line");
    context.fillStyle = color("soft");
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const tick of all) {
      const x = this.#x(origin + tick);
      context.beginPath();
      context.moveTo(x, plot.top);
      context.lineTo(x, plot.top + plot.height);
      context.stroke();
      if (this.timeline) context.fillText(`${tickText(tick, all)} s`, x, plot.top + plot.height + 6);
    }
  }

  // Of all samples within a column of pixels the least and the largest are drawn, so that no peak is lost.
  #drawLine(columns, first, last, line, range) {
    const { context } = this;
    const times = columns.column.time_s;
    context.strokeStyle = color(line.color);
    context.lineWidth = 1.4;
    context.beginPath();
    line.caption.hidden = true;
    let pixel = NaN, low = 0, high = 0, end = 0, pen = false;
    const flush = () => {
      if (Number.isNaN(pixel)) return;
      context.lineTo(pixel, low);
      context.lineTo(pixel, high);
      context.lineTo(pixel, end);
    };
    for (let place = first; place < last; ++place) {
      const value = line.of(columns.column, place);
      if (Number.isNaN(value)) { flush(); pixel = NaN; pen = false; continue; }
      const x = Math.round(this.#x(times[place]) * 2) / 2, y = this.#y(value, range);
      if (!pen) { context.moveTo(x, y); pen = true; line.caption.hidden = false; }
      if (x === pixel) { low = Math.min(low, y); high = Math.max(high, y); end = y; continue; }
      flush();
      if (line.steps && !Number.isNaN(pixel)) context.lineTo(x, end);
      pixel = x; low = high = end = y;
    }
    flush();
    context.stroke();
    context.lineWidth = 1;
  }

  // A band for as long as a mode lasts.
  #drawBands(columns, first, last) {
    if (!this.bands) return;
    const { context, plot } = this;
    const times = columns.column.time_s;
    for (let place = first; place < last;) {
      const name = this.bands(columns.column, place);
      let next = place + 1;
      while (next < last && this.bands(columns.column, next) === name) ++next;
      if (name) {
        const begin = Math.max(this.#x(times[place]), plot.left);
        const end = Math.min(this.#x(times[Math.min(next, last - 1)]), plot.left + plot.width);
        context.fillStyle = color(name);
        context.fillRect(begin, plot.top, Math.max(name === "kick" ? 1 : 0.5, end - begin), plot.height);
      }
      place = next;
    }
  }

  // A stroke at the top where `marks` says so.
  #drawMarks(columns, first, last) {
    const { context, plot } = this;
    context.strokeStyle = color("front");
    for (let place = Math.max(first, 1); place < last; ++place) {
      if (!this.marks(columns.column, place)) continue;
      const x = this.#x(columns.column.time_s[place]);
      context.beginPath();
      context.moveTo(x, plot.top);
      context.lineTo(x, plot.top + plot.height);
      context.stroke();
    }
  }

  #drawMarked(marked) {
    const { context, plot } = this;
    if (Array.isArray(marked)) {
      const [a, b] = marked.map((time) => this.#x(time)).sort((one, other) => one - other);
      context.globalAlpha = 0.2;
      context.fillStyle = color("first");
      context.fillRect(a, plot.top, b - a, plot.height);
      context.globalAlpha = 1;
    } else if (marked !== null) {
      context.strokeStyle = color("soft");
      context.beginPath();
      context.moveTo(this.#x(marked), plot.top);
      context.lineTo(this.#x(marked), plot.top + plot.height);
      context.stroke();
    }
  }
}
