/** Light, dark, or as the system has it; kept in this browser. */

const KEY = "passo-theme";
export type Theme = "system" | "light" | "dark";
const ORDER: readonly Theme[] = ["system", "light", "dark"];

class ThemeChoice {
  chosen = $state<Theme>("system");
  #system = $state(false);

  constructor() {
    const kept = localStorage.getItem(KEY);
    this.chosen = ORDER.find((theme) => theme === kept) ?? "system";
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
    this.chosen = this.dark ? "light" : "dark";
    localStorage.setItem(KEY, this.chosen);
  }
}

export const theme = new ThemeChoice();
