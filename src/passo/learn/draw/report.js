/** The page of `passo report`: pictures of a print, with one time axis for all charts. */

import { bars } from "./bars.js";
import { Plot } from "./chart.js";
import { clamp, html, soon, svg } from "./dom.js";
import { gestures } from "./gestures.js";
import { clockLabel, clockUnit, label, roundStep, ticks, timeStep } from "./labels.js";
import { data, main, section, table } from "./pages.js";
import { PathPlot } from "./path.js";
import { decode, valueAt } from "./series.js";
import { shadeOfHeight } from "./shades.js";

const LEAST_RANGE_MM = 0.05; // heights that differ less look the same
const HELP = "Drag to zoom in; wheel or two fingers zoom; Shift and drag, or one finger, moves; double click shows all."
  + " A click shows its layer.";

// -- sections

const path = data.path && new PathPlot(data.path, () => {
  remember();
  soon(drawCharts);
});
const plots = data.charts.map((chart) => {
  const plot = new Plot(chart);
  plot.select = plot.plot.appendChild(html("div", { class: "select" }));
  plot.during = plot.plot.appendChild(html("div", { class: "during" }));
  return plot;
});

function firstLayer({ area: [x0, y0, x1, y1], cells, mean_mm, text }) {
  const [wide, high] = [(x1 - x0) / cells[0].length, (y1 - y0) / cells.length];
  const known = cells.flatMap((row, j) => row.flatMap((mm, i) => (mm === null ? [] : [{ mm, x: x0 + i * wide, y: y0 + j * high }])));
  const most = Math.max(LEAST_RANGE_MM, ...known.map(({ mm }) => Math.abs(mm - mean_mm)));
  const drawing = svg("svg", { viewBox: `${x0} ${-y1} ${x1 - x0} ${y1 - y0}`, role: "img", "aria-label": text });
  for (const { mm, x, y } of known) {
    const place = `X${(x + wide / 2).toFixed(0)} Y${(y + high / 2).toFixed(0)}`;
    const title = svg("title", {}, `${place}: ${mm.toFixed(3)} mm`);
    drawing.append(svg("rect", { x, y: -y - high, width: wide, height: high, fill: shadeOfHeight(mean_mm - mm, most) }, title));
  }
  drawing.append(svg("path", { class: "bed", d: `M${x0} ${-y0}H${x1}V${-y1}H${x0}z` }));
  const note = html("p", { class: "note" }, `${text}. Red: nearer to the bed than on average; blue: farther from it.`);
  return section("bed", "First layer", drawing, note);
}

function filters({ title, took_s, columns_ms, start_s, charts }) {
  const [first, last] = columns_ms;
  const step = roundStep(last - first, 6);
  const columns = ticks(first, last, step).map((ms) => [(ms - first) / 1e3, label(ms, step)]);
  const link = html("a", { href: `#t=${start_s.toFixed(4)},${(start_s + took_s).toFixed(4)}` }, "Show this time in the charts above");
  const note = html("p", { class: "note" },
    "Dashed: the plan. Solid: what the motors execute, with shapers, limit of jerk, pressure advance and backlash. The plan is drawn"
    + " later by the time by which all motors follow it. ", link, ".");
  return section("filters", title, note, ...charts.flatMap((chart) => {
    const plot = new Plot(chart);
    soon(() => plot.draw(0, took_s, columns, "ms after the corner"));
    return [html("h3", {}, chart.title), plot.node];
  }));
}

if (data.problems.length) {
  main.append(section("problems", "The print stopped", html("ul", {}, ...data.problems.map((text) => html("li", {}, text)))));
}
if (path) {
  const made = section("toolpath", "Toolpath", path.node);
  made.querySelector("h2").append(path.title);
  main.append(made);
}
const side = [
  ...(data.result.length ? [section("result", "Result", table(data.result))] : []),
  ...(data.first_layer ? [firstLayer(data.first_layer)] : []),
  ...(data.limits.length ? [section("shares", "What limits the speed: seconds by limit", bars(data.limits))] : []),
];
if (side.length) main.append(html("div", { class: "side" }, ...side));
const zoomBar = html("div", { class: "zoom" });
const output = html("output");
if (plots.length) {
  main.append(zoomBar, ...plots.map((plot, i) => section("wide", data.charts[i].title, plot.node)));
  if (data.finest_s) {
    main.append(html("p", { class: "note wide" }, `The charts of moves have columns of ${data.finest_s} s: the line is the mean within each,`
      + " the band reaches from the lowest to the highest value."));
  }
}
if (data.filters) main.append(filters(data.filters));
if (data.features.length > 1) main.append(section("shares wide", "Time by feature", bars(data.features)));

// -- the part of the time that all charts show

