// One picture with its axes: levels become colours here, zoom and pan are shared by all panes.
import { boxOf, handles, outline } from "./shapes.js";
import { colourOf } from "./state.js";
import { FONT, INK, digits, fitted, minus, sized, ticks, within } from "./tools.js";

const MARGIN = { left: 52, right: 46, top: 46, bottom: 74 };
const MISSING = [28, 44, 58];

/** What part of the pictures is seen: middle as shares of width and height, and magnification. */
export const camera = { x: 0.5, y: 0.5, zoom: 1 };

export class Pane {
  constructor(name, parent) {
    this.name = name;
    this.canvas = document.createElement("canvas");
    this.canvas.dataset.testid = `canvas-${name}`;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "application");
    this.canvas.setAttribute("aria-roledescription", "picture; arrows move the probe, with Shift they mark a region");
    parent.append(this.canvas);
    this.picture = document.createElement("canvas");
    this.above = document.createElement("canvas");
    this.mask = document.createElement("canvas");
    this.meta = null;
    this.scale = null;
    this.boxes = [];
    this.hasAbove = this.hasMask = false;
    this.drawn = 0;
    this.barPlace = null;
  }

  /** Colours of levels (one byte each) into one of the pane's images. */
  static paint(target, levels, columns, rows, table) {
    if (target.width !== columns || target.height !== rows) { target.width = columns; target.height = rows; }
    const pen = target.getContext("2d");
    if (!target.held || target.held.width !== columns || target.held.height !== rows) target.held = pen.createImageData(columns, rows);
    const image = target.held; // one for all frames
    const out = new Uint32Array(image.data.buffer);
    for (let i = 0; i < out.length; i++) out[i] = table[levels[i]];
    pen.putImageData(image, 0, 0);
  }

  setLevels(levels, table, scale) {
    this.levels = levels;
    this.scale = scale;
    this.table = table;
    Pane.paint(this.picture, levels, this.meta.columns, this.meta.rows, table);
  }

  recolour(table) { if (this.levels) this.setLevels(this.levels, table, this.scale); }

  setAbove(levels, table) { this.hasAbove = Boolean(levels); if (levels) Pane.paint(this.above, levels, this.meta.columns, this.meta.rows, table); }

  setMask(bits) {
    this.hasMask = Boolean(bits);
    if (!bits) return;
    const { rows, columns } = this.meta, levels = new Uint8Array(rows * columns);
    for (let i = 0; i < levels.length; i++) levels[i] = (bits[i >> 3] >> (7 - (i & 7))) & 1;
    Pane.paint(this.mask, levels, columns, rows, new Uint32Array([0, 0xff3c3cff]));
  }

  /** Place of the picture on the screen: left, top, and screen pixels per picture pixel. */
  place() {
    const { columns, rows } = this.meta;
    const width = this.canvas.clientWidth - MARGIN.left - MARGIN.right, height = this.canvas.clientHeight - MARGIN.top - MARGIN.bottom;
    const size = Math.max(Math.min(width / columns, height / rows), 0.01) * camera.zoom;
    return { size, left: MARGIN.left + width / 2 - camera.x * columns * size, top: MARGIN.top + height / 2 - camera.y * rows * size, width, height };
  }

  /** Column and row (fractions; pixel n spans n to n + 1) at a place of the canvas. */
  at(x, y) { const p = this.place(); return [(x - p.left) / p.size, (y - p.top) / p.size]; }

  /** Place of the canvas of the middle of a pixel. */
  screen(column, row) { const p = this.place(); return [p.left + (column + 0.5) * p.size, p.top + (row + 0.5) * p.size]; }

  contains(x, y) {
    const p = this.place();
    return x >= MARGIN.left && y >= MARGIN.top && x < MARGIN.left + p.width && y < MARGIN.top + p.height;
  }

  draw({ title, layer, regions, chosen, grips, draft, line, pointer, pinned, opacity }) {
    const { pen, width, height } = sized(this.canvas);
    if (this.canvas.ariaLabel !== `${title}; ${layer}`) this.canvas.ariaLabel = `${title}; ${layer}`;
    pen.fillStyle = INK.ground;
    pen.fillRect(0, 0, width, height);
    if (!this.meta || !this.levels) return;
    const p = this.place(), { columns, rows } = this.meta;
    const frame = { x: Math.max(p.left, MARGIN.left), y: Math.max(p.top, MARGIN.top) };
    frame.r = Math.min(p.left + columns * p.size, MARGIN.left + p.width);
    frame.b = Math.min(p.top + rows * p.size, MARGIN.top + p.height);
    if (frame.r <= frame.x || frame.b <= frame.y) return;
    pen.save();
    pen.beginPath();
    pen.rect(frame.x, frame.y, frame.r - frame.x, frame.b - frame.y);
    pen.clip();
    pen.imageSmoothingEnabled = p.size < 1;
    const put = (image) => pen.drawImage(image, p.left, p.top, columns * p.size, rows * p.size);
    put(this.picture);
    if (this.hasAbove) { pen.globalAlpha = opacity; put(this.above); pen.globalAlpha = 1; }
    if (this.hasMask) put(this.mask);
    this.drawBoxes(pen, p);
    regions.forEach((one, i) => this.region(pen, p, one, colourOf(i, INK.onPicture), i === chosen, grips));
    if (draft.length) this.path(pen, draft.map(([x, y]) => [p.left + x * p.size, p.top + y * p.size]), INK.onPicture[0], 2);
    if (line) this.path(pen, [line.slice(0, 2), line.slice(2)].map(([x, y]) => [p.left + (x + 0.5) * p.size, p.top + (y + 0.5) * p.size]), INK.onPicture[1], 2);
    if (pinned) this.cross(pen, p, pinned, INK.onPicture[0]);
    if (pointer) this.cross(pen, p, pointer, "#ffffff");
    pen.restore();
    this.axes(pen, p, frame);
    pen.textAlign = "left";
    pen.textBaseline = "alphabetic";
    pen.fillStyle = INK.text;
    pen.font = `600 ${FONT}`;
    pen.fillText(fitted(pen, title, width - MARGIN.left - 8), MARGIN.left, 13);
    this.bar(pen, frame, layer, height);
    this.drawn++;
  }

  /** A line with dots at its points. */
  path(pen, points, colour, width) {
    pen.beginPath();
    for (const point of points) pen.lineTo(...point);
    this.stroke(pen, colour, width);
    pen.fillStyle = colour;
    for (const [x, y] of points) pen.fillRect(x - 3, y - 3, 6, 6);
  }

  /** A line that is seen on any ground: dark around bright. */
  stroke(pen, colour, width) {
    for (const [ink, wide] of [["#000000a0", width + 2], [colour, width]]) { pen.strokeStyle = ink; pen.lineWidth = wide; pen.stroke(); }
  }

  /** Outline and name of a region; of the chosen one also the handles, where they can be dragged. */
  region(pen, p, one, colour, chosen, grips) {
    const at = ([x, y]) => [p.left + x * p.size, p.top + y * p.size], [left, top, right, bottom] = boxOf(one), width = chosen ? 2.4 : 1.4;
    pen.beginPath();
    if (one.shape === "ellipse") pen.ellipse(...at([(left + right) / 2, (top + bottom) / 2]), ((right - left) / 2) * p.size, ((bottom - top) / 2) * p.size, 0, 0, 7);
    else { outline(one).forEach((point) => pen.lineTo(...at(point))); pen.closePath(); }
    this.stroke(pen, colour, width);
    if (chosen && grips) for (const { x, y } of handles(one)) {
      const [u, v] = at([x, y]);
      pen.fillStyle = "#000000a0";
      pen.fillRect(u - 5, v - 5, 10, 10);
      pen.fillStyle = colour;
      pen.fillRect(u - 3.5, v - 3.5, 7, 7);
    }
    const highest = (best, point) => (point[1] < best[1] ? point : best), [labelX, labelY] = at(one.shape === "polygon" ? outline(one).reduce(highest) : [left, top]);
    pen.font = `600 ${FONT}`;
    pen.textAlign = "left";
    pen.textBaseline = "bottom";
    pen.strokeStyle = "#000000c0";
    pen.lineWidth = 3;
    pen.strokeText(one.name, labelX + 1, labelY - 6);
    pen.fillStyle = colour;
    pen.fillText(one.name, labelX + 1, labelY - 6);
  }

  drawBoxes(pen, p) {
    pen.font = FONT;
    pen.strokeStyle = INK.onPicture[1];
    pen.lineWidth = 1.2;
    const corners = this.boxes.map((box) => [p.left + box.left * p.size, p.top + box.top * p.size]);
    this.boxes.forEach((box, i) => pen.strokeRect(corners[i][0] - 1.5, corners[i][1] - 1.5, box.width * p.size + 3, box.height * p.size + 3));
    const end = Math.min(p.left + this.meta.columns * p.size, MARGIN.left + p.width), begin = Math.max(p.left, MARGIN.left);
    const labels = []; // none covers another: it goes above it, with a line to its box
    this.boxes.forEach((box, i) => {
      const [x, y] = corners[i];
      if (x > end || x + box.width * p.size < begin) return; // zoomed out of sight
      const text = box.range_m === null ? box.name : `${box.name}, ${digits(box.range_m / 1000, 3)} km`;
      const wide = pen.measureText(text).width + 5, left = Math.max(Math.min(x - 2, end - wide), begin);
      let top = y - 16;
      while (labels.some((o) => top < o.top + 15 && o.top < top + 15 && left < o.left + o.wide && o.left < left + wide)) top -= 3;
      labels.push({ text, left, top, wide });
      if (top < y - 17) { pen.beginPath(); pen.moveTo(x, y - 1.5); pen.lineTo(x, top + 14); pen.stroke(); }
    });
    pen.textBaseline = "bottom";
    for (const { text, left, top, wide } of labels) {
      pen.fillStyle = "#000000b0";
      pen.fillRect(left, top, wide, 14);
      pen.fillStyle = INK.onPicture[1];
      pen.fillText(text, left + 2, top + 13);
    }
  }

  cross(pen, p, [column, row], colour) {
    const x = p.left + (column + 0.5) * p.size, y = p.top + (row + 0.5) * p.size, r = Math.max(p.size / 2, 3);
    for (const [ink, width] of [["#000000c0", 4], [colour, 1.6]]) { // dark around bright: seen on any ground
      pen.strokeStyle = ink;
      pen.lineWidth = width;
      pen.beginPath();
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) { pen.moveTo(x + dx * r, y + dy * r); pen.lineTo(x + dx * (r + 8), y + dy * (r + 8)); }
      pen.stroke();
    }
  }

  /** Degrees below and left where each column and row has one, pixels above and right; pixels alone otherwise. */
  axes(pen, p, f) {
    const { azimuth_deg: azimuth, elevation_deg: elevation, columns, rows } = this.meta;
    pen.font = FONT;
    pen.strokeStyle = INK.faint;
    pen.fillStyle = INK.faint;
    pen.lineWidth = 1;
    pen.strokeRect(Math.round(f.x) - 0.5, Math.round(f.y) - 0.5, Math.round(f.r - f.x) + 1, Math.round(f.b - f.y) + 1);
    const across = [(f.x - p.left) / p.size, (f.r - p.left) / p.size], down = [(f.y - p.top) / p.size, (f.b - p.top) / p.size];
    const manyX = (f.r - f.x) / 75, manyY = (f.b - f.y) / 45;
    const pixel = (low, high, many) => ticks(low - 0.5, high - 0.5, many).filter(Number.isInteger).map((v) => [v + 0.5, String(v)]);
    const degrees = (values, [low, high], many) => {
      const value = (place) => interpolate(values, place - 0.5);
      return ticks(value(low), value(high), many).map((v) => [inverse(values, v) + 0.5, `${minus(String(v))}°`]).filter(([place]) => place >= low && place <= high);
    };
    const draw = (list, at, text) => { for (const [place, label] of list) { const [x, y, dx, dy] = at(place); pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x + dx, y + dy); pen.stroke(); text(label, x + 1.6 * dx, y + 1.6 * dy); } };
    const horizontal = (y, d) => (place) => [p.left + place * p.size, y, 0, d];
    const vertical = (x, d) => (place) => [x, p.top + place * p.size, d, 0];
    const write = (align, base) => (label, x, y) => { pen.textAlign = align; pen.textBaseline = base; pen.fillText(label, x, y); };
    draw(pixel(...across, manyX), horizontal(f.y, -4), write("center", "bottom"));
    draw(pixel(...down, manyY), vertical(f.r, 4), write("left", "middle"));
    if (azimuth) draw(degrees(azimuth, across, manyX), horizontal(f.b, 4), write("center", "top"));
    else draw(pixel(...across, manyX), horizontal(f.b, 4), write("center", "top"));
    if (elevation) draw(degrees(elevation, down, manyY), vertical(f.x, -4), write("right", "middle"));
    else draw(pixel(...down, manyY), vertical(f.x, -4), write("right", "middle"));
    pen.textAlign = "right";
    pen.textBaseline = "top";
    pen.fillText(azimuth ? "azimuth" : "column [px]", f.r, f.b + 18);
    pen.textAlign = "left";
    if (azimuth) { pen.textBaseline = "alphabetic"; pen.textAlign = "right"; pen.fillText("column [px]", f.r, f.y - 19); pen.fillText("row [px]", f.r + 44, f.y - 6); }
    pen.save();
    pen.translate(f.x - 42, (f.y + f.b) / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText(elevation ? "elevation" : "row [px]", 0, 0);
    pen.restore();
  }

  /** The end of the scale that a place on the colour bar moves; both in its middle; null outside. */
  barAt(x, y) {
    const bar = this.barPlace;
    if (!bar || y < bar.y - 3 || y > bar.y + 26 || x < bar.left - 12 || x > bar.left + bar.width + 12) return null;
    const share = (x - bar.left) / bar.width;
    return share < 1 / 3 ? "low" : share > 2 / 3 ? "high" : "both";
  }

  /** Colours and the values that they stand for; its ends can be dragged. */
  bar(pen, f, layer, height) {
    if (!this.scale) return;
    // A picture of few columns is narrower than the labels of its bar.
    const wide = Math.max(f.r - f.x, Math.min(200, this.canvas.clientWidth - MARGIN.left - MARGIN.right)), middle = (f.x + f.r) / 2;
    const left = middle - wide / 2, right = middle + wide / 2, y = Math.min(f.b + 42, height - 30), { shares, values, unit } = this.scale;
    const strip = document.createElement("canvas");
    Pane.paint(strip, Uint8Array.from({ length: 255 }, (_, i) => i + 1), 255, 1, this.table);
    this.barPlace = this.name === "d" ? null : { left, width: wide, y };
    pen.imageSmoothingEnabled = false;
    pen.drawImage(strip, left, y, right - left, 9);
    pen.fillStyle = INK.faint;
    pen.font = FONT;
    pen.textBaseline = "top";
    for (const x of this.barPlace ? [left, right] : []) { pen.fillStyle = INK.text; pen.fillRect(x - 1.5, y - 3, 3, 15); }
    pen.fillStyle = INK.faint;
    const many = right - left < 260 ? 2 : 1, spread = (values[values.length - 1] - values[0]) / 3;
    values.forEach((value, i) => {
      if (i % many) return;
      pen.textAlign = i === 0 ? "left" : i === values.length - 1 ? "right" : "center";
      pen.fillText(within(value, spread), left + shares[i] * (right - left), y + 14);
    });
    pen.textAlign = "left";
    pen.textBaseline = "bottom";
    pen.fillStyle = INK.text;
    pen.fillText(fitted(pen, unit ? `${layer} [${unit}]` : layer, right - left), left, y - 4);
  }
}

