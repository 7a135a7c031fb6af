/** Parts of a whole as bars, the largest first. */

import { html } from "./dom.js";

/**
 * Each part has its share from 0 to 1, and its text.
 * @type {(parts: { name: string, share: number, text: string }[]) => HTMLElement}
 */
export function bars(parts) {
  const most = Math.max(...parts.map(({ share }) => share)) || 1;
  const rows = parts.map(({ name, share, text }) => {
    const bar = html("i");
    bar.style.width = `${(100 * share) / most}%`;
    const cells = [html("td", { class: "bar" }, bar), html("td", {}, text), html("td", {}, `${(100 * share).toFixed(1)} %`)];
    return html("tr", {}, html("th", { scope: "row" }, name), ...cells);
  });
  return html("table", { class: "drawing bars" }, html("tbody", {}, ...rows));
}
