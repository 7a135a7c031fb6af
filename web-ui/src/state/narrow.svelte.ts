/** Whether there is no room for details beside a list. */

import { MediaQuery } from "svelte/reactivity";

export const narrow = new MediaQuery("max-width: 1023px");
