/** A printer that is served for the tests of a file, and for each test a page of it. */

import { expect, test as base } from "vitest";
import { launch, visit } from "./browser";
import { Served, type ServedOptions } from "./served";

/** A test whose printer is served with these options. */
export const testOf = (options: ServedOptions) => base
  .extend("served", { scope: "file" }, async ({}, { onCleanup }) => {
    const served = new Served(options);
    onCleanup(() => served.remove());
    await served.start();
    return served;
  })
  .extend("browser", { scope: "file" }, async ({}, { onCleanup }) => {
    const browser = await launch();
    onCleanup(() => browser.close());
    return browser;
  })
  /** The page, and what went wrong in it: nothing may be left of that at the end of the test. */
  .extend("visit", async ({ browser, served }, { onCleanup }) => {
    const made = await visit(browser, served.url);
    onCleanup(async () => {
      await made.page.context().close();
      expect(made.faults).toEqual([]);
    });
    return made;
  })
  .extend("page", ({ visit }) => visit.page);

export const test = testOf({});
