// The page of sequences: what is shown, playing it, and what buttons and keys do.
import { bindLink, fragment, restore } from "./link.js";
import { Pane, camera, diverging, tableOf } from "./pane.js";
import { TOOLS, choose, pointers } from "./pointers.js";
import { bindRegions, forget, recourse, region } from "./regions.js";
import { bindSide, files, follow, plots, probe, profile, retrace, threshold } from "./side.js";
import { isGone, layerText, messages, say, showing, state } from "./state.js";
import { $, Work, ask, bytes, digits, json, latest, rate as rateText, reading, short, takeInk, within } from "./tools.js";

const DIFFERENCE = diverging();
const USUAL_RATE = 25;
let shown = 0, since = performance.now();

const rate = () => state.meta.a.frame_rate_hz || USUAL_RATE;
const names = () => ["a", ...(state.b === null ? [] : ["b", ...($("difference").checked ? ["d"] : [])])];
const first = () => state.meta.a.first ?? 0;
const last = () => Math.min(state.meta.a.last ?? 0, state.b === null ? Infinity : state.meta.b.last ?? 0);

/** Draw all panes again from what they hold. */
function redraw() {
  const { regions, chosen, draft, line, pointer, pinned } = state, opacity = Number($("opacity").value);
  for (const [name, pane] of Object.entries(state.panes)) {
    const meta = name === "b" ? state.meta.b : state.meta.a;
    const title = name === "d" ? "A − B" : `${state.b === null ? "" : name.toUpperCase() + "  "}${meta.name}${meta.title ? ": " + meta.title : ""}`;
    const layer = name === "d" ? `difference of ${layerText()}` : layerText();
    // Over a whole picture a finger scrolls the page.
    pane.canvas.style.touchAction = camera.zoom === 1 && state.tool === "pan" ? "pan-y" : "none";
    pane.draw({ title, layer, regions, chosen, grips: state.tool === "pan", draft, line, pointer, pinned, opacity });
  }
}

/** One pane's picture of a frame, with all that lies over it. */
async function fetchPane(name, frame) {
  const id = name === "b" ? state.b : state.a;
  const base = `/api/frame/${id}/${frame}?`;
  const over = name === "d" ? "" : $("overlay").value;
  const jobs = [ask(base + showing(name === "d"))];
  jobs.push(over ? ask(base + new URLSearchParams({ layer: over, scaling: "percentile" })) : null);
  jobs.push($("truth").checked && name !== "d" && state.meta[name].truth ? json(`/api/truth/${id}/${frame}`) : null);
  const [picture, above, truth] = await Promise.all(jobs);
  return {
    name,
    levels: new Uint8Array(await picture.arrayBuffer()),
    scale: JSON.parse(picture.headers.get("seaglint-scale")),
    above: above ? new Uint8Array(await above.arrayBuffer()) : null,
    boxes: truth ? truth.boxes : [],
  };
}

/** Show a frame in all panes; they change together. A difference that cannot be is told, and the two are shown. */
async function show(frame) {
  let refused = null;
  const part = (name) => (name === "d" ? fetchPane(name, frame).catch((error) => { refused = error; return null; }) : fetchPane(name, frame));
  const found = (await Promise.all(names().map(part))).filter((one) => one !== null);
  state.frame = frame;
  for (const { name, levels, scale, above, boxes } of found) {
    const pane = state.panes[name];
    if (!pane) continue;
    pane.setLevels(levels, name === "d" ? DIFFERENCE : state.tables[$("colours").value], scale);
    pane.setAbove(above, state.tables.perceptual);
    pane.boxes = boxes;
  }
  if ($("threshold-on").checked) await threshold();
  redraw();
  readouts();
  count();
  if (refused) say(refused);
  return refused;
}

const goTo = latest(async (frame) => {
  if (state.a === null || state.meta.a.first === null) return;
  const before = messages();
  try {
    const refused = await show(Math.min(Math.max(frame, first()), last()));
    if (!refused && !isGone() && messages() === before) say(null);
  } catch (error) { say(error); pause(); }
  aside();
});

/** What follows the frame. */
function aside() { probe(); retrace(); recourse(); if (state.line) profile(); if (state.regions.length) region(); files(); }

function readouts() {
  const { frames, done, start_s: start } = state.meta.a;
  $("scrub").value = state.frame;
  const cut = state.b !== null && last() < (state.meta.a.last ?? 0) ? `, B ends at ${last()}` : "";
  $("frame-number").textContent = `frame ${state.frame} / ${frames - 1}${cut}`;
  $("frame-number").dataset.frame = state.frame;
  const rateKnown = state.meta.a.frame_rate_hz;
  $("time").textContent = rateKnown ? `${((start || 0) + state.frame / rateKnown).toFixed(2)} s` : "";
  if (done < frames) $("rate").textContent = `${done} written`;
}

