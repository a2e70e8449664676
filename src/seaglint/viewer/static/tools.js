// Small things that all parts of the page use.
export const $ = (id) => document.getElementById(id);

const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** A power of ten as it is printed. */
export const power = (n) => "10" + (n < 0 ? "⁻" : "") + [...String(Math.abs(n))].map((digit) => RAISED[digit]).join("");

/** Text of a number with the minus of print. */
export const minus = (text) => text.replace("-", "−");

/** A number with so many significant digits; very small and very large ones by a power of ten. */
export function digits(value, many = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value < 0) return minus(`-${digits(-value, many)}`);
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return scientific(value, many);
  if (Number.isInteger(value)) return String(value);
  return size >= 10 ** many ? value.toFixed(0) : String(Number(value.toPrecision(many)));
}

function scientific(value, many) {
  const [mantissa, exponent] = value.toExponential(many - 1).split("e");
  return `${Number(mantissa)} × ${power(Number(exponent))}`;
}

/** A rate per pixel: three digits, all rates below a tenth in one style. */
export const rate = (value) => (value === null || value === 0 || value >= 0.1 ? digits(value, 3) : scientific(value, 3));

/** A value of values that spread: digits down to a hundredth of their deviation. */
export function within(value, spread) {
  if (value === null || !(spread > 0) || Math.abs(value) >= 1e6 || (value !== 0 && Math.abs(value) < 1e-3)) return digits(value);
  return minus(value.toFixed(Math.min(Math.max(2 - Math.floor(Math.log10(spread)), 0), 7)));
}

/** A value as it is read off: hundredths of a degree, thousandths of a direction, five digits otherwise. */
export function reading(value, unit) {
  const decimals = { K: 2, "°C": 2, "°": 3 }[unit];
  return value === null || decimals === undefined ? digits(value, 5) : minus(value.toFixed(decimals));
}

/** A unit after a number. */
export const after = (unit) => (!unit ? "" : unit.includes("not known") ? ` (${unit})` : ` ${unit}`);

/** Ticks at round numbers between two ends. */
export function ticks(low, high, wanted) {
  const span = Math.abs(high - low);
  if (!(span > 0) || !Number.isFinite(span)) return [];
  const rough = span / Math.max(wanted, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((m) => m * power >= rough * 0.999);
  const found = [];
  for (let n = Math.ceil(Math.min(low, high) / step); n * step <= Math.max(low, high) + 1e-9 * step; n++) found.push(Number((n * step).toPrecision(12)));
  return found;
}

/** What a layer is, short enough for a panel. */
export const short = (label) => label.replace("in-band radiance at the aperture", "radiance").replace("in-band ", "").replace(/ of the line of sight.*| from the sensor to the sea.*|, mean over what.*/, "");

class Told extends Error {
  constructor(text, gone) { super(text); this.gone = gone; }
}

/** An answer of the viewer; its own words where it refuses. */
export async function ask(path, options = {}) {
  let answer;
  try {
    answer = await fetch(path, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Told("the viewer does not answer; is 'seaglint view' still running?", true);
  }
  if (answer.ok) return answer;
  let told = { error: `${answer.status} ${answer.statusText}` };
  try { told = await answer.json(); } catch { /* plain text */ }
  throw new Told(told.error, Boolean(told.gone));
}

export const json = async (path, options) => (await ask(path, options)).json();

export function bytes(base64) {
  const text = atob(base64);
  const out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) out[i] = text.charCodeAt(i);
  return out;
}

/** At most one request at a time; of those that come meanwhile the last. */
export function latest(work) {
  let busy = false, next = null;
  return async function run(...given) {
    if (busy) { next = given; return; }
    busy = true;
    try { await work(...given); } finally {
      busy = false;
      if (next) { const waiting = next; next = null; run(...waiting); }
    }
  };
}

/** A canvas with as many pixels as the screen gives it; coordinates are CSS pixels. */
export function sized(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  const w = Math.max(Math.round(width * ratio), 1), h = Math.max(Math.round(height * ratio), 1);
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { pen, width, height };
}

export const FONT = '11px system-ui, "DejaVu Sans", sans-serif';

/** Colours of the theme for canvases; those that lie on a picture are the same in every theme. */
export const INK = { onPicture: ["#f0b54a", "#7fc7ff", "#8fe08f", "#ff9ec7", "#c9a7ff", "#ffe66b"], series: [] };

/** Read the colours of the theme from the style. */
export function takeInk() {
  const sample = document.createElement("span");
  document.body.append(sample);
  const colour = (name) => { sample.style.color = `var(--${name})`; return getComputedStyle(sample).color; };
  for (const name of ["text", "faint", "line", "mark", "second", "ground", "bars", "now"]) INK[name] = colour(name);
  INK.series = INK.onPicture.map((_, i) => colour(`series-${i}`));
  sample.remove();
}

/** Text that fits into a width, cut where it must be. */
export function fitted(pen, text, width) {
  if (pen.measureText(text).width <= width) return text;
  let cut = text;
  while (cut && pen.measureText(cut + "…").width > width) cut = cut.slice(0, -1);
  return cut + "…";
}

/** Rows of a table: label, value(s), unit, with a test id and the exact number; `print` writes a number. */
export function fill(table, rows) {
  const body = document.createElement("tbody");
  for (const { id, label, values, unit, print = (value) => digits(value) } of rows) {
    const line = body.insertRow();
    line.insertCell().textContent = label;
    for (const value of values) {
      const cell = line.insertCell();
      cell.textContent = typeof value === "string" ? value : print(value, unit);
      if (typeof value === "number") cell.dataset.value = String(value);
      if (id) cell.dataset.testid = id;
    }
    const last = line.insertCell();
    last.className = "unit";
    last.textContent = values.every((value) => value === null) ? "" : after(unit).trim();
  }
  table.replaceChildren(body);
}

/** A job whose progress is told in a line if it lasts, with a button that cancels it. */
export class Work {
  constructor(out, button) {
    Object.assign(this, { out, button, number: null, cancelled: false });
    button.addEventListener("click", () => this.cancel());
  }

  /** End the job that runs; its request then fails with the word "cancelled". */
  cancel() {
    this.cancelled = true;
    if (this.number !== null) ask(`/api/job/${this.number}`, { method: "DELETE" }).catch(() => {});
  }

  /** The number of the job that a request starts, and its result. */
  async done(path, options = { method: "POST" }) {
    const began = performance.now();
    this.cancelled = false;
    this.out.textContent = "";
    try {
      const { job } = await json(path, options);
      this.number = job;
      if (this.cancelled) this.cancel();
      for (let pause = 10; ; pause = Math.min(2 * pause, 200)) {
        await new Promise((go) => setTimeout(go, pause));
        const found = await json(`/api/job/${job}`);
        if (found.result) return { job, result: found.result };
        if (performance.now() - began < 300) continue;
        this.out.textContent = `${Math.round((100 * found.done) / Math.max(found.total, 1))} %`;
        this.button.hidden = false;
      }
    } finally {
      this.number = null;
      this.button.hidden = true;
      this.out.textContent = "";
    }
  }
}

/** Offer bytes to be saved. */
export function offer(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Save an answer of the viewer under the name that it gives. */
export async function saved(path, options) {
  const answer = await ask(path, options);
  offer(await answer.blob(), /filename="([^"]+)"/.exec(answer.headers.get("content-disposition") || "")?.[1] || "file");
}
