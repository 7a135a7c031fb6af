import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vitest/config";

export default defineConfig({
  test: {
    projects: [
      {
        plugins: [svelte()],
        test: { name: "unit", include: ["src/**/*.test.ts"], environment: "node" },
      },
      {
        test: {
          name: "browser",
          include: ["tests/*.test.ts"],
          environment: "node",
          testTimeout: 40_000,
          hookTimeout: 40_000,
          maxWorkers: 2,
        },
      },
    ],
  },
});
