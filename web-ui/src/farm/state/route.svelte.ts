/** The pages of the farm. */

import { hash, Route } from "../../state/hash.svelte";

export const PAGES = ["farm", "queue", "files", "history", "settings"] as const;
export type Page = (typeof PAGES)[number];

export const hashOf = hash<Page>;

export const route = new Route(PAGES);
