/** The texts of the page of the farm. */

import { addTexts } from "./index.svelte";
import en from "./farm/en.json";
import it from "./farm/it.json";

addTexts({ en, it });
