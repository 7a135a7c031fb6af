/** A written page: its data, and its sections. */

import { html } from "./dom.js";

export const data = JSON.parse(document.getElementById("data").textContent);
export const main = document.querySelector("main");
const dark = matchMedia("(prefers-color-scheme: dark)");
const follow = () => (document.documentElement.dataset.theme = dark.matches ? "dark" : "light");
follow();
dark.addEventListener("change", follow);

export const section = (kind, title, ...content) => html("section", { class: kind }, html("h2", {}, title), ...content);

/** Names and values. */
export const table = (rows) =>
  html("table", {}, html("tbody", {}, ...rows.map(([name, value]) => html("tr", {}, html("th", { scope: "row" }, name), html("td", {}, value)))));
