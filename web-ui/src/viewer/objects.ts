/** Which object of a print is at a place. */

import type { PrintObject } from "../api/schema";

/** The object whose outline has the point inside; undefined where none has, or none is outlined. */
export function objectAt(objects: readonly PrintObject[], x: number, y: number): PrintObject | undefined {
  return objects.find(({ outline_mm }) => isInside(outline_mm, x, y));
}

/** Whether a ray from the point to the right crosses the outline an odd number of times. */
function isInside(outline: readonly (readonly [number, number])[], x: number, y: number): boolean {
  let inside = false;
  let before = outline.at(-1);
  for (const corner of outline) {
    if (before && corner[1] > y !== before[1] > y) {
      const crossing = corner[0] + ((y - corner[1]) / (before[1] - corner[1])) * (before[0] - corner[0]);
      if (x < crossing) inside = !inside;
    }
    before = corner;
  }
  return inside;
}
