// What pointers and keys do on a picture: move, zoom, probe, mark regions and a line, drag the ends of the scale.
import { camera } from "./pane.js";
import { add, reshape } from "./regions.js";
import { grip, moved, resized } from "./shapes.js";
import { region as chosen, say, state } from "./state.js";
import { $, latest } from "./tools.js";

export const TOOLS = { pan: "drag moves the picture, or a region by its outline; a click follows the pixel in time", rectangle: "drag from corner to corner", ellipse: "drag from corner to corner of its frame", polygon: "click each corner, then the first one again, or the last one twice", line: "drag from end to end" };

const bounded = (v, most) => Math.min(Math.max(v, 0), most);

/** What the tool expects; corners of an open polygon stay while another tool is used. */
function tell() {
  const many = state.draft.length, corners = `${many} corner${many > 1 ? "s" : ""}`;
  $("tool-told").textContent = !many ? TOOLS[state.tool] : state.tool === "polygon"
    ? `${corners}: click the first one again, the last one twice, or press Enter, to close it`
    : `${TOOLS[state.tool]}; a polygon of ${corners} is open: choose Polygon to continue it, Escape discards it`;
}

export function choose(tool) {
  state.tool = tool;
  for (const name of Object.keys(TOOLS)) $(`tool-${name}`).setAttribute("aria-pressed", String(name === tool));
  tell();
}

/** Whole pixels that a drag covers: left, top, width, height. */
function frameOf({ columns, rows }, [x0, y0], [x1, y1]) {
  const left = Math.floor(bounded(Math.min(x0, x1), columns - 1)), top = Math.floor(bounded(Math.min(y0, y1), rows - 1));
  const right = Math.ceil(bounded(Math.max(x0, x1), columns)), bottom = Math.ceil(bounded(Math.max(y0, y1), rows));
  return [left, top, Math.max(right - left, 1), Math.max(bottom - top, 1)];
}

/**
 * Bind one pane. `page` has what follows: redraw, probe, follow, profile, regions (their statistics again), files, limits (ends of the scale).
 */
