// The panels beside the picture and the plots under it: probe, pixel in time, profile, threshold, files to save.
import { Plot } from "./plots.js";
import { active, body, isGone, messages, meta, region as chosen, say, showing, state } from "./state.js";
import { $, INK, Work, after, bytes, digits, fill, json, latest, rate, reading, saved, short } from "./tools.js";

export const plots = {};

/** Values under the pointer, of both sources. */
export const probe = latest(async () => {
  const where = state.pointer || state.probed || state.pinned; // the last pixel stays when the pointer leaves
  state.probed = where;
  if (!where || state.a === null) return;
  const [column, row] = where;
  const inside = (meta) => meta && column < meta.columns && row < meta.rows;
  const asked = [["a", state.a], ["b", state.b]].filter(([name, id]) => id !== null && inside(state.meta[name]));
  if (!asked.length) return;
  try {
    const found = await Promise.all(asked.map(([, id]) => json(`/api/probe/${id}/${state.frame}?row=${row}&column=${column}`)));
    const first = found[0];
    $("probe-where").textContent = `column ${column}, row ${row}` + (found.length > 1 ? " (A, B)" : "");
    const rows = first.values.map((v) => ({
      id: `probe-${v.name}`, label: short(v.label), unit: v.unit, print: reading,
      values: found.map((f) => { const same = f.values.find((other) => other.name === v.name); return same ? same.value : null; }),
    }));
    if (first.azimuth_deg !== null) {
      rows.push({ id: "probe-azimuth", label: "azimuth", unit: "°", print: reading, values: found.map((f) => f.azimuth_deg) });
      rows.push({ id: "probe-elevation", label: "elevation", unit: "°", print: reading, values: found.map((f) => f.elevation_deg) });
    }
    if (first.objects.length) rows.push({ id: "probe-objects", label: "object", unit: "", values: [first.objects.join(", ")] });
    fill($("probe"), rows);
    $("probe").dataset.frame = first.frame;
    const shown = first.values.find((v) => v.name === $("layer").value);
    $("probe-line").textContent = `column ${column}, row ${row}: ${!shown ? "–" : shown.value === null ? "no value" : reading(shown.value, shown.unit) + after(shown.unit)}`;
  } catch (error) { say(error); }
});

let traced = null, tracing = null;

/** Course of the pixel clicked; a course that is still being read is given up for it. */
export function follow() { tracing.cancel(); return trace(); }

const trace = latest(async () => {
  traced = null;
  $("trace-box").hidden = !state.pinned;
  if (!state.pinned) return;
  const [column, row] = state.pinned, query = new URLSearchParams({ row, column, layer: $("layer").value }), source = active();
  $("trace-where").textContent = `column ${column}, row ${row}`;
  plots.trace.set({ series: [], x: {}, y: {}, note: "reading all frames" });
  try {
    traced = (await tracing.done(`/api/trace/${source}?${query}`)).result;
    $("trace-where").textContent = `column ${column}, row ${row}: ${short(traced.label)}`;
    $("trace").dataset.values = JSON.stringify(traced.values);
    retrace();
  } catch (error) {
    if (error.message !== "cancelled") say(error);
    else plots.trace.set({ series: [], x: {}, y: {}, note: "cancelled; click a pixel to read it" });
  }
});

/** The x of a course and the place of the frame shown in it. */
export function course({ frames, times_s: times }) {
  const place = frames.findIndex((one) => one >= state.frame);
  return { xs: times || frames, x: times ? { name: "time", unit: "s" } : { name: "frame", unit: "" }, now: place < 0 ? null : (times || frames)[place] };
}

/** The same course with the frame's place moved; read again where the frame was written later. */
export function retrace() {
  if (!traced || !state.pinned) return;
  const { frames } = traced;
  if (state.frame > frames[frames.length - 1] && frames.length < meta().done && !state.playing) { follow(); return; }
  const { xs, x, now } = course(traced);
  plots.trace.frames = frames;
  plots.trace.set({ series: [{ name: "pixel", colour: INK.mark, xs, values: traced.values }], x, y: { name: short(traced.label), unit: traced.unit }, now });
}

/** Values along the line. */
export const profile = latest(async () => {
  $("profile-box").hidden = !state.line;
  if (!state.line) return;
  const [column, row, toColumn, toRow] = state.line;
  try {
    const query = new URLSearchParams({ layer: $("layer").value, column, row, to_column: toColumn, to_row: toRow });
    const found = await json(`/api/profile/${active()}/${state.frame}?${query}`);
    $("profile-where").textContent = `column ${column}, row ${row} to column ${toColumn}, row ${toRow}: ${short(found.label)}`;
    $("profile").dataset.values = JSON.stringify(found.values);
    plots.profile.set({ series: [{ name: "profile", colour: INK.mark, xs: found.distance_px, values: found.values }], x: { name: "distance", unit: "px" }, y: { name: short(found.label), unit: found.unit } });
  } catch (error) { say(error); }
});

