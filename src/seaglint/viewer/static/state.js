// What the page knows: sources, the frame shown, and how it is shown.
import { $, short } from "./tools.js";

export const state = {
  session: null,
  a: null, b: null, // numbers of the sources
  meta: {}, // of a and b
  frame: 0,
  playing: false,
  tool: "pan",
  regions: [], // { shape, numbers, name }
  chosen: -1, // number of the region whose histogram is shown
  draft: [], // corners of a polygon that is being drawn
  line: null, // [column, row, column, row] of the profile
  pointer: null, // [column, row] under the pointer, or where the arrow keys have led
  probed: null, // the one whose values are told
  pinned: null, // [column, row] whose course is shown
  active: "a", // the pane that was touched last
  panes: {},
  tables: {},
};

/** Query of how a pane's layer is shown; of the difference where told. */
export function showing(difference = false) {
  const query = new URLSearchParams({ layer: $("layer").value, fixed: $("fixed").value });
  const kind = $("scaling").value;
  if (kind === "limits") {
    query.set("scaling", "linear");
    if (!difference && $("low").value !== "" && $("high").value !== "") { query.set("low", $("low").value); query.set("high", $("high").value); }
  } else query.set("scaling", kind);
  if (difference) query.set("minus", state.b);
  return query;
}

export const region = () => state.regions[state.chosen] || null;

export const textOf = ({ shape, numbers }) => [shape, ...numbers].join(" ");

/** A request with regions; their corners would not fit into an address. */
export const body = (regions = state.regions) => ({ method: "POST", body: JSON.stringify({ regions: regions.map((one) => [textOf(one), one.name]) }) });

/** Colour of a region on the picture and in plots. */
export const colourOf = (number, colours) => colours[number % colours.length];

/** Source and number of the pane touched last; the difference has none of its own. */
export const active = () => (state.active === "b" && state.b !== null ? state.b : state.a);

export const meta = () => (active() === state.a ? state.meta.a : state.meta.b);

/** Lower and upper end of the scale shown; null before there is one. */
export function scaleEnds() {
  const scale = state.panes[state.active === "b" && state.panes.b ? "b" : "a"]?.scale;
  return scale ? [scale.values[0], scale.values[scale.values.length - 1]] : null;
}

export function layerText() {
  const found = state.meta.a.layers.find((layer) => layer.name === $("layer").value);
  return found ? short(found.label) : "";
}

let shownGone = false;
let said = 0;

/** Say what is wrong, or nothing. */
export function say(error) {
  const box = $("message");
  if (!error) { box.hidden = true; shownGone = false; return; }
  if (error.name === "AbortError") return;
  shownGone = shownGone || Boolean(error.gone);
  said += 1;
  box.textContent = error.message || String(error);
  box.hidden = false;
}

export const isGone = () => shownGone;

/** Number of messages so far: work that succeeds takes away older ones, none that came while it ran. */
export const messages = () => said;
