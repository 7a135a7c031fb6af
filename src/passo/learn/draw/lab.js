/** The page of `passo lab`: the trials of a file in a table, and pictures of one corner. */

import { lined, Plot, scaleOf } from "./chart.js";
import { html, soon, svg } from "./dom.js";
import { label, ticks } from "./labels.js";
import { data, main, section } from "./pages.js";

const BEAD_MM = 0.45; // the width of a printed line
const COLUMNS_S = [0, 0.05, 0.1];
const [WIDE, HIGH, LEFT, TOP, BOTTOM, RIGHT] = [460, 360, 44, 12, 40, 20]; // of the picture of the trade

const best = (i) => (i === data.best ? { class: "best" } : {});
const note = (text) => html("p", { class: "note" }, text);

function trials({ columns, rows, text }) {
  const heads = ["Setting", ...columns, "Score"].map((name) => html("th", { scope: "col" }, name));
  const lines = rows.map(({ name, cells, score }, i) => {
    const shown = cells.map(([share, value]) => {
      const bar = html("i");
      bar.style.width = `${60 * share}%`;
      return html("td", {}, bar, value);
    });
    return html("tr", best(i), html("th", { scope: "row" }, name), ...shown, html("td", {}, score));
  });
  const title = "Every setting, printed on the simulated machine";
  const made = html("table", {}, html("thead", {}, html("tr", {}, ...heads)), html("tbody", {}, ...lines));
  return section("trials wide", title, html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": title }, made), note(text));
}

/** The way of the head around one corner, in mm from it. */
function corner({ line, at_mm: [x0, y0], before: [ax, ay], after: [bx, by], reach_mm: reach, ways }) {
  const way = (points) => lined(points.map(([x, y]) => [x, -y]), 4);
  const far = 2 * reach;
  const wanted = way([[-far * ax, -far * ay], [0, 0], [far * bx, far * by]]);
  const bar = reach < 1.2 ? 0.1 : 0.5;
  const view = { viewBox: `${-reach} ${-reach} ${2 * reach} ${2 * reach}`, role: "img", "aria-label": "The way of the head around one corner" };
  const drawing = svg("svg", view,
    svg("path", { class: "bead", "stroke-width": BEAD_MM, d: wanted }),
    svg("path", { class: "plan", d: wanted }),
    ...ways.map(({ points, colour }) => svg("path", { class: `line c${colour}`, d: way(points) })),
    svg("path", { class: "bar", d: `M${-0.92 * reach} ${0.92 * reach}h${bar}` }));
  const keys = ways.map(({ name, colour }) => html("span", { class: `key c${colour}` }, html("i", { class: "line" }), name));
  const text = `True to scale; the bar at the lower left is ${bar} mm. The dashed line is the file, the band a line of ${BEAD_MM} mm.`;
  return section("corner", `The corner that rings most: line ${line}, X${x0.toFixed(1)} Y${y0.toFixed(1)}`,
    html("div", { class: "drawing" }, html("p", { class: "legend" }, ...keys), drawing), note(text));
}

/** Each shaper as a point: how far corners are rounded, and how much rings. */
function trade(points) {
  const [, right, xStep] = scaleOf([0, ...points.map(({ rounding_um }) => 1.05 * rounding_um)]);
  const [, top, yStep] = scaleOf([0, ...points.map(({ ringing_um }) => 1.05 * ringing_um)]);
  const [wide, high] = [WIDE - LEFT - RIGHT, HIGH - TOP - BOTTOM];
  const [x, y] = [(v) => LEFT + (wide * v) / right, (v) => TOP + high * (1 - v / top)];
  const drawing = svg("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, role: "img", "aria-label": "Ringing against rounding of corners" });
  for (const v of ticks(0, top, yStep)) {
    drawing.append(svg("path", { class: "grid", d: `M${LEFT} ${y(v)}h${wide}` }));
    drawing.append(svg("text", { x: LEFT - 6, y: y(v) + 4, "text-anchor": "end" }, label(v, yStep)));
  }
  for (const v of ticks(0, right, xStep)) {
    drawing.append(svg("text", { x: x(v), y: TOP + high + 16, "text-anchor": "middle" }, label(v, xStep)));
  }
  drawing.append(svg("text", { x: LEFT + wide / 2, y: TOP + high + 34, "text-anchor": "middle" }, "corners rounded by, µm"));
  const taken = points.map((p) => [x(p.rounding_um) - 5, y(p.ringing_um) - 5, x(p.rounding_um) + 5, y(p.ringing_um) + 5]);
  for (const { name, rounding_um, ringing_um } of points) {
    const [px, py] = [x(rounding_um), y(ringing_um)];
    const place = freePlace(px, py, name, taken, LEFT + wide);
    taken.push(place.box);
    drawing.append(svg("circle", { class: "c1", cx: px, cy: py, r: 4.5 }));
    drawing.append(svg("text", { class: "name", x: place.x, y: place.y, "text-anchor": place.anchor }, name));
  }
  return section("trade", "What a shaper costs: ringing in µm against rounding", html("div", { class: "drawing" }, drawing),
    note("Near the lower left corner is best. Ringing is the mean of that on tune and 10 % off tune."));
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

/** A small chart for each trial, all in one scale, with the first trial in grey. */
function cards({ title, text, unit, zero, trials: shown, from_s, to_s }) {
  const values = shown.flatMap(({ series }) => series.v);
  const scale = [zero, ...values.filter(Number.isFinite)];
  const bounds = [scale.reduce((a, b) => Math.min(a, b)), scale.reduce((a, b) => Math.max(a, b))];
  const columns = COLUMNS_S.map((s) => [s, String(1000 * s)]);
  const figures = shown.map(({ name, figure: value, series }, i) => {
    const grey = i ? [{ name: shown[0].name, colour: 6, series: shown[0].series }] : [];
    const plot = new Plot({ title: name, unit, curves: [...grey, { name, colour: i === data.best ? 2 : 1, series }] }, bounds);
    soon(() => plot.draw(from_s, to_s, columns, ""));
    return html("figure", best(i), html("figcaption", {}, html("b", {}, name), html("span", {}, value)), plot.node);
  });
  return section("cards wide", title, note(`${text} Vertical: ${unit}; horizontal: ms since the corner.`), html("div", {}, ...figures));
}

main.append(section("verdict wide", "The best setting", html("p", {}, html("b", {}, data.name)), html("p", {}, data.reason)), trials(data.trials));
if (data.corner) main.append(corner(data.corner), trade(data.trade), ...data.cards.map(cards));
