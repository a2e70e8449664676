// Regions: their list, the histogram of the chosen one, courses of their means, and their files.
import { Plot } from "./plots.js";
import { course, plots } from "./side.js";
import { grown, moved } from "./shapes.js";
import { active, body, colourOf, meta, region as chosen, say, scaleEnds, state } from "./state.js";
import { $, INK, Work, digits, fill, json, latest, saved, short, within } from "./tools.js";

const layerQuery = () => `layer=${encodeURIComponent($("layer").value)}`;

/** Add a region, and choose it. */
export function add(shape, numbers, name = "") {
  const used = new Set(state.regions.map((one) => one.name));
  let free = 1;
  while (used.has(String(free))) free++;
  state.regions.push({ shape, numbers, name: name || String(free) });
  state.chosen = state.regions.length - 1;
}

/** Give a region other numbers; the means over all frames are no longer its own. */
export function reshape(index, numbers) { state.regions[index].numbers = numbers; forget(); }

const numbersOf = (text) => { const [shape, ...words] = text.split(" "); return [shape, words.map(Number)]; };

/** Take regions from their texts and names. */
export function take(list) { for (const [text, name] of list) add(...numbersOf(text), name); }

/** What a region is, in words. */
function words({ shape, numbers }) {
  const [left, top, width, height] = numbers;
  return shape === "polygon" ? `polygon of ${numbers.length / 2} corners` : `${shape} of ${digits(width)} × ${digits(height)} px at column ${digits(left)}, row ${digits(top)}`;
}

/** Statistics of all regions of this frame, and the histogram of the chosen one. */
export const region = latest(async () => {
  const one = chosen();
  $("region-tools").hidden = !one;
  $("regions").hidden = !state.regions.length;
  $("courses-box").hidden = !courses;
  if (!one) { $("histogram-box").hidden = true; $("region").replaceChildren(); $("regions").replaceChildren(); $("region-where").textContent = "draw one: choose a shape above, or drag with Shift"; return; }
  $("region-where").textContent = words(one);
  try {
    const where = `${active()}/${state.frame}`;
    const [all, found] = await Promise.all([
      json(`/api/regions/${where}?${layerQuery()}`, body()),
      json(`/api/region/${where}?${layerQuery()}`, body([one])).catch((error) => ({ reason: error.message })),
    ]);
    list(all);
    details(found);
  } catch (error) { say(error); }
});

function list({ regions, unit, frame }) {
  const table = document.createElement("tbody"), head = table.insertRow();
  for (const text of ["", unit ? `mean\n[${unit.replaceAll(" ", "\u00a0")}]` : "mean", "deviation", "pixels", ""]) head.insertCell().textContent = text;
  regions.forEach((found, number) => {
    if (!state.regions[number]) return;
    const row = table.insertRow(), name = document.createElement("button"), gone = document.createElement("button"), swatch = document.createElement("i");
    swatch.style.background = colourOf(number, INK.onPicture);
    name.append(swatch, state.regions[number].name);
    name.setAttribute("aria-pressed", String(number === state.chosen));
    name.dataset.testid = "region-choose";
    name.title = `${words(state.regions[number])}; arrow keys move it, with Shift they resize it, Delete removes it`;
    name.addEventListener("click", () => { state.chosen = number; changed(); });
    name.addEventListener("keydown", (event) => key(event, number));
    row.insertCell().append(name);
    if (found.reason) {
      const cell = row.insertCell();
      cell.colSpan = 3;
      cell.className = "reason";
      cell.textContent = found.reason;
    } else {
      for (const [key, text] of [["mean", within(found.mean, found.std)], ["std", digits(found.std, 3)], ["values", String(found.values)]]) {
        const cell = row.insertCell();
        cell.textContent = text;
        cell.dataset.value = String(found[key]);
        cell.dataset.testid = `regions-${key}`;
      }
    }
    gone.textContent = "×";
    gone.setAttribute("aria-label", `remove region ${state.regions[number].name}`);
    gone.dataset.testid = "region-remove";
    gone.addEventListener("click", () => remove(number));
    row.insertCell().append(gone);
  });
  // The focus stays at the button that has it.
  const buttons = (place) => [...place.querySelectorAll("button")], focused = buttons($("regions")).indexOf(document.activeElement);
  $("regions").replaceChildren(table);
  buttons(table)[focused]?.focus();
  $("regions").dataset.frame = frame;
}

