/** The page of `passo batch report`: the rows of each file that no other row beats, and pictures of all rows. */

import { html } from "./dom.js";
import { data, main, section } from "./pages.js";
import { scatter } from "./scatter.js";

const note = (text) => html("p", { class: "note" }, text);
const percent = (share) => `${(100 * share).toFixed(1)} %`;

/** The rows of the front in a table, with a column for each key that a row sets. */
function front(file, rows) {
  const measured = rows.some((row) => row.ringing_um !== null);
  const keys = [...new Set(rows.flatMap((row) => Object.keys(row.setting)))];
  const names = ["Machine", ...keys, "Time", ...(measured ? ["Ringing", "Width error"] : [])];
  const lines = rows.filter((row) => row.front || row.best).map((row) => {
    const figures = measured ? [`${row.ringing_um.toFixed(1)} µm`, percent(row.width_error)] : [];
    const cells = [...keys.map((key) => row.setting[key] ?? ""), row.time, ...figures].map((text) => html("td", {}, text));
    return html("tr", row.best ? { class: "best" } : {}, html("th", { scope: "row" }, row.machine), ...cells);
  });
  const heads = names.map((name) => html("th", { scope: "col" }, name));
  const made = html("table", {}, html("thead", {}, html("tr", {}, ...heads)), html("tbody", {}, ...lines));
  return html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": `Rows of ${file}` }, made);
}

/** All rows as points: time against one figure. */
function picture(file, rows, title, figure) {
  const points = rows.map((row) => ({
    x: row.time_s / 60,
    y: figure(row),
    colour: row.best ? 2 : row.front ? 1 : 6,
    title: `${row.name}: ${row.time}`,
  }));
  const drawing = scatter(points, { across: "time, min", text: `${title} against time: ${file}` });
  return section("trade", `${title} against time`, html("div", { class: "drawing" }, drawing));
}

for (const { file, rows, failed, best } of data.files) {
  const failures = Object.entries(failed).map(([status, number]) => `${number} ${status}`);
  const texts = [`${rows.length} rows`, ...failures, "the table has the rows that no other row beats in these figures, and the marked one, which has the best score of all figures"];
  main.append(section("trials wide", file, best === null ? note("No row was computed.") : front(file, rows), note(`${texts.join(", ")}.`)));
  if (rows.length > 1 && rows[0].ringing_um !== null) {
    main.append(picture(file, rows, "Ringing in µm", (row) => row.ringing_um));
    main.append(picture(file, rows, "Width error in %", (row) => 100 * row.width_error));
  }
}
if (data.left_out) main.append(section("wide", "More files", note(`${data.left_out} more files are in results.csv.`)));
