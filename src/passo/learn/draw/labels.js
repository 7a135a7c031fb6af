/** Round values on axes, and their texts. */

const SECONDS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 28800, 86400];
const CLOCK_S = 120; // longer times are shown in clock form
const HOUR_S = 3600;

/**
 * The smallest of 1, 2 and 5 times a power of ten that divides `span` into at most `most` parts.
 * @type {(span: number, most: number) => number}
 */
export function roundStep(span, most) {
  if (!(span > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(span / most));
  return [1, 2, 5, 10, 20].find((step) => step * power * most >= span * 0.999999) * power;
}

/**
 * Like `roundStep`, for times: a step of at least a second divides a minute, an hour or a day.
 * @type {(span_s: number, most: number) => number}
 */
export function timeStep(span_s, most) {
  if (span_s <= most) return roundStep(span_s, most);
  return SECONDS.find((s) => s * most >= span_s) ?? 86400 * Math.ceil(span_s / most / 86400);
}

/**
 * The multiples of `step` from `low` to `high`.
 * @type {(low: number, high: number, step: number) => number[]}
 */
export function ticks(low, high, step) {
  const all = [];
  for (let i = Math.ceil(low / step - 1e-6); i <= Math.floor(high / step + 1e-6); i++) all.push(i * step);
  return all;
}

const decimalsOf = (step) => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
const signed = (text) => text.replace("-", "\u2212");

/**
 * A number with as many decimals as the step between labels needs.
 * @type {(value: number, step: number) => string}
 */
export function label(value, step) {
  const digits = decimalsOf(step);
  const options = { minimumFractionDigits: digits, maximumFractionDigits: digits };
  return signed((+value.toFixed(digits) || 0).toLocaleString("en", options));
}

/**
 * A number with four digits.
 * @type {(value: number) => string}
 */
export const figure = (value) => signed((+value.toPrecision(4)).toLocaleString("en", { maximumSignificantDigits: 4 }));

/**
 * A time as text: in seconds up to two minutes, otherwise as min:s, h:min or h:min:s (`clockUnit`).
 * @type {(seconds: number, step: number, longest_s: number) => string}
 */
export function clockLabel(seconds, step, longest_s) {
  if (longest_s <= CLOCK_S) return label(seconds, step);
  const digits = step < 1 ? decimalsOf(step) : 0;
  const whole = +seconds.toFixed(digits);
  const minutes = Math.floor(whole / 60 + 1e-9);
  const rest = Math.max(0, whole - 60 * minutes).toFixed(digits);
  const tail = `:${rest.padStart(digits ? digits + 3 : 2, "0")}`;
  if (longest_s <= HOUR_S) return minutes + tail;
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")}${step < 60 ? tail : ""}`;
}

/** @type {(step: number, longest_s: number) => string} */
export function clockUnit(step, longest_s) {
  if (longest_s <= CLOCK_S) return "s";
  if (longest_s <= HOUR_S) return "min:s";
  return step >= 60 ? "h:min" : "h:min:s";
}
