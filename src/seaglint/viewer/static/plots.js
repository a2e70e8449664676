// Small plots: a histogram with its fits, and a pixel in time.
import { FONT, INK, digits, short, sized, ticks } from "./tools.js";

function framed(canvas, xs, ys, labels) {
  const { pen, width, height } = sized(canvas);
  const box = { x: 58, y: 8, r: width - 10, b: height - 30 };
  pen.clearRect(0, 0, width, height);
  pen.font = FONT;
  pen.strokeStyle = INK.line;
  pen.strokeRect(box.x - 0.5, box.y - 0.5, box.r - box.x + 1, box.b - box.y + 1);
  const x = (v) => box.x + ((v - xs[0]) / (xs[1] - xs[0] || 1)) * (box.r - box.x);
  const y = (v) => box.b - ((v - ys[0]) / (ys[1] - ys[0] || 1)) * (box.b - box.y);
  pen.fillStyle = INK.faint;
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const v of ticks(...xs, (box.r - box.x) / 70)) pen.fillText(digits(v, 6), x(v), box.b + 3);
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const v of ticks(...ys, (box.b - box.y) / 34)) { pen.fillText(digits(v, 6), box.x - 4, y(v)); }
  pen.textBaseline = "bottom";
  pen.fillText(labels.x, box.r, canvas.clientHeight - 1);
  return { pen, box, x, y };
}

function line(pen, x, y, xs, values, colour, width = 1.4) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  let down = false;
  values.forEach((v, i) => { if (v === null) { down = false; return; } if (down) pen.lineTo(x(xs[i]), y(v)); else pen.moveTo(x(xs[i]), y(v)); down = true; });
  pen.stroke();
}

/** Density of a region's values, with the gamma and Gaussian fits. */
export function histogram(canvas, found) {
  const { edges, density, at } = found.histogram;
  const peak = 1.12 * Math.max(...density);
  const { pen, box, x, y } = framed(canvas, [edges[0], edges[edges.length - 1]], [0, peak], { x: `${short(found.label)} [${found.unit || "1"}]` });
  pen.save();
  pen.beginPath();
  pen.rect(box.x, box.y, box.r - box.x, box.b - box.y);
  pen.clip();
  pen.fillStyle = "#5d6b76";
  density.forEach((v, i) => pen.fillRect(x(edges[i]), y(v), Math.max(x(edges[i + 1]) - x(edges[i]) - 0.5, 0.5), box.b - y(v)));
  const drawn = [["gamma", INK.mark], ["gaussian", INK.second]].filter(([name]) => found.fits[name].density);
  for (const [name, colour] of drawn) line(pen, x, y, at, found.fits[name].density, colour);
  pen.restore();
  pen.textAlign = "right";
  pen.textBaseline = "top";
  drawn.forEach(([name, colour], i) => { pen.fillStyle = colour; pen.fillText(name === "gamma" ? "gamma" : "Gaussian", box.r - 6, box.y + 4 + 14 * i); });
}

/** A pixel's values over time, and where the frame shown lies. */
export function trace(canvas, found, frame) {
  const xs = found.times_s || found.frames;
  const values = found.values.filter((v) => v !== null);
  if (!values.length) return;
  let low = Math.min(...values), high = Math.max(...values);
  if (!(high > low)) { low -= 0.5; high += 0.5; }
  const room = 0.06 * (high - low);
  const { pen, box, x, y } = framed(canvas, [xs[0], xs.length > 1 ? xs[xs.length - 1] : xs[0] + 1], [low - room, high + room], { x: found.times_s ? "time [s]" : "frame" });
  line(pen, x, y, xs, found.values, INK.mark, 1.2);
  const now = frame > found.frames[found.frames.length - 1] ? -1 : found.frames.findIndex((one) => one >= frame);
  if (now >= 0) { pen.strokeStyle = "#ffffff90"; pen.lineWidth = 1; pen.beginPath(); pen.moveTo(x(xs[now]), box.y); pen.lineTo(x(xs[now]), box.b); pen.stroke(); }
  pen.save();
  pen.translate(8, (box.y + box.b) / 2);
  pen.rotate(-Math.PI / 2);
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillStyle = INK.faint;
  pen.fillText(`[${found.unit || "1"}]`, 0, 0);
  pen.restore();
}
