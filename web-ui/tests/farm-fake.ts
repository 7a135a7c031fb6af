/** A farm that is made up, for the page alone: its files and its API are answered inside the browser. */

import { existsSync, readFileSync } from "node:fs";
import { extname, join } from "node:path";
import type { Page, WebSocketRoute } from "playwright-core";
import type { FileView, JobView, PrinterView } from "../src/farm/schema";
import { FILES, NOW_S } from "./farm-printers";

const BUILT = "../src/passo/web/static";
export const FARM = "http://farm.test/";
const TYPES: Record<string, string> = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".woff2": "font/woff2", ".txt": "text/plain" };
const picture = (hue: number) =>
  `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 64 64"><path fill="hsl(${hue} 45% 52%)" d="M12 22 32 12l20 10v22L32 54 12 44Z"/><path fill="hsl(${hue} 45% 38%)" d="M32 32v22L12 44V22Z"/><path fill="hsl(${hue} 45% 64%)" d="M12 22 32 12l20 10-20 10Z"/></svg>`;

const files: FileView[] = FILES.map((name, number) => ({
  sha256: `${number}`.repeat(64),
  name,
  size: 1_200_000 * (number + 1),
  added_s: NOW_S - 4000 * number,
  materials: ["PLA"],
  nozzle_mm: 0.4,
  print_s: 5400 + 4000 * number,
  filament_mm: 8100,
  has_picture: true,
}));

export interface FakeFarm {
  feed: () => WebSocketRoute | undefined;
  /** What the page has asked for, in order. */
  asked: string[];
}

/** Answers all that `page` asks the farm for. */
export async function fake(page: Page, printers: PrinterView[], jobs: JobView[] = [], role = "admin"): Promise<FakeFarm> {
  let feed: WebSocketRoute | undefined;
  const asked: string[] = [];
  const answers: Record<string, unknown> = {
    session: { name: "anna", role, set_up: true, code_needed: false },
    sessions: [],
    accounts: [{ name: "anna", role: "admin" }, { name: "bruno", role: "operator" }],
    keys: [],
    limits: [{ subject: "bruno", tags: ["left wall"] }],
    files,
    "printers/proposed": [{ id: "new", name: "Mercury", url: "http://10.0.0.99:4000" }],
    runs: printers.slice(0, 20).map((one, number) => ({ id: `r${number}`, job: "j0", file: "0", name: FILES[number % 4], printer: one.id, state: ["done", "done", "failed", "cancelled", "printing"][number % 5], attempt: 1 + Number(number === 2), assigned_s: NOW_S - 9000 * number, started_s: NOW_S - 9000 * number, ended_s: null, filament_mm: 5200, printed_s: 5400, reason: number % 5 === 2 ? "The filament ran out at line 20418" : "" })),
    statistics: { done: 812, failed: 21, cancelled: 9, printed_s: 9.2e6, filament_mm: 1.1e7, printers: printers.slice(0, 12).map((one, number) => ({ printer: one.id, done: 60 + number, failed: number % 4, cancelled: 1, printed_s: 90_000 * (number + 2), filament_mm: 9e5 })), materials: ["PLA", "PETG"].map((name, number) => ({ name, done: 400, failed: 10 * number, cancelled: 4, printed_s: 4e6, filament_mm: 5e6 })), users: [{ name: "anna", done: 812, failed: 21, cancelled: 9, printed_s: 9.2e6, filament_mm: 1.1e7 }] },
    events: printers.slice(0, 12).map((one, number) => ({ number, time_s: NOW_S - 300 * number, who: number % 3 ? "hub" : "anna", what: number % 3 ? `gear-24t.gcode starts on ${one.name}` : `The bed of ${one.name} is clear`, printer: one.id, job: "", run: "" })),
  };
  await page.route(`${FARM}**`, async (route) => {
    const url = new URL(route.request().url());
    const path = url.pathname.slice(1);
    if (path.endsWith("/picture")) return route.fulfill({ body: picture((path.length * 47 + path.charCodeAt(14) * 31) % 360), contentType: "image/svg+xml" });
    if (path.startsWith("api/v1/")) {
      const name = path.slice(7);
      if (route.request().method() !== "GET") asked.push(`${route.request().method()} ${name} ${route.request().postData() ?? ""}`.trim());
      if (/^printers\/[^/]+\/service$/.test(name)) return route.fulfill({ json: [{ item: "Grease Z", every_h: 300, every_prints: null, every_mm: null, hours: 312, prints: 40, filament_mm: 1, due: true, done_s: NOW_S - 4e6, done_by: "anna" }] });
      if (name.endsWith("/fit")) return route.fulfill({ json: printers.slice(0, 12).map((one, number) => ({ printer: one.id, fits: number % 4 !== 3, why: number % 4 === 3 ? "Line 812: Y 235 mm is beyond the limit of 220 mm" : "", print_s: number % 4 === 3 ? null : 5400 + 60 * number })) });
      if (route.request().method() === "GET" && name in answers) return route.fulfill({ json: answers[name] });
      return route.fulfill({ json: route.request().method() === "GET" || name === "stop" ? [] : {} });
    }
    const file = join(BUILT, path === "" ? "farm.html" : path);
    if (!existsSync(file)) return route.fulfill({ status: 404 });
    return route.fulfill({ body: readFileSync(file), contentType: TYPES[extname(file)] ?? "application/octet-stream" });
  });
  await page.routeWebSocket(`${FARM.replace("http", "ws")}api/v1/feed`, (socket) => {
    feed = socket;
    const groups = [{ name: "Fuse A", limit_w: 2300, used_w: 700 }];
    socket.send(JSON.stringify({ type: "farm", farm: { printers, jobs, groups, queue_paused: false } }));
  });
  return { feed: () => feed, asked };
}
