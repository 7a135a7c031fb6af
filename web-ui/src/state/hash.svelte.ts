/** Which page is shown: the hash of the address, `#/files` for example, or `#/viewer/part.gcode`. */

/** What the hash names of the page: a path, or empty. */
function placeOf(hash: string): string {
  const rest = hash.replace(/^#\/?[^/]*/, "");
  try {
    return decodeURIComponent(rest);
  } catch {
    return ""; // not made by a link of the page
  }
}

/** The hash of a page, with a path that begins with `/`. */
export function hash<Page extends string>(page: Page, path = ""): string {
  return `#/${page}${encodeURIComponent(path).replaceAll("%2F", "/")}`;
}

/** The hash, while it changes. One that names no page shows the first of `pages`. */
export class Route<Page extends string> {
  page = $state() as Page;
  place = $state("");

  constructor(pages: readonly [Page, ...Page[]]) {
    const read = () => {
      const name = location.hash.replace(/^#\/?/, "").split("/")[0];
      this.page = pages.find((page) => page === name) ?? pages[0];
      this.place = placeOf(location.hash);
    };
    read();
    addEventListener("hashchange", read);
  }
}
