import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vitest/config";
import { DRAW } from "./vite.config.ts";

export default defineConfig({
  test: {
    projects: [
      // The pictures of the README, and a bench: tools/build_page.py --test pictures
      ...["pictures", "speed"].map((name) => ({
        test: {
          name,
          include: [`tests/${name}.ts`],
          environment: "node" as const,
          testTimeout: 240_000,
          hookTimeout: 40_000,
        },
      })),
      {
        plugins: [svelte()],
        resolve: { alias: { $draw: DRAW } },
        test: { name: "unit", include: ["src/**/*.test.ts"], environment: "node" },
      },
      {
        test: {
          name: "browser",
          include: ["tests/*.test.ts"],
          environment: "node",
          testTimeout: 240_000, // on a computer that has other work, too
          hookTimeout: 120_000,
          expect: { poll: { timeout: 45_000 } },
          maxWorkers: 2,
          isolate: false, // a worker keeps what it has loaded
        },
      },
    ],
  },
});