function remove(number) {
  state.regions.splice(number, 1);
  state.chosen = Math.min(state.chosen, state.regions.length - 1);
  forget();
  changed();
}

const later = latest(async () => { await new Promise((go) => setTimeout(go, 60)); changed(); });

/** Keys at the name of a region. */
function key(event, number) {
  if (event.key === "Delete") { event.preventDefault(); remove(number); return; }
  const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
  if (!by || event.metaKey || event.altKey) return;
  event.preventDefault();
  const one = state.regions[number], step = by.map((v) => (event.ctrlKey ? 10 : 1) * v);
  state.chosen = number;
  reshape(number, (event.shiftKey ? grown : moved)(one, step, meta()));
  drawn();
  later();
}

function details(found) {
  $("histogram-box").hidden = Boolean(found.reason);
  if (found.reason) {
    $("region").replaceChildren();
    $("region-where").textContent = found.reason;
    return;
  }
  const { gamma, gaussian } = found.fits, value = (v) => within(v, found.std), three = (v) => digits(v, 3);
  fill($("region"), [
    { id: "region-pixels", label: "pixels", values: [found.pixels], unit: "" },
    { id: "region-mean", label: "mean", values: [found.mean], unit: found.unit, print: value },
    { id: "region-std", label: "standard deviation", values: [found.std], unit: found.spread_unit, print: three },
    { id: "region-minimum", label: "smallest", values: [found.minimum], unit: found.unit, print: value },
    { id: "region-maximum", label: "largest", values: [found.maximum], unit: found.unit, print: value },
    { id: "region-skewness", label: "skewness", values: [found.skewness], unit: "", print: three },
    { id: "region-kurtosis", label: "excess kurtosis", values: [found.excess_kurtosis], unit: "", print: three },
    gamma.reason ? { id: "region-gamma", label: "gamma", values: ["no fit"], unit: "" } : { id: "region-gamma", label: "gamma: shape", values: [gamma.shape], unit: "", print: three },
    ...(gamma.reason ? [] : [{ id: "region-gamma-scale", label: "gamma: scale", values: [gamma.scale], unit: found.spread_unit, print: three }]),
    ...(found.fits_unit === "K" && found.unit !== "K" ? [{ id: "region-fits", label: "fits: in kelvin", values: [] }] : []),
  ]);
  $("region").dataset.frame = found.frame;
  $("region").title = gamma.reason || gaussian.reason || "";
  const { edges, density, at } = found.histogram;
  const fits = [["gamma", INK.mark], ["gaussian", INK.second]].filter(([name]) => found.fits[name].density);
  plots.histogram.set({
    series: [
      { name: "density", bars: true, colour: INK.bars, edges, xs: density.map((_, i) => (edges[i] + edges[i + 1]) / 2), values: density },
      ...fits.map(([name, colour]) => ({ name: name === "gamma" ? "gamma" : "Gaussian", colour, xs: at, values: found.fits[name].density })),
    ],
    x: { name: short(found.label), unit: found.unit }, y: { name: "density", unit: !found.spread_unit ? "" : found.spread_unit.includes(" ") ? `1/(${found.spread_unit})` : `1/${found.spread_unit}` },
    limits: scaleEnds(), note: "point at it, or use the arrow keys, to read values; drag the limits of the scale",
  });
}

let courses = null, means = null, analysis = null;