/** Frames a second that are drawn. */
function count() {
  shown++;
  const now = performance.now();
  if (now - since < 1000) return;
  const perSecond = (1000 * shown) / (now - since);
  if (state.playing) { $("rate").textContent = `${perSecond.toFixed(0)} fps`; $("rate").dataset.fps = perSecond; }
  shown = 0;
  since = now;
}

/** Play by the clock: a frame is asked for when the one before is drawn, and those that would be late are left out. */
async function play() {
  if (state.playing || state.a === null || last() <= first()) return;
  state.playing = true;
  $("play").textContent = "❚❚";
  let began = performance.now(), from = state.frame >= last() ? first() : state.frame;
  shown = 0;
  since = began;
  if (from !== state.frame) await show(from).catch(say);
  while (state.playing) {
    const due = from + Math.floor(((performance.now() - began) * rate() * Number($("speed").value)) / 1000);
    if (due === state.frame) { await new Promise((go) => setTimeout(go, 2)); continue; }
    if (due > last()) {
      if (last() <= first()) break;
      from = first() - 1;
      began = performance.now();
      state.frame = from;
      continue;
    }
    try { await show(due); } catch (error) { say(error); break; }
    aside();
    await new Promise((go) => requestAnimationFrame(go));
  }
  pause();
}

function pause() {
  if (!state.playing) return;
  state.playing = false;
  $("play").textContent = "▶";
  if (state.frame < first()) state.frame = first();
  aside();
}

const step = (by) => { pause(); goTo(state.frame + by); };

/** Options of a select that stay chosen where they still are there. */
function options(select, list, keep = select.value) {
  select.replaceChildren(...list.map(([value, text]) => new Option(text, value)));
  if (list.some(([value]) => value === keep)) select.value = keep;
}

/** Open what is chosen as A and B; true where something is shown. */
async function open(frame = state.frame) {
  pause();
  const [a, b] = ["source-a", "source-b"].map((id) => ($(id).value === "" ? null : Number($(id).value)));
  if (a === null) { say(new Error("choose a sequence, a map or a recording")); return false; }
  try {
    const metaA = await json(`/api/source/${a}`), metaB = b === null ? null : await json(`/api/source/${b}`);
    Object.assign(state, { a, b, meta: { a: metaA, b: metaB }, frame, regions: [], chosen: -1, draft: [], line: null, pinned: null, pointer: null, probed: null });
    choose(state.tool);
    $("difference-box").hidden = b === null;
    if (b === null) $("difference").checked = false;
    arrange();
    layers();
    $("truth-box").hidden = !metaA.truth;
    const [rateA, rateB] = [metaA, metaB].map((meta) => meta && meta.frame_rate_hz);
    const apart = rateA && rateB && Math.abs(rateA - rateB) > 1e-3 * rateA ? [`A at ${digits(rateA, 4)} Hz, B at ${digits(rateB, 4)} Hz: beside each other by the frame's number`] : [];
    $("title").textContent = [...metaA.notes, ...apart].join("; ");
    limits();
    forget();
    region();
    profile();
    follow();
    if (metaA.first === null) { say(new Error(`${metaA.name}: no frame is written yet; it is shown as soon as there is one`)); return true; }
    say(null);
    await goTo(state.frame);
    return true;
  } catch (error) { say(error); return false; }
}

/** Layers that both sources have. */
function layers() {
  const { a, b } = state.meta;
  const common = a.layers.filter((layer) => !b || b.layers.some((other) => other.name === layer.name));
  const text = (layer) => [layer.name, layer.unit ? `${short(layer.label)} [${layer.unit}]` : short(layer.label)];
  if (!common.length) throw new Error(`${a.name} and ${b.name} have no layer in common; choose two of a kind`);
  options($("layer"), common.map(text));
  options($("overlay"), [["", "nothing"], ...common.map(text)]);
  told.layer = $("layer").value;
}

const projecting = new Work($("over-time-told"), $("over-time-cancel"));

