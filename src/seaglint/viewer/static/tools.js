// Small things that all parts of the page use.
export const $ = (id) => document.getElementById(id);

/** Numbers with as many digits as a person reads; more where their level asks for it. */
export function digits(value, many = 5) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e7)) return value.toExponential(Math.max(many - 2, 1)).replace("e", " e");
  return String(Number(value.toPrecision(many)));
}

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

export class Told extends Error {
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

export const INK = { text: "#dfe3e6", faint: "#98a2aa", line: "#343b41", mark: "#f0b54a", second: "#7fc7ff", ground: "#15181b" };
export const FONT = '11px system-ui, "DejaVu Sans", sans-serif';

/** Rows of a table: [label, value(s)..., unit], with a test id and the exact number. */
export function fill(table, rows) {
  const body = document.createElement("tbody");
  for (const { id, label, values, unit } of rows) {
    const line = body.insertRow();
    line.insertCell().textContent = label;
    for (const value of values) {
      const cell = line.insertCell();
      cell.textContent = typeof value === "string" ? value : digits(value, 6);
      if (typeof value === "number") cell.dataset.value = String(value);
      if (id) cell.dataset.testid = id;
    }
    const last = line.insertCell();
    last.className = "unit";
    last.textContent = unit || "";
  }
  table.replaceChildren(body);
}
