// What is seen as text: behind the # of the address, to be sent as a link, or in a file.
import { camera } from "./pane.js";
import { take } from "./regions.js";
import { say, state, textOf } from "./state.js";
import { $, offer } from "./tools.js";

const CHOICES = ["layer", "scaling", "low", "high", "fixed", "colours", "overlay", "opacity"];
const CHECKS = ["difference", "truth", "threshold-on"];
const numbers = (text, many) => { const list = (text || "").split(" ").map(Number); return list.length === many && list.every(Number.isFinite) ? list : null; };
const named = (number) => state.session.sources.find(({ id }) => id === number)?.name ?? "";

/** The state as it is written behind the #. */
export function fragment() {
  if (state.a === null) return "";
  const out = new URLSearchParams({ a: named(state.a) });
  if (state.b !== null) out.set("b", named(state.b));
  out.set("frame", state.frame);
  for (const id of CHOICES) if ($(id).value !== "" && !(["low", "high"].includes(id) && $("scaling").value !== "limits") && !(id === "opacity" && !$("overlay").value)) out.set(id, $(id).value);
  for (const id of CHECKS) if ($(id).checked) out.set(id, "1");
  if ($("threshold-on").checked) { out.set("threshold", $("threshold").value); out.set("threshold-filter", $("threshold-filter").value); }
  if (camera.zoom !== 1) out.set("view", [camera.x.toFixed(4), camera.y.toFixed(4), camera.zoom.toFixed(3)].join(" "));
  if (state.pinned) out.set("pixel", state.pinned.join(" "));
  if (state.line) out.set("line", state.line.join(" "));
  for (const one of state.regions) out.append("region", `${textOf(one)}|${one.name}`);
  if (state.chosen > 0) out.set("chosen", state.chosen);
  return out.toString();
}

/**
 * Show a state; throw what of it cannot be shown. `page` has what it needs of the page: open, overTime, settle.
 */
export async function restore(text, page) {
  const given = new URLSearchParams(text);
  for (const side of ["a", "b"]) {
    const name = given.get(side);
    const found = name && state.session.sources.find((one) => one.name === name);
    if (name && !found) throw new Error(`${name}: is not among the files of this viewer; start 'seaglint view' with it`);
    if (found || side === "b") $(`source-${side}`).value = found ? String(found.id) : "";
  }
  $("difference").checked = given.get("difference") === "1";
  if (!(await page.open(Number(given.get("frame")) || 0))) return;
  const layer = given.get("layer") || "";
  const computed = new RegExp(`^(.+)_(${state.session.over_time.join("|")})$`).exec(layer);
  if (computed && ![...$("layer").options].some(({ value }) => value === layer)) await page.overTime(computed[1]);
  let problem = null;
  for (const id of [...CHOICES, "threshold", "threshold-filter"]) {
    const value = given.get(id);
    if (value === null) continue;
    if ($(id).tagName !== "SELECT" || [...$(id).options].some((option) => option.value === value)) $(id).value = value;
    else problem = new Error(`${id} = ${value}: is not among the choices; the rest of the state is shown`);
  }
  for (const id of CHECKS) $(id).checked = given.get(id) === "1";
  const { rows, columns } = state.meta.a, inside = (list) => list && list.every((v, i) => v >= 0 && v < (i % 2 ? rows : columns)) ? list : null;
  state.pinned = inside(numbers(given.get("pixel"), 2));
  state.line = inside(numbers(given.get("line"), 4));
  state.probed = state.pinned;
  state.regions = [];
  state.chosen = -1;
  const regions = given.getAll("region").map((one) => { const cut = one.indexOf("|"); return cut < 0 ? [one, ""] : [one.slice(0, cut), one.slice(cut + 1)]; });
  take(regions.filter(([one]) => /^(rectangle|ellipse|polygon)( -?[\d.]+){4,}$/.test(one)));
  state.chosen = Math.min(Number(given.get("chosen")) || 0, state.regions.length - 1);
  const view = numbers(given.get("view"), 3) || [0.5, 0.5, 1];
  Object.assign(camera, { x: view[0], y: view[1], zoom: Math.min(Math.max(view[2], 1), 200) });
  await page.settle();
  if (problem) throw problem;
}

export function bindLink(page) {
  const write = () => { const text = fragment(); if (!state.playing && text && location.hash.slice(1) !== text) history.replaceState(null, "", `#${text}`); };
  setInterval(write, 700);
  window.addEventListener("hashchange", () => restore(location.hash.slice(1), page).catch(say));
  $("copy-link").addEventListener("click", async () => {
    write();
    try { await navigator.clipboard.writeText(location.href); $("link-told").textContent = "copied"; } catch { $("link-told").textContent = "copy the address of this page: it is the link"; }
    setTimeout(() => { $("link-told").textContent = ""; }, 4000);
  });
  $("save-state").addEventListener("click", () => offer(new Blob([JSON.stringify({ "seaglint view": fragment() }, null, 2)], { type: "application/json" }), "view.json"));
  $("load-state").addEventListener("change", async () => {
    const [file] = $("load-state").files;
    if (!file) return;
    let text = null;
    try { text = JSON.parse(await file.text())["seaglint view"]; } catch { /* told below */ }
    if (typeof text === "string") await restore(text, page).catch(say);
    else say(new Error(`${file.name}: is no state of this viewer; give a file that 'Save state' wrote`));
    $("load-state").value = "";
  });
}
