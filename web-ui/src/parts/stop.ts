/** The button that stops everything, which each page sets: dialogs show it too, since they cover that of the
 * page. */

import { createContext, type Component } from "svelte";

export const [getStop, setStop] = createContext<Component>();
