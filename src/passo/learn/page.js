"use strict";
// Zooms the pictures of a page that is complete without it: charts with one time axis, and the path.
(() => {
const data = JSON.parse(document.getElementById("data").textContent);
const root = document.documentElement;
root.classList.add("live");
const make = (kind, parent, name = "") => {
  const node = document.createElement(kind);
  node.className = name;
  return parent.appendChild(node);
};
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;

// -- round values, with the rules of labels.py
const SECONDS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 28800, 86400];
function roundStep(span, most) {
  if (!(span > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(span / most));
  return [1, 2, 5, 10, 20].find(step => step * power * most >= span * 0.999999) * power;
}
function timeStep(span, most) {
  if (span <= most) return roundStep(span, most);
  return SECONDS.find(s => s * most >= span) || 86400 * Math.ceil(span / most / 86400);
}
function ticks(low, high, step) {
  const all = [];
  for (let i = Math.ceil(low / step - 1e-6); i <= Math.floor(high / step + 1e-6); i++) all.push(i * step);
  return all;
}
const decimals = step => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
function label(value, step) {
  const digits = decimals(step), options = { minimumFractionDigits: digits, maximumFractionDigits: digits };
  return (+value.toFixed(digits) || 0).toLocaleString("en", options).replace("-", "\u2212");
}
const two = n => String(n).padStart(2, "0");
function clockLabel(seconds, step, longest) {
  if (longest <= 120) return label(seconds, step);
  const digits = step < 1 ? decimals(step) : 0, whole = +seconds.toFixed(digits);
  const minutes = Math.floor(whole / 60 + 1e-9), rest = Math.max(0, whole - 60 * minutes).toFixed(digits);
  const tail = ":" + rest.padStart(digits ? digits + 3 : 2, "0");
  if (longest <= 3600) return minutes + tail;
  return Math.floor(minutes / 60) + ":" + two(minutes % 60) + (step < 60 ? tail : "");
}
const clockUnit = (step, longest) =>
  longest <= 120 ? "s" : longest <= 3600 ? "min:s" : step >= 60 ? "h:min" : "h:min:s";
const figure = value => (+value.toPrecision(4)).toLocaleString("en", { maximumSignificantDigits: 4 }).replace("-", "\u2212");

// -- series: exact corners, or columns with the lowest, highest and mean value
function decode(e) {
  if (e.w) {
    const [low, high, mean] = [e.low, e.high, e.mean].map(text => new Int16Array(bytes(text)));
    return { width: e.w, scale: e.scale, low, high, mean };
  }
  const steps = new Float32Array(bytes(e.s)), times = new Float64Array(steps.length);
  let sum = 0;
  steps.forEach((step, i) => { times[i] = sum += step; });
  return { times, values: new Float32Array(bytes(e.v)) };
}
function firstAfter(times, t) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1; else high = middle;
  }
  return low;
}
function between(s, i, t) {  // the value at t, from corner i - 1 to corner i
  const { times, values } = s, span = times[i] - times[i - 1];
  return span > 0 ? values[i - 1] + (values[i] - values[i - 1]) * (t - times[i - 1]) / span : values[i];
}
// The lowest and the highest value at a time; null where nothing is known.
function valueAt(s, t) {
  if (s.width) {
    const k = Math.floor(t / s.width);
    if (!(k < s.low.length) || s.low[k] === -32768) return null;
    return [s.low[k] * s.scale, s.high[k] * s.scale];
  }
  const i = firstAfter(s.times, t);
  if (i === 0 || (i === s.times.length && t > s.times[i - 1])) return null;
  const value = i === s.times.length ? s.values[i - 1] : between(s, i, t);
  return [value, value];
}
// What is to be drawn of t0 to t1 in `most` columns: points of a line, and a band where there is
// more in a column than a line can show.
function part(s, t0, t1, most) {
  const points = [], band = [];
  if (!s.width) {
    const first = firstAfter(s.times, t0), last = firstAfter(s.times, t1);
    if (last - first <= 2 * most) {
      if (first > 0 && first < s.times.length) points.push([t0, between(s, first, t0)]);
      for (let i = first; i < last; i++) points.push([s.times[i], s.values[i]]);
      if (last > 0 && last < s.times.length) points.push([t1, between(s, last, t1)]);
      return { points, band };
    }
  }
  const width = s.width && (t1 - t0) / s.width <= most ? s.width : (t1 - t0) / most;
  const from = width === s.width ? Math.floor(t0 / width) * width : t0, size = Math.ceil((t1 - from) / width);
  const low = new Float64Array(size).fill(Infinity), high = new Float64Array(size).fill(-Infinity);
  const area = new Float64Array(size), span = new Float64Array(size);
  const put = (k, a, b, sum, time) => {
    if (k < 0 || k >= size) return;
    low[k] = Math.min(low[k], a); high[k] = Math.max(high[k], b); area[k] += sum; span[k] += time;
  };
  if (s.width) {
    const stop = Math.min(s.low.length, Math.ceil(t1 / s.width));
    for (let i = Math.max(0, Math.floor(t0 / s.width)); i < stop; i++)
      if (s.low[i] !== -32768)
        put(Math.floor(((i + 0.5) * s.width - from) / width), s.low[i] * s.scale, s.high[i] * s.scale,
          s.mean[i] * s.scale * s.width, s.width);
  } else {
    for (let i = Math.max(1, firstAfter(s.times, t0)); i < s.times.length && s.times[i - 1] < t1; i++) {
      let a = Math.max(t0, s.times[i - 1]);
      const end = Math.min(t1, s.times[i]);
      for (let k = Math.floor((a - from) / width); a < end && k < size; k++) {
        const b = Math.min(end, from + (k + 1) * width), u = between(s, i, a), v = between(s, i, b);
        if (b > a) put(k, Math.min(u, v), Math.max(u, v), (u + v) / 2 * (b - a), b - a);
        a = Math.max(a, b);
      }
    }
  }
  for (let k = 0; k < size; k++) {
    if (!span[k]) continue;
    const a = Math.max(t0, from + k * width), b = Math.min(t1, from + (k + 1) * width), mean = area[k] / span[k];
    const ends = width === s.width ? [a, b] : [(a + b) / 2];
    for (const t of ends) { points.push([t, mean]); band.push([t, low[k], high[k]]); }
  }
  return { points, band };
}

