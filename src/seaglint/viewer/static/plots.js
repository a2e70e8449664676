// Plots off which values are read: by pointing, or with the arrow keys when a plot has the focus.
import { FONT, INK, after, digits, fitted, minus, power, rate, reading, sized, ticks } from "./tools.js";

const ROOM = { left: 54, right: 10, top: 8, bottom: 34 }; // at the left more where labels need it

/** Smallest and largest of the values that are numbers; null without any. */
function ends(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const v of list) if (v !== null) { if (v < low) low = v; if (v > high) high = v; }
  return low <= high ? [low, high] : null;
}

/** Power of ten that is written beside the unit instead of at each label. */
const exponent = (low, high) => { const size = Math.max(Math.abs(low), Math.abs(high)); return size > 0 && (size < 1e-2 || size >= 1e5) ? Math.floor(Math.log10(size)) : 0; };

/** Labels of round numbers, with the digits that their step asks for. */
function labelled(low, high, many, scale) {
  let places = ticks(low, high, many);
  for (let more = many; places.length < 3 && more < 4 * many; more *= 1.5) places = ticks(low, high, more);
  if (places.length < 2) return (low === high ? [low] : places).map((v) => [v, digits(v / scale, 6)]);
  const decimals = Math.max(0, -Math.floor(Math.log10(Math.abs(places[1] - places[0]) / scale) + 1e-9));
  return places.map((v) => [v, minus((v / scale).toFixed(Math.min(decimals, 12)))]);
}

