/** JSON merge patches (RFC 7386). */

export type Tree = { [key: string]: unknown };

function isTree(value: unknown): value is Tree {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/** Applies a patch to `target` in place: null removes a key, trees are merged, all else replaces. */
export function merge(target: Tree, patch: Tree): void {
  for (const [key, value] of Object.entries(patch)) {
    if (value === null) {
      delete target[key];
    } else if (isTree(value)) {
      const old = target[key];
      if (isTree(old)) {
        merge(old, value);
      } else {
        const made: Tree = {};
        merge(made, value);
        target[key] = made;
      }
    } else {
      target[key] = value;
    }
  }
}