/** Pixels above the threshold, on the picture and as a rate. */
export async function threshold() {
  const pane = state.panes[state.active === "b" && state.b !== null ? "b" : "a"];
  const nothing = () => {
    Object.values(state.panes).forEach((other) => other.setMask(null));
    $("threshold-table").replaceChildren();
    $("threshold-plot-box").hidden = true;
  };
  if (!$("threshold-on").checked) { nothing(); return; }
  const query = new URLSearchParams([["sigma", $("threshold").value], ["filter", $("threshold-filter").value], ["layer", $("layer").value]]);
  let found;
  try { found = await json(`/api/exceedances/${active()}/${state.frame}?${query}`, chosen() ? body([chosen()]) : { method: "POST" }); } catch (error) {
    if (error.gone || error.name === "AbortError") throw error;
    nothing();
    fill($("threshold-table"), [{ label: error.message, values: [] }]);
    return;
  }
  Object.values(state.panes).forEach((other) => other.setMask(other === pane ? bytes(found.mask) : null));
  const rows = [
    { id: "threshold-count", label: "pixels above", values: [found.exceedances], unit: `of ${found.pixels}` },
    { id: "threshold-rate", label: "false-alarm rate", values: [found.rate], unit: "per pixel", print: rate },
    { id: "threshold-gaussian", label: "Gaussian tail", values: [found.gaussian_rate], unit: "per pixel", print: rate },
    { id: "threshold-ratio", label: "ratio of the two", values: [found.ratio], unit: "", print: (value) => digits(value, 3) },
  ];
  if (found.value !== null) rows.push({ id: "threshold-level", label: "level", values: [found.value], unit: state.meta.a.layers.find((l) => l.name === $("layer").value)?.unit, print: reading });
  fill($("threshold-table"), rows);
  $("threshold-table").dataset.frame = found.frame;
  $("threshold-table").dataset.sigma = found.threshold_sigma;
  const { sigma, rate: rates, gaussian } = found.curve;
  $("threshold-plot-box").hidden = false;
  plots.threshold.set({
    series: [{ name: "measured", colour: INK.mark, xs: sigma, values: rates }, { name: "Gaussian", colour: INK.second, xs: sigma, values: gaussian.map((v) => (v > 1e-9 ? v : null)) }],
    x: { name: "threshold", unit: "σ" }, y: { name: "rate", unit: "per pixel" }, log: true, now: found.threshold_sigma,
  });
}

/** Addresses of what can be saved, as it is seen now. */
export function files() {
  if (state.a === null) return;
  const query = showing(state.active === "d");
  query.set("colours", $("colours").value);
  for (const kind of ["png", "npy", "tif"]) $(`export-${kind}`).href = `/api/export/frame/${active()}/${state.frame}/${kind}?${query}`;
  query.set("first", $("clip-first").value || "0");
  query.set("last", $("clip-last").value || String(state.frame));
  $("export-clip").href = `/api/export/clip/${active()}?${query}`;
}

/** A refusal is told instead of replacing the page. */
function save(event) {
  event.preventDefault();
  saved(event.currentTarget.href).catch(say);
}

/** Bind the panels; gives the function that counts pixels above the threshold again. */
export function bindSide(redraw, goTo) {
  const again = latest(async () => { const before = messages(); try { await threshold(); if (!isGone() && messages() === before) say(null); } catch (error) { say(error); } redraw(); });
  const above = (sigma) => {
    $("threshold").value = sigma;
    $("threshold-value").textContent = `${Number($("threshold").value).toFixed(2)} σ`;
    $("threshold-on").checked = true;
    again();
  };
  plots.trace = new Plot($("trace"), $("trace-read"), { picked: (x, at) => goTo(plots.trace.frames[at]) });
  tracing = new Work($("trace-progress"), $("trace-cancel"));
  plots.profile = new Plot($("profile"), $("profile-read"));
  plots.threshold = new Plot($("threshold-plot"), $("threshold-read"), { picked: above });
  for (const id of ["threshold-on", "threshold-filter"]) $(id).addEventListener("change", again);
  $("threshold").addEventListener("input", () => above($("threshold").value));
  $("trace-close").addEventListener("click", () => { state.pinned = null; follow(); redraw(); });
  $("profile-close").addEventListener("click", () => { state.line = null; profile(); redraw(); });
  for (const id of ["clip-first", "clip-last"]) $(id).addEventListener("change", files);
  for (const id of ["export-png", "export-npy", "export-tif", "export-clip", "save-json", "save-csv"]) $(id).addEventListener("click", save);
  return again;
}