export function pointers(name, pane, page) {
  const { canvas } = pane;
  let began = null, anchor = null, closed = null; // closed: where and when a click closed a polygon
  const moreLater = latest(async () => { await new Promise((go) => setTimeout(go, 60)); page.regions(); });
  const place = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  const pixel = (x, y) => {
    const [column, row] = pane.at(x, y).map(Math.floor);
    return pane.contains(x, y) && column >= 0 && row >= 0 && column < pane.meta.columns && row < pane.meta.rows ? [column, row] : null;
  };
  const near = (x, y) => { const { columns, rows } = pane.meta, [column, row] = pane.at(x, y); return [bounded(Math.floor(column), columns - 1), bounded(Math.floor(row), rows - 1)]; };

  /** The region whose outline or handle is at a place, the chosen one first: { index, handle }. */
  function grabbed(x, y, touch) {
    if (state.tool !== "pan" || !pane.meta || !pane.contains(x, y)) return null;
    const reach = (touch ? 16 : 6) / pane.place().size, at = pane.at(x, y);
    for (const index of [state.chosen, ...state.regions.keys()]) {
      const handle = state.regions[index] && grip(state.regions[index], at, reach, index === state.chosen);
      if (handle) return { index, handle };
    }
    return null;
  }

  function close() {
    if (state.draft.length > 2) { add("polygon", state.draft.flat()); page.regions(); } else if (state.draft.length) say(new Error("a polygon has 3 corners at least; click further ones"));
    state.draft = [];
    tell();
    page.redraw();
  }

  function corner(x, y) {
    const { size, left, top } = pane.place(), away = (at) => (at ? Math.hypot(left + at[0] * size - x, top + at[1] * size - y) : Infinity);
    const again = away(state.draft.at(-1)) < 5; // a double click has no second corner
    if (closed && !state.draft.length && performance.now() - closed.time < 500 && Math.hypot(x - closed.x, y - closed.y) < 5) return;
    if (state.draft.length > 2 && (again || away(state.draft[0]) < 14)) { closed = { x, y, time: performance.now() }; close(); return; }
    if (again) return;
    const { columns, rows } = pane.meta, [column, row] = pane.at(x, y);
    state.draft.push([bounded(column, columns), bounded(row, rows)].map((v) => Math.round(10 * v) / 10));
    tell();
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !pane.meta) return;
    state.active = name;
    anchor = null;
    const [x, y] = place(event);
    const tool = event.shiftKey && !["ellipse", "line", "polygon"].includes(state.tool) ? "rectangle" : state.tool;
    const grab = event.shiftKey ? null : grabbed(x, y, event.pointerType === "touch");
    if (grab) { grab.was = { ...state.regions[grab.index] }; state.chosen = grab.index; }
    began = { x, y, tool, grab, moved: false, camera: { ...camera }, at: pane.at(x, y), pixel: near(x, y), scale: pane.barAt(x, y), values: pane.scale && [...pane.scale.values], before: state.regions.length };
    canvas.setPointerCapture(event.pointerId);
  });

  canvas.addEventListener("pointermove", (event) => {
    if (!pane.meta) return;
    const [x, y] = place(event);
    state.pointer = pixel(x, y);
    const grab = began ? began.grab : grabbed(x, y, false);
    canvas.style.cursor = pane.barAt(x, y) ? "ew-resize" : !grab ? "crosshair" : grab.handle === true ? "move" : "pointer";
    if (began) drag(x, y);
    page.redraw();
    page.probe();
  });

  function drag(x, y) {
    if (Math.hypot(x - began.x, y - began.y) > 3) began.moved = true;
    if (!began.moved) return;
    if (began.scale) {
      const low = began.values[0], high = began.values[began.values.length - 1], by = ((x - began.x) / pane.barPlace.width) * (high - low);
      const ends = [low + (began.scale === "high" ? 0 : by), high + (began.scale === "low" ? 0 : by)];
      if (ends[0] < ends[1]) page.limits(ends);
    } else if (began.grab) {
      const { index, handle, was } = began.grab, to = pane.at(x, y);
      reshape(index, handle === true ? moved(was, [to[0] - began.at[0], to[1] - began.at[1]], pane.meta) : resized(was, handle, to, pane.meta));
      moreLater();
    } else if (began.tool === "rectangle" || began.tool === "ellipse") {
      const numbers = frameOf(pane.meta, began.at, pane.at(x, y));
      if (state.regions.length === began.before) add(began.tool, numbers); else chosen().numbers = numbers;
    } else if (began.tool === "line") state.line = [...began.pixel, ...near(x, y)];
    else if (began.tool === "pan") {
      const { size } = pane.place(), { columns, rows } = pane.meta;
      camera.x = began.camera.x - (x - began.x) / (size * columns);
      camera.y = began.camera.y - (y - began.y) / (size * rows);
    }
  }

  canvas.addEventListener("pointerup", (event) => {
    if (!began) return;
    const was = began, [x, y] = place(event);
    began = null;
    if (was.scale) { page.redraw(); return; }
    if (was.tool === "polygon") { if (!was.moved && (pixel(x, y) || state.draft.length)) corner(x, y); }
    else if (was.moved && was.tool === "line") page.profile();
    else if (was.moved && (was.grab || was.tool !== "pan")) page.regions();
    else if (!was.moved) {
      if (was.grab) page.regions();
      // A finger points only while it touches: the pixel that it tapped stays the one probed.
      state.pinned = state.probed = pixel(x, y) || state.pinned;
      if (event.pointerType === "touch") state.pointer = null;
      page.follow();
      page.probe();
    }
    page.files();
    page.redraw();
  });
  // Over a whole picture a finger scrolls the page, but not where it drags a region.
  canvas.addEventListener("touchstart", (event) => { const [finger] = event.touches; if (event.touches.length === 1 && grabbed(...place(finger), true)) event.preventDefault(); }, { passive: false });
  canvas.addEventListener("pointercancel", () => { began = null; });
  canvas.addEventListener("pointerleave", () => { if (!began) { state.pointer = null; page.redraw(); } });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (!pane.meta) return;
    const [x, y] = place(event), before = pane.at(x, y);
    camera.zoom = Math.min(Math.max(camera.zoom * Math.exp(-event.deltaY / 400), 1), 200);
    const after = pane.at(x, y);
    camera.x += (before[0] - after[0]) / pane.meta.columns;
    camera.y += (before[1] - after[1]) / pane.meta.rows;
    if (camera.zoom === 1) camera.x = camera.y = 0.5;
    page.redraw();
  }, { passive: false });

  canvas.addEventListener("keydown", (event) => {
    if (!pane.meta || event.metaKey || event.altKey) return;
    const { columns, rows } = pane.meta;
    const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (by) {
      const from = state.pointer || state.probed || state.pinned || [Math.floor(columns / 2), Math.floor(rows / 2)], step = event.ctrlKey ? 10 : 1;
      const to = [bounded(from[0] + step * by[0], columns - 1), bounded(from[1] + step * by[1], rows - 1)];
      state.active = name;
      state.pointer = to;
      if (event.shiftKey) {
        if (!anchor || !chosen()) { anchor = from; add("rectangle", [...from, 1, 1]); }
        const [x, y] = [0, 1].map((i) => [Math.min(anchor[i], to[i]), Math.abs(anchor[i] - to[i]) + 1]);
        chosen().numbers = [x[0], y[0], x[1], y[1]];
        moreLater();
      } else anchor = null;
      page.probe();
    } else if (event.key === "Enter") {
      if (state.draft.length) close(); else if (state.pointer || state.probed) { state.pinned = state.pointer || state.probed; page.follow(); }
    } else if (event.key === "Escape") { state.draft = []; anchor = null; choose(state.tool); } else return;
    event.preventDefault();
    page.redraw();
  });
}
