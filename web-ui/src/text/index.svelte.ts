/** The texts of the page, by key, in the language that the user has chosen or the browser has. Both pages
 * share `common/`; each adds a catalogue of its own, so that neither loads the texts of the other. */

import en from "./common/en.json";
import it from "./common/it.json";
import type farm from "./farm/en.json";
import type printer from "./printer/en.json";

export type Key = keyof typeof en | keyof typeof printer | keyof typeof farm;
type Catalogue = Partial<Record<Key, string>>;
type Values = Record<string, string | number>;

const KEPT = "passo-language";
export type Language = "en" | "it";
export const LANGUAGES: readonly { code: Language; name: string }[] = [
  { code: "en", name: "English" },
  { code: "it", name: "Italiano" },
];
const CATALOGUES: Record<Language, Catalogue> = { en: { ...en }, it: { ...it } };

/** Adds the texts of a page, before the first of them is shown. */
export function addTexts(texts: Record<Language, Catalogue>): void {
  for (const { code } of LANGUAGES) Object.assign(CATALOGUES[code], texts[code]);
}

class LanguageChoice {
  chosen = $state<Language>("en");

  constructor() {
    if (typeof localStorage === "undefined") return; // not in a browser
    const wanted = localStorage.getItem(KEPT) ?? navigator.language;
    if (wanted.startsWith("it")) this.chosen = "it";
  }

  toggle(): void {
    this.choose(this.chosen === "en" ? "it" : "en");
  }

  choose(chosen: Language): void {
    this.chosen = chosen;
    localStorage.setItem(KEPT, chosen);
  }
}

export const language = new LanguageChoice();

/** The text of a key, with `{name}` replaced by the values. */
export function t(key: Key, values: Values = {}): string {
  const text = CATALOGUES[language.chosen][key] ?? key;
  return text.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}

/** The key, if the page has a text for it: for keys that are made from names of the API. */
export function keyOf(name: string): Key | undefined {
  return name in CATALOGUES.en ? (name as Key) : undefined;
}
