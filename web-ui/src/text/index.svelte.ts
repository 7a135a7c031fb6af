/** The texts of the page, by key, in the language that the user has chosen or the browser has. */

import en from "./en.json";
import it from "./it.json";

export type Key = keyof typeof en;
type Values = Record<string, string | number>;

const KEPT = "passo-language";
const CATALOGUES: Record<string, Record<Key, string>> = { en, it };
export type Language = "en" | "it";
export const LANGUAGES: readonly { code: Language; name: string }[] = [
  { code: "en", name: "English" },
  { code: "it", name: "Italiano" },
];

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
  const text = CATALOGUES[language.chosen]?.[key] ?? en[key];
  return text.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}

/** The key, if the catalogue has it: for keys that are made from names of the API. */
export function keyOf(name: string): Key | undefined {
  return name in en ? (name as Key) : undefined;
}
