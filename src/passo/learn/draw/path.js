/** The path of a print, one layer from above, each line in the colour of its speed. */

import { clamp, html, soon, svg, textsAlong } from "./dom.js";
import { gestures } from "./gestures.js";
import { figure, label, roundStep, ticks } from "./labels.js";
import { bytes } from "./series.js";
import { css, ramp } from "./shades.js";

const COLOURS = 12; // of speeds, as `Toolpath.data` in Python has them
const THREAD_MM = 0.4; // width of extruded lines

const speedColour = (colour) => css(ramp((colour - 0.5) / COLOURS));

/** The path in the page, at `node`. `changed` is called after another layer is shown. */
export class PathPlot {
  constructor(data, changed) {
    this.data = data;
    this.changed = changed;
    this.ends = new Uint16Array(bytes(data.ends));
    this.colours = new Uint8Array(bytes(data.colours));
    this.top = data.layers.length - 1;
    this.layer = this.before = data.layer;
    this.box = data.view;
    this.grid = svg("path", { class: "grid" });
    this.lines = Array.from({ length: COLOURS + 1 }, (_, colour) =>
      colour ? svg("path", { stroke: speedColour(colour) }) : svg("path", { class: "travel" }));
    const [bx0, by0, bx1, by1] = data.bed;
    const bed = svg("path", { class: "bed", d: `M${bx0} ${by0}H${bx1}V${by1}H${bx0}z` });
    this.threads = svg("g", { class: "lines" }, ...this.lines);
    this.drawing = svg("svg", { preserveAspectRatio: "none", "aria-hidden": "true" });
    this.drawing.append(svg("g", { transform: "scale(1,-1)" }, this.grid, bed, this.threads));
    [this.y, this.x] = [html("div", { class: "y" }), html("div", { class: "x" })];
    const name = "Toolpath of one layer from above, X and Y in mm, coloured by speed";
    this.plot = html("div", { class: "plot", role: "img", "aria-label": name }, this.drawing, this.y, this.x);
    const axis = html("div", { class: "axis" }, html("span", {}, "Y, mm"));
    this.control = html("div", { class: "control" });
    this.node = html("div", { class: "drawing path" }, this.legend(), axis, this.plot, html("div", { class: "under" }, "X, mm"), this.control);
    this.title = html("span");
    this.controls();
    gestures(this.plot, this);
    this.drawLayer();
  }

  legend() {
    const scale = html("span", { class: "scale" }, "0 ");
    for (let colour = 1; colour <= COLOURS; colour++) {
      const one = html("i");
      one.style.background = speedColour(colour);
      scale.append(one);
    }
    scale.append(` ${this.data.fastest.toFixed(0)} mm/s`);
    const travel = this.data.prints ? [html("span", { class: "key" }, html("i", { class: "line travel" }), "travel")] : [];
    const what = this.data.prints ? "extruding" : "all moves: nothing is extruded";
    return html("p", { class: "legend" }, scale, what, ...travel);
  }

  controls() {
    if (this.top > 0) {
      this.slider = html("input", { type: "range", min: 0, max: this.top, id: "layer" });
      this.slider.oninput = () => this.show(+this.slider.value);
      this.control.append(html("label", {}, "Layer", this.slider));
    }
    if (this.data.prints && this.colours.includes(0)) {
      const box = html("input", { type: "checkbox", checked: "" });
      box.onchange = () => this.node.classList.toggle("still", !box.checked);
      this.control.append(html("label", { class: "box" }, box, "travel moves"));
    }
    const whole = html("button", { type: "button", title: "Shows the whole layer (double click, 0)" }, "Whole");
    whole.onclick = () => this.reset();
    this.control.append(whole);
  }

