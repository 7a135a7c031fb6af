/** The texts of the page of one printer. */

import { addTexts } from "./index.svelte";
import en from "./printer/en.json";
import it from "./printer/it.json";

addTexts({ en, it });
