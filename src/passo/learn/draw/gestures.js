/** Mouse, touch and keys on a plot. */

import { clamp } from "./dom.js";

let scrolled = -1e9;  // when the wheel last scrolled the page: it is not taken from it halfway
addEventListener("wheel", e => { if (!e.defaultPrevented) scrolled = e.timeStamp; }, { passive: true });
/** `on` receives places as fractions of the plot, from its top left corner. */
export function gestures(plot, on) {
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