// -- mouse, touch and keys on a plot; places are fractions of it from the top left corner
let scrolled = -1e9;  // when the wheel last scrolled the page: it is not taken from it halfway
addEventListener("wheel", e => { if (!e.defaultPrevented) scrolled = e.timeStamp; }, { passive: true });
function gestures(plot, on) {
  const down = new Map();
  let from = null, moved = false, selects = false, tapped = -1e9;
  const place = e => {
    const box = plot.getBoundingClientRect();
    return [(e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height];
  };
  plot.tabIndex = 0;
  plot.addEventListener("wheel", e => {
    const [x, y] = place(e), across = Math.abs(e.deltaX) > Math.abs(e.deltaY);
    const by = (across ? e.deltaX : e.deltaY) * [1, 16, 400][e.deltaMode];
    if (e.timeStamp - scrolled < 400 || !(across ? on.move(-by / 600, 0) : on.zoom(x, y, 1.0018 ** clamp(by, -300, 300)))) return;
    e.preventDefault();
  }, { passive: false });
  plot.addEventListener("pointerdown", e => {
    if (e.button > 1) return;
    down.set(e.pointerId, place(e));
    plot.setPointerCapture(e.pointerId);
    if (down.size > 1) { from = null; on.select?.(null); return; }
    from = place(e);
    moved = false;
    selects = on.select && e.pointerType === "mouse" && e.button === 0 && !e.shiftKey;
    if (e.button === 1) e.preventDefault();
  });
  plot.addEventListener("pointermove", e => {
    const now = place(e), last = down.get(e.pointerId), box = plot.getBoundingClientRect();
    on.hover?.(...now);
    if (!last) return;
    if (from && Math.hypot((now[0] - from[0]) * box.width, (now[1] - from[1]) * box.height) > 4) moved = true;
    if (down.size === 2) {
      const [other] = [...down].filter(([id]) => id !== e.pointerId).map(([, at]) => at);
      const apart = at => Math.max(20, Math.hypot((at[0] - other[0]) * box.width, (at[1] - other[1]) * box.height));
      on.move((now[0] - last[0]) / 2, (now[1] - last[1]) / 2);
      on.zoom((now[0] + other[0]) / 2, (now[1] + other[1]) / 2, apart(last) / apart(now));
    } else if (moved && selects) {
      on.select(from[0], now[0]);
    } else if (moved) {
      on.move(now[0] - last[0], now[1] - last[1]);
    }
    down.set(e.pointerId, now);
  });
  const up = e => {
    if (!down.delete(e.pointerId)) return;
    const now = place(e), begun = from;
    from = null;
    on.select?.(null);
    if (e.type === "pointercancel" || !begun) return;
    if (moved && selects) on.zoomTo(Math.min(begun[0], now[0]), Math.max(begun[0], now[0]));
    if (moved) return;
    if (e.timeStamp - tapped < 400) on.reset(); else on.click?.(...now);
    tapped = e.timeStamp;
  };
  plot.addEventListener("pointerup", up);
  plot.addEventListener("pointercancel", up);
  plot.addEventListener("pointerleave", () => on.hover?.(null));
  plot.addEventListener("keydown", e => {
    const keys = {
      ArrowLeft: () => on.move(0.1, 0), ArrowRight: () => on.move(-0.1, 0), ArrowUp: () => on.move(0, 0.1),
      ArrowDown: () => on.move(0, -0.1), "+": () => on.zoom(0.5, 0.5, 0.7), "=": () => on.zoom(0.5, 0.5, 0.7),
      "-": () => on.zoom(0.5, 0.5, 1 / 0.7), 0: () => on.reset(), Home: () => on.reset(), Escape: () => on.reset(),
    };
    if (e.ctrlKey || e.metaKey || e.altKey || !keys[e.key]) return;
    if (keys[e.key]() !== false) e.preventDefault();
  });
}
const drawn = new Set();
function soon(draw) {  // once before the next frame
  if (!drawn.size) requestAnimationFrame(() => { const all = [...drawn]; drawn.clear(); all.forEach(f => f()); });
  drawn.add(draw);
}
const spans = (node, side, rows) => {
  node.replaceChildren(...rows.map(([at, text]) => {
    const span = document.createElement("span");
    span.style[side] = 100 * at + "%";
    span.textContent = text;
    return span;
  }));
};

// -- charts, all of the same part of the time
const end = data.end_s, zoomBar = document.querySelector(".zoom"), output = document.getElementById("shown");
const finest = Math.min(end, data.finest_s ? 16 * data.finest_s : 1e-3);
const line = data.line ? decode(data.line) : null;
let view = [0, end], cursor = null, path = null;  // the cursor is a fraction of the view
const charts = data.charts.map(chart => {
  const node = document.querySelector(`.chart[data-key="${chart.key}"]`), plot = node.querySelector(".plot");
  const paths = [...plot.querySelectorAll("path")];
  const [during, select, hair] = ["during", "select", "cursor"].map(name => make("div", plot, name));
  return {
    node, plot, during, select, hair, grid: paths[0], bands: paths.filter(p => p.matches(".band")),
    lines: paths.filter(p => p.matches(".line")), readings: [...node.querySelectorAll(".k b")],
    curves: chart.curves.map(decode),
  };
});
function drawChart(c) {
  const [t0, t1] = view, wide = c.plot.clientWidth || 600;
  const parts = c.curves.map(s => part(s, t0, t1, wide));
  let low = 0, high = 0;
  for (const { points, band } of parts) {
    for (const [, v] of points) { low = Math.min(low, v); high = Math.max(high, v); }
    for (const [, a, b] of band) { low = Math.min(low, a); high = Math.max(high, b); }
  }
  if (low === high) high = 1;
  const step = roundStep(high - low, 5);
  low = step * Math.floor(low / step + 1e-6); high = step * Math.ceil(high / step - 1e-6);
  const X = t => (1000 * (t - t0) / (t1 - t0)).toFixed(2), Y = v => (1000 * (high - v) / (high - low)).toFixed(1);
  const each = timeStep(t1 - t0, Math.max(4, Math.floor(wide / 90))), times = ticks(t0, t1, each), rows = ticks(low, high, step);
  c.grid.setAttribute("d", rows.map(v => `M0 ${Y(v)}H1000`).join("") + times.map(t => `M${X(t)} 0V1000`).join(""));
  spans(c.plot.querySelector(".y"), "top", rows.map(v => [(high - v) / (high - low), label(v, step)]));
  spans(c.plot.querySelector(".x"), "left", times.map(t => [(t - t0) / (t1 - t0), clockLabel(t, each, t1)]));
  c.node.querySelector(".time").textContent = clockUnit(each, t1);
  parts.forEach(({ points, band }, i) => {
    const joined = all => all.length ? "M" + all.map(([t, v]) => X(t) + " " + Y(v)).join("L") : "";
    c.lines[i].setAttribute("d", joined(points));
    const edge = [...band.map(([t, , b]) => [t, b]), ...band.map(([t, a]) => [t, a]).reverse()];
    c.bands[i].setAttribute("d", band.length ? joined(edge) + "z" : "");
  });
  const layer = path?.during();
  strip(c.during, layer && layer[1] > t0 && layer[0] < t1 && [(layer[0] - t0) / (t1 - t0), (layer[1] - t0) / (t1 - t0)]);
}
function strip(node, range) {
  node.style.display = range ? "block" : "none";
  if (!range) return;
  const [a, b] = range.map(x => clamp(x, 0, 1));
  node.style.left = 100 * a + "%";
  node.style.width = 100 * (b - a) + "%";
}
function readings() {
  const [t0, t1] = view, t = cursor === null ? null : t0 + cursor * (t1 - t0);
  for (const c of charts) {
    c.hair.style.display = t === null ? "none" : "block";
    if (t !== null) c.hair.style.left = 100 * cursor + "%";
    c.curves.forEach((s, i) => {
      const found = t === null ? null : valueAt(s, t), texts = found?.map(figure);
      c.readings[i].textContent = !texts ? "" : texts[0] === texts[1] ? texts[0] : texts.join(" to ");
    });
  }
  const step = Math.min(1, (t1 - t0) / 500), name = x => clockLabel(x, step, end);
  if (t === null) {
    output.textContent = `${name(t0)} to ${name(t1)} (${clockUnit(step, end)})`;
    return;
  }
  const lines = line && valueAt(line, t)?.map(Math.round), layer = path?.layerAt(t);
  output.textContent = `at ${name(t)}` + (lines?.[0] ? `, line ${lines[0] === lines[1] ? lines[0] : lines.join(" to ")}` : "") +
    (layer ? `, layer ${layer}` : "");
}
function drawCharts() {
  charts.forEach(drawChart);
  if (charts.length) readings();
}
function show(a, b) {  // true if that is something else than before
  const span = clamp(b - a, finest, end), start = clamp((a + b - span) / 2, 0, end - span);
  const other = start !== view[0] || start + span !== view[1];
  view = [start, start + span];
  soon(drawCharts);
  remember();
  return other;
}
const time = {
  move: dx => show(view[0] - dx * (view[1] - view[0]), view[1] - dx * (view[1] - view[0])),
  zoom(x, y, by) {
    const t = view[0] + x * (view[1] - view[0]);
    const span = clamp((view[1] - view[0]) * by, finest, end);
    return show(t - x * span, t + (1 - x) * span);
  },
  zoomTo: (a, b) => show(view[0] + a * (view[1] - view[0]), view[0] + b * (view[1] - view[0])),
  reset: () => { path?.back(); show(0, end); },
  select: (a, b) => charts.forEach(c => strip(c.select, a !== null && [Math.min(a, b), Math.max(a, b)])),
  hover(x) {
    cursor = x === null ? null : clamp(x, 0, 1);
    soon(readings);
  },
  click: x => path?.showAt(view[0] + x * (view[1] - view[0])),
};

// -- the path
function pathView(node) {
  const d = data.path, plot = node.querySelector(".plot"), svg = plot.querySelector("svg");
  const ends = new Uint16Array(bytes(d.ends)), colours = new Uint8Array(bytes(d.colours));
  const lines = [...node.querySelectorAll(".lines path")], grid = node.querySelector(".grid");
  const which = node.querySelector(".which"), top = d.layers.length - 1;
  let shown = d.layer, before = shown, box = d.view;
  function drawLayer() {
    const parts = lines.map(() => []), at = i => [0, 1, 2, 3].map(k => (d.origin[k % 2] + d.unit * ends[4 * i + k]).toFixed(3));
    const stop = shown < top ? d.layers[shown + 1][0] : colours.length;
    for (let i = d.layers[shown][0]; i < stop; i++) {
      const [x0, y0, x1, y1] = at(i);
      parts[colours[i]].push(`M${x0} ${y0}L${x1} ${y1}`);
    }
    parts.forEach((all, i) => lines[i].setAttribute("d", all.join("")));
    const z = d.layers[shown][1];
    const name = shown ? `layer ${shown} of ${top}` : "before the first layer";
    if (which) which.textContent = name + (shown && z !== undefined ? `, Z ${figure(z)} mm` : "");
    if (slider) slider.value = shown;
    charts.forEach(drawChart);
  }
  function drawView() {
    const [x0, y0, x1, y1] = box, wide = x1 - x0, high = y1 - y0, px = plot.clientWidth || 600;
    svg.setAttribute("viewBox", `${x0} ${-y1} ${wide} ${high}`);
    node.querySelector(".lines").setAttribute("stroke-width", Math.max(0.4, wide / px));
    const step = roundStep(wide, Math.max(4, Math.floor(px / 80))), xs = ticks(x0, x1, step), ys = ticks(y0, y1, step);
    grid.setAttribute("d", xs.map(x => `M${x} ${y0}V${y1}`).join("") + ys.map(y => `M${x0} ${y}H${x1}`).join(""));
    spans(plot.querySelector(".y"), "top", ys.map(y => [(y1 - y) / high, label(y, step)]));
    spans(plot.querySelector(".x"), "left", xs.map(x => [(x - x0) / wide, label(x, step)]));
    plot.style.touchAction = wide < 0.999 * (d.view[2] - d.view[0]) ? "none" : "pan-y";
  }
  const go = (x0, y0, wide) => {  // within some room around the whole
    const full = d.view[2] - d.view[0], tall = (d.view[3] - d.view[1]) / full;
    wide = clamp(wide, Math.min(1, full), Math.max(full, 1.2 * (d.bed[2] - d.bed[0])));
    const room = Math.max(full, d.bed[2] - d.bed[0]);
    x0 = clamp(x0, d.view[0] - room, d.view[2] + room - wide);
    y0 = clamp(y0, d.view[1] - room, d.view[3] + room - wide * tall);
    const other = Math.abs(wide - (box[2] - box[0])) > 1e-9 || x0 !== box[0] || y0 !== box[1];
    box = [x0, y0, x0 + wide, y0 + wide * tall];
    soon(drawView);
    return other;
  };
  gestures(plot, {
    move: (dx, dy) => go(box[0] - dx * (box[2] - box[0]), box[1] + dy * (box[3] - box[1]), box[2] - box[0]),
    zoom(x, y, by) {
      const full = d.view[2] - d.view[0], wide = box[2] - box[0], high = box[3] - box[1];
      if (by > 1 && wide >= 0.999999 * full) return false;
      const now = clamp(wide * by, Math.min(1, full), full), tall = high / wide;
      if (now === full) return go(d.view[0], d.view[1], full);
      return go(box[0] + x * (wide - now), box[1] + (1 - y) * tall * (wide - now), now);
    },
    reset: () => { box = d.view; soon(drawView); },
  });
  const control = make("div", node, "control");
  let slider = null;
  if (top > 0) {
    const text = make("label", control);
    text.textContent = "Layer";
    slider = make("input", text);
    Object.assign(slider, { type: "range", min: 0, max: top, value: shown });
    slider.id = "layer";
    slider.oninput = () => showLayer(+slider.value);
  }
  if (colours.includes(0)) {
    const text = make("label", control, "box"), box = make("input", text);
    Object.assign(box, { type: "checkbox", checked: true });
    box.onchange = () => node.classList.toggle("still", !box.checked);
    text.append("travel moves");
  }
  const all = make("button", control);
  all.textContent = "Whole";
  all.title = "Shows the whole layer (double click, 0)";
  all.onclick = () => { box = d.view; soon(drawView); };
  function showLayer(n) {
    n = clamp(Math.round(n), 0, top);
    if (n === shown) return;
    shown = n;
    soon(drawLayer);
    remember();
  }
  return {
    draw: drawView, drawLayer, showLayer, top, shown: () => shown, changed: () => shown !== d.layer,
    during: () => top > 0 && d.layers[shown].length > 1 ? d.layers[shown].slice(2) : null,
    layerAt: t => d.layers.findLastIndex(([, , a]) => a !== undefined && a <= t),
    showAt(t) { before = shown; if (top > 0) showLayer(Math.max(0, this.layerAt(t))); },
    back: () => showLayer(before),
  };
}

// -- the address keeps what is shown: #t=1.5,2.5&layer=3
let written = null;
function remember() {
  clearTimeout(written);
  written = setTimeout(() => {
    const parts = [];
    if (view[0] > 0 || view[1] < end) parts.push("t=" + view.map(t => +t.toFixed(4)).join(","));
    if (path?.changed()) parts.push("layer=" + path.shown());
    try {
      history.replaceState(null, "", parts.length ? "#" + parts.join("&") : location.pathname + location.search);
    } catch { /* a page within another one may have no address of its own */ }
  }, 200);
}
function recall() {
  const words = new URLSearchParams(location.hash.slice(1)), times = (words.get("t") || "").split(",").map(Number);
  if (charts.length && times.length === 2 && times[1] > times[0]) show(...times);
  if (path && words.has("layer")) path.showLayer(+words.get("layer") || 0);
}
const section = document.querySelector("section.path");
if (data.path && section) path = pathView(section);
if (charts.length) {
  zoomBar.hidden = false;
  charts.forEach(c => gestures(c.plot, time));
  const acts = {
    in: () => time.zoom(0.5, 0, 0.5), out: () => time.zoom(0.5, 0, 2), left: () => time.move(0.25),
    right: () => time.move(-0.25), all: () => show(0, end),
  };
  zoomBar.addEventListener("click", e => acts[e.target.dataset.do]?.());
}
function draw() { drawCharts(); path?.draw(); }
recall();
draw();
path?.drawLayer();
addEventListener("resize", () => soon(draw));
addEventListener("hashchange", recall);
})();
