/** The course: its path, and the questions that this browser has seen answered. */

import { call } from "../api/client";
import type { Checked, CourseView, ExperimentView, LessonView, OutcomeView } from "../api/schema";
import type { Kind, Values } from "../learn/lesson-address";
import { language } from "../text/index.svelte";

const KEPT = "passo-course";

class Course {
  path = $state.raw<CourseView>();
  /** The indices of the questions that were answered, by lesson. */
  solved = $state<Record<string, number[]>>(kept());

  async load(): Promise<void> {
    this.path = await call<CourseView>("GET", `lessons?language=${language.chosen}`);
  }

  lesson(name: string): Promise<LessonView> {
    return call("GET", `lessons/${name}?language=${language.chosen}`);
  }

  calculator(name: string): Promise<ExperimentView> {
    return call("GET", `calculators/${name}?language=${language.chosen}`);
  }

  run(kind: Kind, name: string, values: Values): Promise<OutcomeView> {
    return call("POST", `${kind}/${name}/run`, { values, language: language.chosen });
  }

  async check(name: string, question: number, answer: number): Promise<Checked> {
    const body = { answer, language: language.chosen };
    const checked = await call<Checked>("POST", `lessons/${name}/check/${question}`, body);
    if (checked.right) this.#solve(name, question);
    return checked;
  }

  #solve(name: string, question: number): void {
    this.solved[name] = [...new Set([...(this.solved[name] ?? []), question])];
    localStorage.setItem(KEPT, JSON.stringify(this.solved));
  }
}

function kept(): Record<string, number[]> {
  try {
    return JSON.parse(localStorage.getItem(KEPT) ?? "{}") as Record<string, number[]>;
  } catch {
    return {}; // not written by this page
  }
}

export const course = new Course();