/** Mean, deviation and maximum over time of a layer; they become layers. */
async function overTime(layer = $("layer").value) {
  $("over-time").disabled = true;
  try {
    let made = [];
    for (const [name, id] of [["a", state.a], ["b", state.b]]) {
      if (id === null) continue;
      made = (await projecting.done(`/api/project/${id}?layer=${encodeURIComponent(layer)}`)).result.layers;
      state.meta[name] = await json(`/api/source/${id}`);
      if (state.panes[name]) state.panes[name].meta = state.meta[name];
    }
    layers();
    $("layer").value = made[0];
    changeLayer();
    $("over-time-told").textContent = "shown as layers";
  } catch (error) { $("over-time-told").textContent = error.message; }
  $("over-time").disabled = false;
}

const told = { layer: "" }; // the layer that the limits belong to

/** Another layer: limits in kelvin become limits in degrees, others are those of its values. */
function changeLayer() {
  const now = $("layer").value, shift = now === `${told.layer}_celsius` ? -273.15 : told.layer === `${now}_celsius` ? 273.15 : null;
  if ($("scaling").value === "limits" && now !== told.layer) {
    if (shift === null) { $("scaling").value = "percentile"; manual(); }
    else for (const id of ["low", "high"]) $(id).value = Number((Number($(id).value) + shift).toFixed(6));
  }
  if (now !== told.layer) $("low").value = $("scaling").value === "limits" ? $("low").value : "";
  told.layer = now;
  forget();
  goTo(state.frame);
  follow();
}

/** Fields of limits, where they are chosen; filled with the ends of the scale shown. */
function manual() {
  const on = $("scaling").value === "limits";
  document.querySelectorAll(".limits").forEach((box) => { box.hidden = !on; });
  if (!on || $("low").value !== "" || !state.panes.a.scale) return;
  const { values } = state.panes.a.scale;
  setLimits([values[0], values[values.length - 1]]);
}

/** Limits as numbers of the digits that their distance deserves. */
function setLimits([low, high]) {
  const decimals = Math.min(Math.max(3 - Math.floor(Math.log10(high - low || 1)), 0), 12);
  $("low").value = Number(low.toFixed(decimals));
  $("high").value = Number(high.toFixed(decimals));
}

/** Panes for what is compared. */
function arrange() {
  const wanted = names();
  for (const name of Object.keys(state.panes)) if (!wanted.includes(name)) { state.panes[name].canvas.remove(); delete state.panes[name]; }
  for (const name of wanted) {
    if (!state.panes[name]) { state.panes[name] = new Pane(name, $("panes")); pointers(name, state.panes[name], page); }
    state.panes[name].meta = name === "b" ? state.meta.b : state.meta.a;
    state.panes[name].levels = null;
  }
  if (!wanted.includes(state.active)) state.active = "a";
  const wide = state.meta.a.columns > 1.7 * state.meta.a.rows;
  $("panes").style.setProperty("--shape", state.meta.a.rows / state.meta.a.columns);
  $("panes").className = wanted.length === 1 || (wanted.length === 2 && wide) ? "one" : "two";
}

function limits() {
  $("scrub").min = first();
  $("scrub").max = Math.max(last(), first());
  $("clip-first").value = first();
  $("clip-last").value = last();
  for (const id of ["play", "step-back", "step-forward", "scrub"]) $(id).disabled = last() <= first();
}

/** Look again at what is being written, or whether what is shown is still there. */
async function look() {
  if (state.a === null) return;
  try {
    for (const [name, id] of [["a", state.a], ["b", state.b]]) {
      if (id === null) continue;
      const before = state.meta[name], now = await json(`/api/source/${id}`);
      const other = now.rows !== before.rows || now.columns !== before.columns || now.layers.length !== before.layers.length;
      state.meta[name] = now;
      if (state.panes[name]) state.panes[name].meta = now;
      if (other || isGone() || (before.first === null && now.first !== null)) { await restore(fragment(), page); return; } // regions stay
    }
    const atEnd = Number($("scrub").max);
    if (last() !== atEnd) limits();
    readouts();
  } catch (error) { say(error); pause(); }
}

function zoom(by) { camera.zoom = by === 0 ? 1 : Math.min(Math.max(camera.zoom * by, 1), 200); if (camera.zoom === 1) camera.x = camera.y = 0.5; redraw(); }

const jump = (frame) => { pause(); goTo(frame); };
const again = bindSide(redraw, jump);
const regionsChanged = bindRegions({ redraw, recount() { again(); files(); }, goTo: jump, limits: (ends) => page.limits(ends) });

