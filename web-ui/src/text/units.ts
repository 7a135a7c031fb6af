/** Numbers with units, for people. */

const NONE = "–";

/** A temperature in °C with one decimal, without the unit. */
export function celsius(value: number | null | undefined): string {
  return value == null ? NONE : value.toFixed(1);
}

/** A length in mm, without the unit. */
export function millimetres(value: number | null | undefined, decimals = 2): string {
  if (value == null) return NONE;
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

/** A fraction in whole percent. */
export function percent(fraction: number | null | undefined): string {
  return fraction == null ? NONE : `${Math.round(fraction * 100)} %`;
}

/** A time: `45 s`, `12 min`, `3 h 05 min`. */
export function duration(seconds: number | null | undefined): string {
  if (seconds == null) return NONE;
  if (seconds < 59.5) return `${Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 60) return `${minutes} min`;
  return `${Math.floor(minutes / 60)} h ${String(minutes % 60).padStart(2, "0")} min`;
}

// One for all: to make one takes long.
const TIME = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit" });
const DAY_AND_TIME = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", weekday: "short" });

/** A time of day, with the weekday if it is not today. */
export function clockTime(at: Date, now: Date): string {
  return (at.toDateString() === now.toDateString() ? TIME : DAY_AND_TIME).format(at);
}

/** A time of day of seconds since 1970, with the day if it is not today. */
export function dayTime(since_1970_s: number, now = new Date()): string {
  const at = new Date(since_1970_s * 1000);
  const today = at.toDateString() === now.toDateString();
  return at.toLocaleString(undefined, today ? { timeStyle: "short" } : { dateStyle: "medium", timeStyle: "short" });
}

/** A size in kB or MB of 1000. */
export function bytes(size: number): string {
  if (size < 1000) return `${size} B`;
  if (size < 1e6) return `${(size / 1e3).toFixed(0)} kB`;
  return size < 1e9 ? `${(size / 1e6).toFixed(1)} MB` : `${(size / 1e9).toFixed(1)} GB`;
}

/** A value of a setting with at most six digits that count; a name as it is. */
export function short(value: string): string {
  return Number.isNaN(Number(value)) ? value : String(Number(Number(value).toPrecision(6)));
}
