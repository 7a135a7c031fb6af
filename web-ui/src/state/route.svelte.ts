/** The pages of one printer. */

import { hash, Route } from "./hash.svelte";

export const PAGES = ["dashboard", "files", "viewer", "machine", "calibrate", "learn", "settings"] as const;
export type Page = (typeof PAGES)[number];

/** The hash of a page, with a path that begins with `/`. */
export const hashOf = hash<Page>;

export const route = new Route(PAGES);
