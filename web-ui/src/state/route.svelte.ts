/** Which page is shown: the hash of the address, `#/files` for example. */

export const PAGES = ["dashboard", "files"] as const;
export type Page = (typeof PAGES)[number];

/** The page of a hash; the dashboard for one that is not known. */
export function pageOf(hash: string): Page {
  const name = hash.replace(/^#\/?/, "").split("/")[0];
  return PAGES.find((page) => page === name) ?? "dashboard";
}

class Route {
  page = $state<Page>(pageOf(location.hash));

  constructor() {
    addEventListener("hashchange", () => {
      this.page = pageOf(location.hash);
    });
  }
}

export const route = new Route();
