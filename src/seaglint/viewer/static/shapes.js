// Shapes of regions: their outlines and handles, and what moving and resizing makes of their numbers.
const MOST_CORNERS = 40; // of a polygon whose corners are dragged one by one; one of more is resized by its box

const bounded = (v, least, most) => Math.min(Math.max(v, least), most);

/** Corners of a polygon as pairs. */
const pairs = (numbers) => numbers.flatMap((v, i) => (i % 2 ? [] : [[v, numbers[i + 1]]]));

/** Left, top, right and bottom of a region. */
export function boxOf({ shape, numbers }) {
  if (shape !== "polygon") return [numbers[0], numbers[1], numbers[0] + numbers[2], numbers[1] + numbers[3]];
  return pairs(numbers).reduce(([l, t, r, b], [x, y]) => [Math.min(l, x), Math.min(t, y), Math.max(r, x), Math.max(b, y)], [Infinity, Infinity, -Infinity, -Infinity]);
}

/** Points of the closed outline. */
export function outline(one) {
  if (one.shape === "polygon") return pairs(one.numbers);
  const [l, t, r, b] = boxOf(one);
  if (one.shape === "rectangle") return [[l, t], [r, t], [r, b], [l, b]];
  return Array.from({ length: 72 }, (_, i) => [(l + r + (r - l) * Math.cos((i * Math.PI) / 36)) / 2, (t + b + (b - t) * Math.sin((i * Math.PI) / 36)) / 2]);
}

/** What resizes a region: the corners of a polygon; otherwise corners and middles of the box, at the shares u and v of its sides. */
export function handles(one) {
  if (one.shape === "polygon" && one.numbers.length <= 2 * MOST_CORNERS) return pairs(one.numbers).map(([x, y], corner) => ({ x, y, corner }));
  const [l, t, r, b] = boxOf(one), shares = [[0, 0], [0.5, 0], [1, 0], [1, 0.5], [1, 1], [0.5, 1], [0, 1], [0, 0.5]];
  return shares.map(([u, v]) => ({ x: l + u * (r - l), y: t + v * (b - t), u, v }));
}

/** The handle at a place, true on the outline, or null; `reach` in pixels of the picture. */
export function grip(one, [x, y], reach, withHandles) {
  const far = ({ x: u, y: v }) => Math.hypot(u - x, v - y);
  const near = withHandles ? handles(one).reduce((best, h) => (best && far(best) <= far(h) ? best : h), null) : null;
  if (near && far(near) <= reach) return near;
  const points = outline(one);
  return points.some((to, i) => distance([x, y], points.at(i - 1), to) <= reach) ? true : null;
}

function distance([x, y], [x0, y0], [x1, y1]) {
  const length = (x1 - x0) ** 2 + (y1 - y0) ** 2, share = length ? bounded(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length, 0, 1) : 0;
  return Math.hypot(x0 + share * (x1 - x0) - x, y0 + share * (y1 - y0) - y);
}

/** Numbers of a region moved by whole pixels, within the picture. */
export function moved(one, by, { columns, rows }) {
  const [l, t, r, b] = boxOf(one);
  const dx = bounded(Math.round(by[0]), Math.min(0, -l), Math.max(0, columns - r)), dy = bounded(Math.round(by[1]), Math.min(0, -t), Math.max(0, rows - b));
  if (one.shape === "polygon") return one.numbers.map((v, i) => v + (i % 2 ? dy : dx));
  return [l + dx, t + dy, r - l, b - t];
}

/** Numbers of a region with one of its handles at a place, within the picture. */
export function resized(one, handle, [x, y], { columns, rows }) {
  const to = [bounded(x, 0, columns), bounded(y, 0, rows)];
  if (handle.corner !== undefined) return one.numbers.map((v, i) => (i >> 1 === handle.corner ? Math.round(10 * to[i % 2]) / 10 : v));
  const [l, t, r, b] = boxOf(one);
  return fitting(one, [...side(handle.u, l, r, to[0], columns), ...side(handle.v, t, b, to[1], rows)]);
}

/** Both ends of a side, one of them moved; a pixel wide at least. */
function side(share, low, high, to, most) {
  if (share === 0.5) return [low, high];
  const [a, b] = [share ? low : high, Math.round(to)].sort((v, w) => v - w);
  return b - a >= 1 ? [a, b] : [Math.min(a, most - 1), Math.min(a, most - 1) + 1];
}

function fitting(one, [x0, x1, y0, y1]) {
  if (one.shape !== "polygon") return [x0, y0, x1 - x0, y1 - y0];
  const [l, t, r, b] = boxOf(one), scale = (v, from, to, low, high) => low + ((v - from) / (to - from || 1)) * (high - low);
  return one.numbers.map((v, i) => Math.round(1000 * (i % 2 ? scale(v, t, b, y0, y1) : scale(v, l, r, x0, x1))) / 1000);
}

/** Numbers of a region larger or smaller by so many pixels at its right and lower side. */
export function grown(one, by, { columns, rows }) {
  const [l, t, r, b] = boxOf(one);
  return fitting(one, [l, bounded(r + by[0], l + 1, columns), t, bounded(b + by[1], t + 1, rows)]);
}