const end = data.end_s;
const finest = Math.min(end, data.finest_s ? 16 * data.finest_s : 1e-3);
const line = data.line && decode(data.line);
let view = [0, end];
let cursor = null; // a fraction of the view

function strip(node, range) {
  node.style.display = range ? "block" : "none";
  if (!range) return;
  const [a, b] = range.map((x) => clamp(x, 0, 1));
  node.style.left = `${100 * a}%`;
  node.style.width = `${100 * (b - a)}%`;
}

function drawCharts() {
  const [t0, t1] = view;
  const layer = path?.during();
  for (const plot of plots) {
    const step = timeStep(t1 - t0, Math.max(4, Math.floor(plot.width / 90)));
    const columns = ticks(t0, t1, step).map((t) => [t, clockLabel(t, step, t1)]);
    plot.draw(t0, t1, columns, `print time, ${clockUnit(step, t1)}`);
    strip(plot.during, layer && layer[1] > t0 && layer[0] < t1 && layer.map((t) => (t - t0) / (t1 - t0)));
  }
  readings();
}

function readings() {
  const [t0, t1] = view;
  const t = cursor === null ? null : t0 + cursor * (t1 - t0);
  for (const plot of plots) plot.read(cursor, t);
  const step = Math.min(1, (t1 - t0) / 500);
  const name = (x) => clockLabel(x, step, end);
  if (t === null) {
    output.textContent = `${name(t0)} to ${name(t1)} (${clockUnit(step, end)})`;
    return;
  }
  const [first, last] = (line && valueAt(line, t)?.map(Math.round)) || [];
  const lines = first ? `, line ${first === last ? first : `${first} to ${last}`}` : "";
  const layer = path?.layerAt(t);
  output.textContent = `at ${name(t)}${lines}${layer > 0 ? `, layer ${layer}` : ""}`;
}

/** True if that is something else than before. */
function show(a, b) {
  const span = clamp(b - a, finest, end);
  const start = clamp((a + b - span) / 2, 0, end - span);
  const other = start !== view[0] || start + span !== view[1];
  view = [start, start + span];
  soon(drawCharts);
  remember();
  return other;
}

const at = (x) => view[0] + x * (view[1] - view[0]);
const time = {
  move: (dx) => show(at(-dx), at(1 - dx)),
  zoom(x, y, by) {
    const span = clamp((view[1] - view[0]) * by, finest, end);
    return show(at(x) - x * span, at(x) + (1 - x) * span);
  },
  zoomTo: (a, b) => show(at(a), at(b)),
  reset: () => {
    path?.back();
    show(0, end);
  },
  select: (a, b) => plots.forEach((plot) => strip(plot.select, a !== null && [Math.min(a, b), Math.max(a, b)])),
  hover(x) {
    cursor = x === null ? null : clamp(x, 0, 1);
    soon(readings);
  },
  click: (x) => path?.showAt(at(x)),
};

const BUTTONS = [
  ["\u2212", "Zoom out (-)", () => time.zoom(0.5, 0, 2)],
  ["+", "Zoom in (+)", () => time.zoom(0.5, 0, 0.5)],
  ["\u2190", "Earlier (left arrow)", () => time.move(0.25)],
  ["\u2192", "Later (right arrow)", () => time.move(-0.25)],
  ["All", "The whole print (double click, 0)", () => show(0, end)],
];
const buttons = BUTTONS.map(([text, title, act]) => {
  const made = html("button", { type: "button", title, ...(text.length === 1 && { "aria-label": title }) }, text);
  made.onclick = act;
  return made;
});
zoomBar.append(output, html("span", {}, ...buttons), html("small", {}, HELP));
for (const plot of plots) gestures(plot.plot, time);

// -- the address keeps what is shown: #t=1.5,2.5&layer=3

let written;
function remember() {
  clearTimeout(written);
  written = setTimeout(() => {
    const parts = [];
    if (view[0] > 0 || view[1] < end) parts.push(`t=${view.map((t) => +t.toFixed(4)).join(",")}`);
    if (path && path.layer !== data.path.layer) parts.push(`layer=${path.layer}`);
    try {
      history.replaceState(null, "", parts.length ? `#${parts.join("&")}` : location.pathname + location.search);
    } catch { /* a page within another one may have no address of its own */ }
  }, 200);
}

function recall() {
  const words = new URLSearchParams(location.hash.slice(1));
  const times = (words.get("t") ?? "").split(",").map(Number);
  if (plots.length && times.length === 2 && times[1] > times[0]) show(...times);
  if (path && words.has("layer")) path.show(+words.get("layer") || 0);
}

function draw() {
  drawCharts();
  path?.draw();
}
recall();
draw();
addEventListener("resize", () => soon(draw));
addEventListener("hashchange", recall);
