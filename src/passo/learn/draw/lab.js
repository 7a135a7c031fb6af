/** The page of `passo lab`: the trials of a file in a table, and pictures of one corner. */

import { lined, Plot } from "./chart.js";
import { html, soon, svg } from "./dom.js";
import { data, main, section } from "./pages.js";
import { scatter } from "./scatter.js";

const BEAD_MM = 0.45; // the width of a printed line
const COLUMNS_S = [0, 0.05, 0.1];

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
  const shown = points.map(({ name, rounding_um, ringing_um }) => ({ name, x: rounding_um, y: ringing_um, colour: 1 }));
  const drawing = scatter(shown, { across: "corners rounded by, µm", text: "Ringing against rounding of corners" });
  return section("trade", "What a shaper costs: ringing in µm against rounding", html("div", { class: "drawing" }, drawing),
    note("Near the lower left corner is best. Ringing is the mean of that on tune and 10 % off tune."));
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
