/** Elements of a page, and of an SVG picture. */

const SVG = "http://www.w3.org/2000/svg";

/**
 * @typedef {Record<string, string | number>} Attributes
 * @typedef {Node | string} Child
 */

/** @type {(name: string, attributes?: Attributes, ...children: Child[]) => HTMLElement} */
export function html(name, attributes = {}, ...children) {
  return filled(document.createElement(name), attributes, children);
}

/** @type {(name: string, attributes?: Attributes, ...children: Child[]) => SVGElement} */
export function svg(name, attributes = {}, ...children) {
  return filled(document.createElementNS(SVG, name), attributes, children);
}

function filled(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

/** Texts along an axis: `places` are fractions from the left or the top, with their texts. */
export function textsAlong(node, side, places) {
  node.replaceChildren(...places.map(([at, text]) => {
    const one = html("span", {}, text);
    one.style[side] = `${100 * at}%`;
    return one;
  }));
}

const waiting = new Set();
/** Calls a function once before the next frame, however often it is asked for. */
export function soon(draw) {
  if (!waiting.size) {
    requestAnimationFrame(() => {
      const all = [...waiting];
      waiting.clear();
      for (const one of all) one();
    });
  }
  waiting.add(draw);
}

export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
