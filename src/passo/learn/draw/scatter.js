/** Points with names over two axes that begin at zero. */

import { scaleOf } from "./chart.js";
import { svg } from "./dom.js";
import { label, ticks } from "./labels.js";

const [WIDE, HIGH, LEFT, TOP, BOTTOM, RIGHT] = [460, 360, 44, 12, 40, 20];

/** The picture of points {name, x, y, colour}; a point without a name has a tooltip in `title`. `across` is the label of
 * the horizontal axis, `text` what the picture shows. */
export function scatter(points, { across, text }) {
  const [, right, xStep] = scaleOf([0, ...points.map((p) => 1.05 * p.x)]);
  const [, top, yStep] = scaleOf([0, ...points.map((p) => 1.05 * p.y)]);
  const [wide, high] = [WIDE - LEFT - RIGHT, HIGH - TOP - BOTTOM];
  const [x, y] = [(v) => LEFT + (wide * v) / right, (v) => TOP + high * (1 - v / top)];
  const drawing = svg("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, role: "img", "aria-label": text });
  for (const v of ticks(0, top, yStep)) {
    drawing.append(svg("path", { class: "grid", d: `M${LEFT} ${y(v)}h${wide}` }));
    drawing.append(svg("text", { x: LEFT - 6, y: y(v) + 4, "text-anchor": "end" }, label(v, yStep)));
  }
  for (const v of ticks(0, right, xStep)) {
    drawing.append(svg("text", { x: x(v), y: TOP + high + 16, "text-anchor": "middle" }, label(v, xStep)));
  }
  drawing.append(svg("text", { x: LEFT + wide / 2, y: TOP + high + 34, "text-anchor": "middle" }, across));
  const taken = points.map((p) => [x(p.x) - 5, y(p.y) - 5, x(p.x) + 5, y(p.y) + 5]);
  for (const { name, x: px, y: py, colour, title } of points) {
    const dot = svg("circle", { class: `c${colour}`, cx: x(px), cy: y(py), r: 4.5 });
    if (title) dot.append(svg("title", {}, title));
    drawing.append(dot);
    if (name) {
      const place = freePlace(x(px), y(py), name, taken, LEFT + wide);
      taken.push(place.box);
      drawing.append(svg("text", { class: "name", x: place.x, y: place.y, "text-anchor": place.anchor }, name));
    }
  }
  return drawing;
}

/** Where a text next to a point covers nothing. */
function freePlace(x, y, text, taken, most) {
  const wide = 6.8 * text.length;
  const places = [
    [8, "start", 4, x + 8],
    [0, "middle", -9, x - wide / 2],
    [0, "middle", 18, x - wide / 2],
    [-8, "end", 4, x - 8 - wide],
    [6, "start", -20, x + 6],
    [6, "start", 30, x + 6],
    [-6, "end", -20, x - 6 - wide],
  ].map(([across, anchor, down, left]) => ({ x: x + across, y: y + down, anchor, box: [left, y + down - 11, left + wide, y + down + 3] }));
  const covered = ([x0, y0, x1, y1]) =>
    taken.filter((b) => x0 < b[2] && x1 > b[0] && y0 < b[3] && y1 > b[1]).length + Number(x1 > most + 20);
  return places.reduce((a, b) => (covered(b.box) < covered(a.box) ? b : a));
}
