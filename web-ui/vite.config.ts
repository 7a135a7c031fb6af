import { svelte } from "@sveltejs/vite-plugin-svelte";
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

// `npm run dev` serves the page with the API of `passo serve` at its usual address.
const printer = "http://127.0.0.1:4000";

/** The pictures, which written pages have, too. */
export const DRAW = fileURLToPath(new URL("../src/passo/learn/draw", import.meta.url));

export default defineConfig({
  plugins: [svelte()],
  base: "./",
  resolve: { alias: { $draw: DRAW } },
  build: {
    outDir: "../src/passo/web/static",
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    rolldownOptions: { input: ["index.html", "farm.html"] },
  },
  server: { fs: { allow: [".", DRAW] }, proxy: { "/api": { target: printer, ws: true } } },
});
