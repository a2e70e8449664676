// The panels beside the picture: probe, threshold, region, files to save.
import { histogram, trace } from "./plots.js";
import { active, isGone, regionQuery, say, showing, state } from "./state.js";
import { $, bytes, digits, fill, json, latest, short } from "./tools.js";

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
      id: `probe-${v.name}`, label: short(v.label), unit: v.unit,
      values: found.map((f) => { const same = f.values.find((other) => other.name === v.name); return same ? same.value : null; }),
    }));
    if (first.azimuth_deg !== null) {
      rows.push({ id: "probe-azimuth", label: "azimuth", unit: "°", values: found.map((f) => f.azimuth_deg) });
      rows.push({ id: "probe-elevation", label: "elevation", unit: "°", values: found.map((f) => f.elevation_deg) });
    }
    if (first.objects.length) rows.push({ id: "probe-objects", label: "object", unit: "", values: [first.objects.join(", ")] });
    fill($("probe"), rows);
    $("probe").dataset.frame = first.frame;
  } catch (error) { say(error); }
});

let traced = null;

/** Course of the pixel clicked. */
export const follow = latest(async () => {
  $("trace-box").hidden = !state.pinned;
  if (!state.pinned) { traced = null; return; }
  const [column, row] = state.pinned;
  try {
    traced = await json(`/api/trace/${active()}/${state.frame}?row=${row}&column=${column}&layer=${encodeURIComponent($("layer").value)}&spread=${$("trace-spread").checked ? 1 : 0}`);
    const { frames } = traced;
    $("trace-spread-box").hidden = traced.whole;
    $("trace-where").textContent = `column ${column}, row ${row}: ${short(traced.label)}` + (traced.whole ? "" : `, ${frames.length} of the frames ${frames[0]} to ${frames[frames.length - 1]}`);
    $("trace").dataset.values = JSON.stringify(traced.values);
    retrace();
  } catch (error) { say(error); }
});

/** The same course with the frame's place moved; another part of it where the frame has left what is shown. */
export function retrace() {
  if (!traced || !state.pinned) return;
  const { frames } = traced, outside = state.frame < frames[0] || state.frame > frames[frames.length - 1];
  if (outside && !$("trace-spread").checked && !state.playing) { follow(); return; }
  trace($("trace"), traced, state.frame);
}

/** Pixels above the threshold, on the picture and as a rate. */
export async function threshold() {
  const pane = state.panes[state.active === "b" && state.b !== null ? "b" : "a"];
  if (!$("threshold-on").checked) {
    Object.values(state.panes).forEach((other) => other.setMask(null));
    $("threshold-table").replaceChildren();
    return;
  }
  const query = new URLSearchParams([["sigma", $("threshold").value], ["filter", $("threshold-filter").value], ["layer", $("layer").value], ...regionQuery()]);
  const found = await json(`/api/exceedances/${active()}/${state.frame}?${query}`);
  Object.values(state.panes).forEach((other) => other.setMask(other === pane ? bytes(found.mask) : null));
  const rows = [
    { id: "threshold-count", label: "pixels above", values: [found.exceedances], unit: `of ${found.pixels}` },
    { id: "threshold-rate", label: "false-alarm rate", values: [found.rate], unit: "per pixel" },
    { id: "threshold-gaussian", label: "Gaussian tail", values: [found.gaussian_rate], unit: "per pixel" },
    { id: "threshold-ratio", label: "ratio of the two", values: [found.ratio], unit: "" },
  ];
  if (found.value !== null) rows.push({ id: "threshold-level", label: "level", values: [found.value], unit: state.meta.a.layers.find((l) => l.name === $("layer").value)?.unit });
  fill($("threshold-table"), rows);
  $("threshold-table").dataset.frame = found.frame;
  $("threshold-table").dataset.sigma = found.threshold_sigma;
}