  drawLayer() {
    const { layers, origin, unit } = this.data;
    const parts = this.lines.map(() => []);
    const at = (i, k) => (origin[k % 2] + unit * this.ends[4 * i + k]).toFixed(3);
    const stop = this.layer < this.top ? layers[this.layer + 1][0] : this.colours.length;
    for (let i = layers[this.layer][0]; i < stop; i++) {
      parts[this.colours[i]].push(`M${at(i, 0)} ${at(i, 1)}L${at(i, 2)} ${at(i, 3)}`);
    }
    parts.forEach((all, colour) => this.lines[colour].setAttribute("d", all.join("")));
    const z = layers[this.layer][1];
    const name = this.layer ? `layer ${this.layer} of ${this.top}` : "before the first layer";
    if (this.top > 0) this.title.textContent = `: ${name}${this.layer && z !== undefined ? `, Z ${figure(z)} mm` : ""}`;
    if (this.slider) this.slider.value = this.layer;
  }

  draw() {
    const [x0, y0, x1, y1] = this.box;
    const [wide, high, pixels] = [x1 - x0, y1 - y0, this.plot.clientWidth || 600];
    this.drawing.setAttribute("viewBox", `${x0} ${-y1} ${wide} ${high}`);
    this.threads.setAttribute("stroke-width", Math.max(THREAD_MM, wide / pixels));
    const step = roundStep(wide, Math.max(4, Math.floor(pixels / 80)));
    const [xs, ys] = [ticks(x0, x1, step), ticks(y0, y1, step)];
    this.grid.setAttribute("d", xs.map((x) => `M${x} ${y0}V${y1}`).join("") + ys.map((y) => `M${x0} ${y}H${x1}`).join(""));
    textsAlong(this.y, "top", ys.map((y) => [(y1 - y) / high, label(y, step)]));
    textsAlong(this.x, "left", xs.map((x) => [(x - x0) / wide, label(x, step)]));
    this.plot.style.touchAction = wide < 0.999 * (this.data.view[2] - this.data.view[0]) ? "none" : "pan-y";
  }

  /** Moves the view, within some space around the whole. True if it has changed. */
  go(x0, y0, wide) {
    const { bed, view } = this.data;
    const full = view[2] - view[0];
    const tall = (view[3] - view[1]) / full;
    const space = Math.max(full, bed[2] - bed[0]);
    wide = clamp(wide, Math.min(1, full), Math.max(full, 1.2 * (bed[2] - bed[0])));
    x0 = clamp(x0, view[0] - space, view[2] + space - wide);
    y0 = clamp(y0, view[1] - space, view[3] + space - wide * tall);
    const other = Math.abs(wide - (this.box[2] - this.box[0])) > 1e-9 || x0 !== this.box[0] || y0 !== this.box[1];
    this.box = [x0, y0, x0 + wide, y0 + wide * tall];
    soon(this.redraw);
    return other;
  }

  redraw = () => this.draw();

  move(dx, dy) {
    const [x0, y0, x1, y1] = this.box;
    return this.go(x0 - dx * (x1 - x0), y0 + dy * (y1 - y0), x1 - x0);
  }

  zoom(x, y, by) {
    const { view } = this.data;
    const [full, wide, high] = [view[2] - view[0], this.box[2] - this.box[0], this.box[3] - this.box[1]];
    if (by > 1 && wide >= 0.999999 * full) return false;
    const now = clamp(wide * by, Math.min(1, full), full);
    if (now === full) return this.go(view[0], view[1], full);
    return this.go(this.box[0] + x * (wide - now), this.box[1] + (1 - y) * (high / wide) * (wide - now), now);
  }

  reset() {
    this.box = this.data.view;
    soon(this.redraw);
  }

  show(layer) {
    const now = clamp(Math.round(layer), 0, this.top);
    if (now === this.layer) return;
    this.layer = now;
    this.drawLayer();
    this.changed();
  }

  /** The time of the layer that is shown, from and to in s; null if there is one layer only. */
  during() {
    const layer = this.data.layers[this.layer];
    return this.top > 0 && layer.length > 1 ? layer.slice(2) : null;
  }

  layerAt(t) {
    return this.data.layers.findLastIndex(([, , start_s]) => start_s !== undefined && start_s <= t);
  }

  showAt(t) {
    this.before = this.layer;
    if (this.top > 0) this.show(Math.max(0, this.layerAt(t)));
  }

  back() {
    this.show(this.before);
  }
}
