/** A button that acts at its second press: the first one arms it for some seconds. */

const ARMED_MS = 4000;

export class Armed {
  on = $state(false);
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(readonly act: () => unknown) {}

  press = (): void => {
    clearTimeout(this.#timer);
    const armed = this.on;
    this.on = !armed;
    if (armed) void this.act();
    else this.#timer = setTimeout(() => (this.on = false), ARMED_MS);
  };
}