/** Statistics of the region of this frame. */
export const region = latest(async () => {
  const box = state.region;
  $("region-tools").hidden = $("histogram").hidden = !box;
  if (!box) { $("region").replaceChildren(); $("region-where").textContent = "drag one with Shift held"; return; }
  $("region-where").textContent = `${box.width} × ${box.height} px at column ${box.left}, row ${box.top}`;
  try {
    const query = new URLSearchParams([["layer", $("layer").value], ...regionQuery()]);
    const found = await json(`/api/region/${active()}/${state.frame}?${query}`);
    const { gamma, gaussian } = found.fits;
    fill($("region"), [
      { id: "region-pixels", label: "pixels", values: [found.pixels], unit: "" },
      { id: "region-mean", label: "mean", values: [found.mean], unit: found.unit },
      { id: "region-std", label: "standard deviation", values: [found.std], unit: found.unit },
      { id: "region-skewness", label: "skewness", values: [found.skewness], unit: "" },
      { id: "region-kurtosis", label: "excess kurtosis", values: [found.excess_kurtosis], unit: "" },
      { id: "region-minimum", label: "smallest", values: [found.minimum], unit: found.unit },
      { id: "region-maximum", label: "largest", values: [found.maximum], unit: found.unit },
      gamma.reason ? { id: "region-gamma", label: "gamma", values: ["no fit"], unit: "" } : { id: "region-gamma", label: "gamma: shape", values: [gamma.shape], unit: "" },
      ...(gamma.reason ? [] : [{ id: "region-gamma-scale", label: "gamma: scale", values: [gamma.scale], unit: found.unit }]),
    ]);
    $("region").dataset.frame = found.frame;
    $("region").title = gamma.reason || gaussian.reason || "";
    histogram($("histogram"), found);
  } catch (error) { say(error); }
});

/** What analyze tells of the region; asked for until it is there. */
async function analyse(all) {
  if (!state.region) return;
  $("analysis-save").hidden = true;
  $("analysis").textContent = "…";
  try {
    const query = new URLSearchParams([["layer", $("layer").value], ["all", all ? "1" : "0"], ...regionQuery()]);
    const { job } = await json(`/api/analysis/${active()}/${state.frame}?${query}`, { method: "POST" });
    for (;;) {
      const found = await json(`/api/analysis/${job}`);
      if (found.result) {
        const best = Object.entries(found.result.fits).filter(([, fit]) => fit.ks !== null).sort((x, y) => x[1].ks - y[1].ks)[0];
        const alarm = found.result.false_alarms[0];
        $("analysis").textContent = (best ? `nearest: ${best[0]} (KS ${digits(best[1].ks, 3)}); ` : "") + `> ${alarm.threshold_sigma} σ: ${digits(alarm.rate, 3)} per pixel. Save all:`;
        $("analysis").dataset.result = JSON.stringify(found.result);
        for (const kind of ["json", "csv"]) $(`save-${kind}`).href = `/api/analysis/${job}?save=${kind}`;
        $("analysis-save").hidden = false;
        return;
      }
      $("analysis").textContent = `${Math.round((100 * found.done) / Math.max(found.total, 1))} %`;
      await new Promise((done) => setTimeout(done, 250));
    }
  } catch (error) { $("analysis").textContent = error.message; }
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
async function save(event) {
  event.preventDefault();
  const link = event.currentTarget;
  try {
    const answer = await fetch(link.href);
    if (!answer.ok) throw new Error((await answer.json()).error);
    const name = /filename="([^"]+)"/.exec(answer.headers.get("content-disposition") || "")?.[1] || "frame";
    const made = document.createElement("a");
    made.href = URL.createObjectURL(await answer.blob());
    made.download = name;
    made.click();
    setTimeout(() => URL.revokeObjectURL(made.href), 10_000);
  } catch (error) { say(error); }
}

export function bindSide(redraw) {
  const again = latest(async () => { try { await threshold(); if (!isGone()) say(null); } catch (error) { say(error); } redraw(); });
  for (const id of ["threshold-on", "threshold-filter"]) $(id).addEventListener("change", again);
  $("threshold").addEventListener("input", () => {
    $("threshold-value").textContent = `${Number($("threshold").value).toFixed(2)} σ`;
    if (!$("threshold-on").checked) $("threshold-on").checked = true;
    again();
  });
  $("region-clear").addEventListener("click", () => { state.region = null; region(); again(); });
  $("analyse-frame").addEventListener("click", () => analyse(false));
  $("analyse-all").addEventListener("click", () => analyse(true));
  $("trace-spread").addEventListener("change", follow);
  $("trace-close").addEventListener("click", () => { state.pinned = null; follow(); redraw(); });
  for (const id of ["clip-first", "clip-last"]) $(id).addEventListener("change", files);
  for (const id of ["export-png", "export-npy", "export-tif", "export-clip", "save-json", "save-csv"]) $(id).addEventListener("click", save);
  return again;
}