function interpolate(values, place) {
  if (values.length === 1) return values[0];
  const i = Math.min(Math.max(Math.floor(place), 0), values.length - 2);
  return values[i] + (place - i) * (values[i + 1] - values[i]);
}

/** Place at which rising or falling values reach one. */
function inverse(values, value) {
  if (values.length === 1) return 0;
  const rising = values[values.length - 1] > values[0];
  let low = 0, high = values.length - 2;
  while (low < high) { const middle = (low + high + 1) >> 1; if ((values[middle] <= value) === rising) low = middle; else high = middle - 1; }
  return low + (value - values[low]) / (values[low + 1] - values[low]);
}

/** 256 colours as words of a canvas; the first is that of pixels without a value. */
export function tableOf(rgb) {
  const out = new Uint32Array(256);
  for (let i = 0; i < 256; i++) out[i] = 0xff000000 | (rgb[3 * i + 2] << 16) | (rgb[3 * i + 1] << 8) | rgb[3 * i];
  out[0] = 0xff000000 | (MISSING[2] << 16) | (MISSING[1] << 8) | MISSING[0];
  return out;
}

/** Blue below zero, dark at it, amber above: for differences. */
export function diverging() {
  const rgb = new Uint8Array(768);
  for (let i = 1; i < 256; i++) {
    const t = (i - 128) / 127, s = Math.abs(t) ** 0.8, end = t < 0 ? [110, 190, 255] : [255, 190, 80];
    for (let c = 0; c < 3; c++) rgb[3 * i + c] = Math.round(22 + s * (end[c] - 22));
  }
  return tableOf(rgb);
}
