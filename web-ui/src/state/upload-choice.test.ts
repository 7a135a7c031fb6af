import { afterEach, expect, test, vi } from "vitest";
import { choice } from "./upload-choice.svelte";
import { uploads } from "./uploads.svelte";

const folder = (...names: string[]) => {
  const entries = names.map((name) => ({ name, path: `/${name}`, folder: false, size: 9, modified_s: 0 }));
  vi.stubGlobal("fetch", () => Promise.resolve(new Response(JSON.stringify({ path: "/", free_bytes: 1, entries }))));
};

afterEach(() => vi.unstubAllGlobals());

test("a file of a taken name waits, also before its folder was shown", async () => {
  folder("a.gcode", "a-2.gcode");
  const add = vi.spyOn(uploads, "add").mockReturnValue();
  await choice.upload([new File(["G28"], "a.gcode"), new File(["G28"], "b.gcode")]);
  expect(add.mock.calls.map(([file]) => file.name)).toEqual(["b.gcode"]);
  expect(choice.taken.map((file) => file.name)).toEqual(["a.gcode"]);
  choice.keepBoth();
  expect(add.mock.calls.at(-1)?.[1]).toBe("a-3.gcode");
  expect(choice.taken).toEqual([]);
});