/** Means of all regions in all frames. */
async function follow() {
  if (!state.regions.length) return;
  const names = state.regions.map((one) => one.name);
  $("courses-run").disabled = true;
  try {
    const { result } = await means.done(`/api/courses/${active()}?${layerQuery()}`, body());
    courses = { ...result, names };
    $("courses").dataset.means = JSON.stringify(result.means);
    recourse();
    const without = names.filter((_, i) => result.left_out[i]);
    if (without.length) $("courses-progress").textContent = `left out, outside the picture: ${without.join(", ")}`;
  } catch (error) { $("courses-progress").textContent = error.message; }
  $("courses-run").disabled = false;
}

/** The courses again, with the place of the frame shown. */
export function recourse() {
  $("courses-box").hidden = !courses;
  if (!courses) return;
  $("courses-where").textContent = `means of ${short(courses.label)}`;
  const { xs, x, now } = course(courses);
  plots.courses.set({
    series: courses.means.map((values, i) => ({ name: courses.names[i], colour: colourOf(i, INK.series), xs, values })).filter((_, i) => !courses.left_out[i]),
    x, y: { name: `mean of ${short(courses.label)}`, unit: courses.unit }, now,
  });
}

/** Courses and analyses of another layer, source or shape are not those shown. */
export function forget() {
  courses = null;
  recourse();
  $("courses-progress").textContent = "";
  $("analysis").textContent = "";
  $("analysis-save").hidden = true;
}

/** A temperature displayed in degrees Celsius is analysed in kelvin. */
const inKelvin = (units) => (units === "K" && meta().layers.find((layer) => layer.name === $("layer").value)?.unit !== "K" ? "All in kelvin. " : "");

/** What analyze tells of the region; asked for until it is there. */
async function analyse(all) {
  if (!chosen()) return;
  $("analysis-save").hidden = true;
  try {
    const { job, result } = await analysis.done(`/api/analysis/${active()}/${state.frame}?${layerQuery()}&all=${all ? 1 : 0}`, body([chosen()]));
    const best = Object.entries(result.fits).filter(([, fit]) => fit.ks !== null).sort((x, y) => x[1].ks - y[1].ks)[0];
    const alarm = result.false_alarms[0];
    $("analysis").textContent = (all ? "all frames: " : `frame ${result.frame}: `) + (best ? `nearest distribution: ${best[0]} (Kolmogorov-Smirnov distance ${digits(best[1].ks, 3)}); ` : "") + `above ${alarm.threshold_sigma} σ: ${digits(alarm.rate, 3)} per pixel. ${inKelvin(result.units)}Save all:`;
    $("analysis").dataset.result = JSON.stringify(result);
    for (const kind of ["json", "csv"]) $(`save-${kind}`).href = `/api/job/${job}?save=${kind}`;
    $("analysis-save").hidden = false;
  } catch (error) { $("analysis").textContent = error.message; }
}

let changed = () => {}, drawn = () => {};

/** Bind the panel. `page` has redraw, recount (the threshold), goTo (a frame) and limits (ends of the scale). */
export function bindRegions(page) {
  drawn = page.redraw;
  changed = () => { region(); drawn(); page.recount(); };
  means = new Work($("courses-progress"), $("courses-cancel"));
  analysis = new Work($("analysis"), $("analysis-cancel"));
  plots.histogram = new Plot($("histogram"), $("histogram-read"), { dragged: page.limits });
  plots.courses = new Plot($("courses"), $("courses-read"), { picked: (x, at) => page.goTo(courses.frames[at]) });
  $("region-clear").addEventListener("click", () => { state.regions = []; state.chosen = -1; forget(); changed(); });
  $("analyse-frame").addEventListener("click", () => analyse(false));
  $("analyse-all").addEventListener("click", () => analyse(true));
  $("courses-run").addEventListener("click", follow);
  $("courses-close").addEventListener("click", forget);
  for (const kind of ["csv", "imagej"]) $(`regions-${kind}`).addEventListener("click", () => saved(`/api/save/regions/${kind}`, body()).catch(say));
  $("regions-load").addEventListener("change", async () => {
    const [file] = $("regions-load").files;
    if (!file) return;
    try { take((await json(`/api/load/regions?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file })).regions); forget(); changed(); say(null); } catch (error) { say(error); }
    $("regions-load").value = "";
  });
  return changed;
}