export class Plot {
  /**
   * @param canvas - where it is drawn
   * @param out - element that tells the values at the mark
   * @param picked - called with the x of a click or of Enter
   * @param dragged - called with both limits when one of them is dragged
   */
  constructor(canvas, out, { picked = null, dragged = null } = {}) {
    Object.assign(this, { canvas, out, picked, dragged, data: null, at: null, held: null });
    canvas.tabIndex = 0;
    new ResizeObserver(() => this.draw()).observe(canvas);
    const across = (event) => event.clientX - canvas.getBoundingClientRect().left;
    canvas.addEventListener("pointerdown", (event) => {
      this.held = this.limitAt(across(event), event.pointerType === "touch" ? 16 : 7);
      if (this.held === null) this.mark(this.nearest(across(event))); else canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      canvas.style.cursor = this.held !== null || this.limitAt(across(event), 7) !== null ? "ew-resize" : "crosshair";
      if (this.held === null) this.mark(this.nearest(across(event))); else this.drag(across(event));
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { setTimeout(() => { this.held = null; }); }); // after the click
    canvas.addEventListener("pointerleave", () => { if (document.activeElement !== canvas) this.mark(null); });
    canvas.addEventListener("focus", () => { if (this.at === null) this.mark(this.start()); });
    canvas.addEventListener("blur", () => this.mark(null));
    canvas.addEventListener("click", () => { if (this.held === null) this.pick(); });
    canvas.addEventListener("keydown", (event) => {
      if (!this.data || event.ctrlKey || event.metaKey || event.altKey) return;
      const last = this.data.series[0].xs.length - 1, at = this.at ?? this.start();
      const moved = { ArrowLeft: at - 1, ArrowRight: at + 1, PageUp: at - 10, PageDown: at + 10, Home: 0, End: last }[event.key];
      if (moved !== undefined) this.mark(Math.min(Math.max(moved, 0), last));
      else if (event.key === "Enter") this.pick();
      else return;
      event.preventDefault();
    });
  }

  start() {
    const { series, now } = this.data || { series: [] };
    return series.length ? Math.max(series[0].xs.findIndex((x) => x >= (now ?? -Infinity)), 0) : null;
  }

  pick() { if (this.picked && this.at !== null) this.picked(this.data.series[0].xs[this.at], this.at); }

  /** Number of the limit within reach of an x; null for none. */
  limitAt(x, reach) {
    if (!this.dragged || !this.x || !this.data.limits) return null;
    const far = this.data.limits.map((v) => Math.abs(this.within(v) - x)), near = far[1] < far[0] ? 1 : 0;
    return far[near] <= reach ? near : null;
  }

  /** x of a limit; those outside stand at the ends. */
  within(v) { return Math.min(Math.max(this.x(v), this.box.x), this.box.r); }

  drag(x) {
    const limits = [...this.data.limits], inside = Math.min(Math.max(x, this.box.x), this.box.r);
    limits[this.held] = this.valueAt(inside);
    if (!(limits[0] < limits[1])) return;
    this.data.limits = limits;
    this.draw();
    this.dragged(limits);
  }

  mark(at) { this.at = at; this.draw(); }

  nearest(x) {
    if (!this.data || !this.x || !this.data.series.length) return null;
    const { xs } = this.data.series[0];
    return xs.reduce((best, v, i) => (Math.abs(this.x(v) - x) < Math.abs(this.x(xs[best]) - x) ? i : best), 0);
  }

  /** What is drawn: series { name, colour, xs, values, bars, edges }, x and y { name, unit }, log, now, limits, note. */
  set(data) {
    if (this.held !== null && this.data?.limits) data.limits = this.data.limits; // those under the finger, not those of an older answer
    this.data = data;
    if (this.at !== null && !(data && data.series.length && this.at < data.series[0].xs.length)) this.at = null;
    this.draw();
  }

  draw() {
    const { canvas, data } = this;
    if (!data || !canvas.clientWidth) { this.out.textContent = ""; return; }
    const { pen, width, height } = sized(canvas), { series, log } = data;
    const box = { x: ROOM.left, y: ROOM.top, r: width - ROOM.right, b: height - ROOM.bottom };
    pen.clearRect(0, 0, width, height);
    pen.font = FONT;
    const across = ends(series.map((s) => s.edges || s.xs)), atX = across && [...across];
    // Bars set the range; the curves over them may leave it.
    let up = ends((series[0]?.bars ? series.slice(0, 1) : series).map((s) => (log ? s.values.filter((v) => v > 0) : s.values)));
    this.x = null;
    this.tell(up);
    if (!series.length) return;
    if (!across || !up) { pen.fillStyle = INK.faint; pen.textAlign = "center"; pen.fillText("no values", width / 2, height / 2); return; }
    if (across[0] === across[1]) { across[0] -= 0.5; across[1] += 0.5; }
    if (log) up = [Math.log10(up[0]) - 0.1, Math.log10(up[1]) + 0.1];
    else if (up[0] === up[1]) { const half = Math.abs(up[0]) * 1e-3 || 0.5; up = [up[0] - half, up[1] + half]; }
    else { const room = 0.06 * (up[1] - up[0]); up = series[0].bars ? [0, up[1] + 2 * room] : [up[0] - room, up[1] + room]; }
    const tens = { x: exponent(...atX), y: log ? 0 : exponent(...up) }, many = Math.max((box.b - box.y) / 26, 3);
    const rows = log
      ? ticks(...up, Math.min(many, up[1] - up[0])).filter(Number.isInteger).map((v) => [10 ** v, power(v)])
      : labelled(...up, many, 10 ** tens.y);
    box.x = Math.max(ROOM.left, Math.ceil(Math.max(...rows.map(([, label]) => pen.measureText(label).width))) + 24);
    this.box = box;
    const columns = labelled(...atX, (box.r - box.x) / 75, 10 ** tens.x);
    const x = (v) => box.x + ((v - across[0]) / (across[1] - across[0])) * (box.r - box.x);
    const y = (v) => box.b - (((log ? Math.log10(v) : v) - up[0]) / (up[1] - up[0])) * (box.b - box.y);
    this.x = x;
    this.valueAt = (place) => across[0] + ((place - box.x) / (box.r - box.x)) * (across[1] - across[0]);
    this.axes(pen, box, { x, y, tens, columns, rows }, height);
    pen.save();
    pen.beginPath();
    pen.rect(box.x, box.y, box.r - box.x, box.b - box.y);
    pen.clip();
    for (const one of series) {
      if (one.bars) { pen.fillStyle = one.colour; one.values.forEach((v, i) => pen.fillRect(x(one.edges[i]), y(v), Math.max(x(one.edges[i + 1]) - x(one.edges[i]) - 0.5, 0.5), box.b - y(v))); }
      else Plot.line(pen, x, y, one, log);
    }
    if (data.now !== undefined && data.now !== null) Plot.upright(pen, x(data.now), box, INK.now, []);
    if (this.at !== null) {
      const place = series[0].xs[this.at];
      Plot.upright(pen, x(place), box, INK.text, [3, 3]);
      for (const one of series) {
        const value = at(one, place);
        if (value === null || one.bars || (log && !(value > 0))) continue;
        pen.fillStyle = one.colour;
        pen.beginPath();
        pen.arc(x(place), y(value), 3.5, 0, 7);
        pen.fill();
      }
    }
    pen.restore();
    for (const limit of this.dragged && data.limits ? data.limits : []) {
      Plot.upright(pen, this.within(limit), box, INK.text, []);
      pen.fillStyle = INK.text;
      pen.fillRect(this.within(limit) - 3, box.b - 9, 6, 12);
    }
    if (series.length < 2) return;
    pen.textAlign = "right";
    pen.textBaseline = "top";
    series.filter((one) => !one.bars).forEach((one, i) => { pen.fillStyle = one.colour; pen.fillText(one.name, box.r - 6, box.y + 3 + 13 * i); });
  }

  axes(pen, box, { x, y, tens, columns, rows }, height) {
    const { data } = this;
    const text = ({ name, unit }, n) => { const inside = [n ? power(n) : "", unit].filter(Boolean).join(" "); return inside ? `${name} [${inside}]` : name; };
    pen.strokeStyle = INK.line;
    pen.lineWidth = 1;
    pen.strokeRect(Math.round(box.x) - 0.5, Math.round(box.y) - 0.5, Math.round(box.r - box.x) + 1, Math.round(box.b - box.y) + 1);
    pen.fillStyle = INK.faint;
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const [v, label] of columns) { pen.fillRect(Math.round(x(v)), box.b, 1, 4); pen.fillText(label, Math.min(Math.max(x(v), box.x + 4), box.r - 8), box.b + 5); }
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const [v, label] of rows) { pen.fillRect(box.x - 4, Math.round(y(v)), 4, 1); pen.fillText(label, box.x - 6, y(v)); }
    pen.textBaseline = "bottom";
    pen.fillText(fitted(pen, text(data.x, tens.x), box.r - box.x), box.r, height - 1);
    pen.save();
    pen.translate(9, (box.y + box.b) / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    const whole = text(data.y, tens.y), room = box.b + box.y - 6;
    pen.fillText(pen.measureText(whole).width > room ? fitted(pen, text({ ...data.y, name: "" }, tens.y).trim(), room) : whole, 0, 0);
    pen.restore();
  }

