/** Curves of one unit over one axis: legend, unit, curves, and round labels. */

import { html, svg, textsAlong } from "./dom.js";
import { figure, label, roundStep, ticks } from "./labels.js";
import { decode, part, valueAt } from "./series.js";

const ROWS = 5; // labels of values, at most
const SIDE = 1000; // of the square that SVG scales to the plot

/**
 * A curve: its name in the legend, its colour of the palette (a dashed one is the target of the other
 * of the same colour), and its series.
 * @typedef {{ name: string, colour: number, dashed?: boolean, series: object }} Curve
 * @typedef {{ title: string, unit: string, curves: Curve[] }} Chart
 */

/** A chart in the page, at `node`. `values` are those that its axis always reaches. */
export class Plot {
  /** @param {Chart} chart @param {number[]} [values] */
  constructor({ title, unit, curves }, values = [0]) {
    this.curves = curves.map(({ series }) => decode(series));
    this.values = values;
    this.grid = svg("path", { class: "grid" });
    const colours = curves.map(({ colour }) => `c${colour}`);
    this.bands = colours.map((colour) => svg("path", { class: `band ${colour}` }));
    this.lines = curves.map(({ dashed }, i) => svg("path", { class: `line ${colours[i]}${dashed ? " dashed" : ""}` }));
    this.readings = curves.map(() => html("b"));
    const keys = curves.map(({ name, dashed }, i) =>
      html("span", { class: `key ${colours[i]}` }, html("i", { class: dashed ? "line dashed" : "line" }), name, this.readings[i]));
    const drawing = svg("svg", { viewBox: `0 0 ${SIDE} ${SIDE}`, preserveAspectRatio: "none", "aria-hidden": "true" });
    drawing.append(this.grid, ...this.bands.flatMap((band, i) => [band, this.lines[i]]));
    [this.y, this.x] = [html("div", { class: "y" }), html("div", { class: "x" })];
    this.cursor = html("div", { class: "cursor" });
    this.plot = html("div", { class: "plot", role: "img", "aria-label": `${title}, ${unit}` }, drawing, this.y, this.x, this.cursor);
    this.under = html("div", { class: "under" });
    const axis = html("div", { class: "axis" }, html("span", {}, unit));
    this.node = html("div", { class: "drawing chart" }, html("p", { class: "legend" }, ...keys), axis, this.plot, this.under);
  }

  /** Other values of the curves, in their order. */
  setSeries(series) {
    this.curves = series.map(decode);
  }

  get width() {
    return this.plot.clientWidth || 600;
  }

  /**
   * Shows `from` to `to`, with these places and texts on the axis, and what they mean below.
   * @type {(from: number, to: number, columns: [number, string][], under: string) => void}
   */
  draw(from, to, columns, under) {
    const parts = this.curves.map((series) => part(series, from, to, this.width));
    const [low, high, step] = scaleOf([...this.values, ...parts.flatMap(extremes)]);
    const x = (t) => (SIDE * (t - from)) / (to - from);
    const y = (v) => (SIDE * (high - v)) / (high - low);
    const rows = ticks(low, high, step);
    this.grid.setAttribute("d", rows.map((v) => `M0 ${y(v)}H${SIDE}`).join("") + columns.map(([t]) => `M${x(t)} 0V${SIDE}`).join(""));
    textsAlong(this.y, "top", rows.map((v) => [y(v) / SIDE, label(v, step)]));
    textsAlong(this.x, "left", columns.map(([t, text]) => [x(t) / SIDE, text]));
    this.under.textContent = under;
    const lineOf = (points) => lined(points.map(([t, v]) => [x(t), y(v)]));
    parts.forEach(({ points, band }, i) => {
      this.lines[i].setAttribute("d", lineOf(points));
      const edge = [...band.map(([t, , v]) => [t, v]), ...band.map(([t, v]) => [t, v]).reverse()];
      this.bands[i].setAttribute("d", edge.length ? `${lineOf(edge)}z` : "");
    });
  }

  /** Shows a cursor at a fraction of the plot, and the values at `t`; null: neither. */
  read(fraction, t) {
    this.cursor.style.display = fraction === null ? "none" : "block";
    if (fraction !== null) this.cursor.style.left = `${100 * fraction}%`;
    this.curves.forEach((series, i) => {
      const texts = fraction === null ? undefined : valueAt(series, t)?.map(figure);
      this.readings[i].textContent = !texts ? "" : texts[0] === texts[1] ? texts[0] : texts.join(" to ");
    });
  }
}

function extremes({ points, band }) {
  const all = [...points.map(([, v]) => v), ...band.flatMap(([, a, b]) => [a, b])].filter(Number.isFinite);
  return all.length ? [all.reduce((a, b) => Math.min(a, b)), all.reduce((a, b) => Math.max(a, b))] : [];
}

/**
 * Round bounds around values, and the step between labels.
 * @type {(values: number[]) => [number, number, number]}
 */
export function scaleOf(values) {
  let [low, high] = [Math.min(...values), Math.max(...values)];
  if (low === high) high += 1;
  const step = roundStep(high - low, ROWS);
  return [step * Math.floor(low / step + 1e-6), step * Math.ceil(high / step - 1e-6), step];
}

/**
 * The path through points, which begins anew after a gap.
 * @type {(points: [number, number][], digits?: number) => string}
 */
export function lined(points, digits = 2) {
  let joins = false;
  return points.map(([x, y]) => {
    const known = Number.isFinite(y);
    const text = known ? `${joins ? "L" : "M"}${x.toFixed(digits)} ${y.toFixed(digits)}` : "";
    joins = known;
    return text;
  }).join("");
}
