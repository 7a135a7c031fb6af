/** Which page is shown: the hash of the address, `#/files` for example, or `#/viewer/part.gcode`. */

export const PAGES = ["dashboard", "files", "viewer", "machine", "calibrate", "learn", "settings"] as const;
export type Page = (typeof PAGES)[number];

/** The page of a hash; the dashboard for one that is not known. */
export function pageOf(hash: string): Page {
  const name = hash.replace(/^#\/?/, "").split("/")[0];
  return PAGES.find((page) => page === name) ?? "dashboard";
}

/** What the hash names of the page: a path, or empty. */
export function placeOf(hash: string): string {
  const rest = hash.replace(/^#\/?[^/]*/, "");
  try {
    return decodeURIComponent(rest);
  } catch {
    return ""; // not made by a link of the page
  }
}

/** The hash of a page, with a path that begins with `/`. */
export function hashOf(page: Page, path = ""): string {
  return `#/${page}${encodeURIComponent(path).replaceAll("%2F", "/")}`;
}

class Route {
  page = $state<Page>(pageOf(location.hash));
  place = $state(placeOf(location.hash));

  constructor() {
    addEventListener("hashchange", () => {
      this.page = pageOf(location.hash);
      this.place = placeOf(location.hash);
    });
  }
}

export const route = new Route();