/** What other parts of the page call. */
const page = {
  open, overTime, redraw, probe, follow, profile, files,
  regions: regionsChanged,
  limits(ends) { if ($("scaling").value !== "limits") { $("scaling").value = "limits"; $("low").value = ends[0]; manual(); } setLimits(ends); goTo(state.frame); },
  async settle() {
    told.layer = $("layer").value;
    $("opacity-box").hidden = $("overlay").value === "";
    $("threshold-value").textContent = `${Number($("threshold").value).toFixed(2)} σ`;
    manual();
    arrange();
    follow();
    regionsChanged();
    profile();
    await goTo(state.frame);
  },
};

/** Canvases take the colours of another theme. */
function repaint() {
  takeInk();
  redraw();
  retrace();
  recourse();
  if (state.regions.length) region();
  if (state.line) profile();
  if ($("threshold-on").checked) again();
}

function bind() {
  $("play").addEventListener("click", () => (state.playing ? pause() : play()));
  $("step-back").addEventListener("click", () => step(-1));
  $("step-forward").addEventListener("click", () => step(1));
  $("scrub").addEventListener("input", () => { pause(); goTo(Number($("scrub").value)); });
  $("speed").addEventListener("change", () => { if (state.playing) { pause(); setTimeout(play, 50); } });
  for (const id of ["source-a", "source-b"]) $(id).addEventListener("change", () => open());
  $("difference").addEventListener("change", () => { arrange(); goTo(state.frame); });
  for (const id of ["fixed", "overlay", "truth", "low", "high"]) $(id).addEventListener("change", () => { $("opacity-box").hidden = $("overlay").value === ""; goTo(state.frame); });
  $("layer").addEventListener("change", changeLayer);
  $("over-time").addEventListener("click", () => overTime());
  window.addEventListener("seaglint-theme", repaint);
  $("scaling").addEventListener("change", () => { manual(); goTo(state.frame); });
  $("colours").addEventListener("change", () => { for (const [name, pane] of Object.entries(state.panes)) if (name !== "d") pane.recolour(state.tables[$("colours").value]); files(); redraw(); });
  $("opacity").addEventListener("input", redraw);
  for (const name of Object.keys(TOOLS)) $(`tool-${name}`).addEventListener("click", () => { choose(name); redraw(); });
  $("zoom-in").addEventListener("click", () => zoom(1.5));
  $("zoom-out").addEventListener("click", () => zoom(1 / 1.5));
  $("zoom-reset").addEventListener("click", () => zoom(0));
  document.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || ["INPUT", "SELECT", "TEXTAREA"].includes(event.target.tagName)) return;
    if (event.key === " " && ["BUTTON", "SUMMARY", "A"].includes(event.target.tagName)) return; // the space bar presses it
    const known = { ",": () => step(-1), ".": () => step(1), " ": () => (state.playing ? pause() : play()), ArrowLeft: () => step(-1), ArrowRight: () => step(1), Home: () => goTo(first()), End: () => goTo(last()), "+": () => zoom(1.5), "-": () => zoom(1 / 1.5), 0: () => zoom(0) };
    if (known[event.key]) { event.preventDefault(); known[event.key](); }
  });
  new ResizeObserver(() => { redraw(); for (const plot of Object.values(plots)) plot.draw(); }).observe($("stage"));
  setInterval(() => { if (!state.playing || state.meta.a.done < state.meta.a.frames) look(); }, 2000);
}

async function start() {
  const session = await json("/api/session");
  state.session = session;
  for (const [name, table] of Object.entries(session.colours)) state.tables[name] = tableOf(bytes(table));
  const list = session.sources.map(({ id, name }) => [String(id), name]);
  options($("source-a"), session.given ? list : [["", "choose"], ...list]);
  options($("source-b"), [["", "none"], ...list]);
  if (session.given > 1) $("source-b").value = String(session.sources[1].id);
  options($("threshold-filter"), session.filters.map((name) => [name, name.replaceAll("_", " ")]));
  $("export-clip").hidden = !session.video;
  $("pages").replaceChildren(...session.pages.map(({ path, title }) => { const link = document.createElement("a"); link.href = path; link.textContent = title; return link; }));
  document.title = session.given ? `${session.sources[0].name} - seaglint` : "seaglint";
  takeInk();
  bind();
  bindLink(page);
  choose("pan");
  if (location.hash.length > 1) await restore(location.hash.slice(1), page).catch(async (error) => { if (state.a === null) await open(); say(error); });
  else await open();
}

// For tests: where a pixel is on the screen, and what is held.
window.seaglint = { state, camera, screen: (name, column, row) => { const box = state.panes[name].canvas.getBoundingClientRect(), [x, y] = state.panes[name].screen(column, row); return [box.left + x, box.top + y]; }, digits, rate: rateText, reading, within, plots, fragment };
start().catch(say);
