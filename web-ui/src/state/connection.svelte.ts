/** The feed of the server: whether it is there. */

class Connection {
  /** Messages arrive. */
  live = $state(false);
  /** When the last message arrived. */
  heard = $state.raw(new Date());
  #seen = $state(false);

  /** It was there, and is not any more. */
  get lost(): boolean {
    return this.#seen && !this.live;
  }

  message(): void {
    this.heard = new Date();
    this.#seen = true;
  }
}

export const connection = new Connection();
