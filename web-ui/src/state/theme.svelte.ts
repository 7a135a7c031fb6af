/** Light, dark, or as the system has it; kept in this browser. */

const KEY = "passo-theme";
export type Theme = "system" | "light" | "dark";
export const THEMES: readonly Theme[] = ["system", "light", "dark"];

class ThemeChoice {
  chosen = $state<Theme>("system");
  #system = $state(false);

  constructor() {
    const kept = localStorage.getItem(KEY);
    this.chosen = THEMES.find((theme) => theme === kept) ?? "system";
    const query = matchMedia("(prefers-color-scheme: dark)");
    this.#system = query.matches;
    query.addEventListener("change", (event) => {
      this.#system = event.matches;
    });
  }

  get dark(): boolean {
    return this.chosen === "system" ? this.#system : this.chosen === "dark";
  }

  toggle(): void {
    this.choose(this.dark ? "light" : "dark");
  }

  choose(chosen: Theme): void {
    this.chosen = chosen;
    localStorage.setItem(KEY, chosen);
  }
}

export const theme = new ThemeChoice();