  /** The values at the mark, or how many are missing. */
  tell(up) {
    const { series, x, y, note, log } = this.data;
    if (this.held !== null) { this.out.textContent = `limits of the scale: ${this.data.limits.map((v) => reading(v, x.unit)).join(" to ")}${after(x.unit)}`; return; }
    if (!series.length) { this.out.textContent = note || ""; return; }
    if (this.at === null) {
      const all = series.reduce((sum, one) => sum + one.values.length, 0);
      const missing = log || series[0]?.bars ? 0 : series.reduce((sum, one) => sum + one.values.filter((v) => v === null).length, 0);
      this.out.textContent = !up ? "no value in any of them" : missing ? `${missing} of ${all} values ${missing === 1 ? "is" : "are"} missing: ${missing === 1 ? "a gap" : "gaps"}` : note || "";
      return;
    }
    const place = series[0].xs[this.at], print = log ? rate : (value) => reading(value, y.unit);
    const found = series.map((one) => at(one, place)), unit = found.every((value) => value === null) ? "" : after(y.unit);
    const values = found.map((value, i) => `${series.length > 1 ? series[i].name + " " : ""}${value === null ? "no value" : print(value)}`);
    this.out.textContent = `${x.name} ${digits(place, 5)}${after(x.unit)}: ${values.join(", ")}${unit}`;
  }

  static upright(pen, x, box, colour, dashes) {
    pen.strokeStyle = colour;
    pen.lineWidth = 1;
    pen.setLineDash(dashes);
    pen.beginPath();
    pen.moveTo(x, box.y);
    pen.lineTo(x, box.b);
    pen.stroke();
    pen.setLineDash([]);
  }

  /** A line with gaps where there is no value; a value between two gaps is a dot. */
  static line(pen, x, y, { xs, values, colour }, log) {
    pen.strokeStyle = pen.fillStyle = colour;
    pen.lineWidth = 1.4;
    pen.beginPath();
    const good = (v) => v !== null && v !== undefined && (!log || v > 0);
    values.forEach((v, i) => {
      if (!good(v)) return;
      if (good(values[i - 1])) pen.lineTo(x(xs[i]), y(v));
      else { pen.moveTo(x(xs[i]), y(v)); if (!good(values[i + 1])) pen.arc(x(xs[i]), y(v), 1.5, 0, 7); }
    });
    pen.stroke();
  }
}

/** The value of a series at a place of the first one. */
function at({ xs, values }, place) {
  let low = 0, high = xs.length - 1;
  while (low < high) { const middle = (low + high) >> 1; if (xs[middle] < place) low = middle + 1; else high = middle; }
  const near = low > 0 && Math.abs(xs[low - 1] - place) < Math.abs(xs[low] - place) ? low - 1 : low;
  return values[near] ?? null;
}
