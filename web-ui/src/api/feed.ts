/** The WebSocket of the server: opened again after each loss, at most every five seconds. */

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 5000;

export interface FeedListener<Message> {
  /** What the server is asked for, once the connection is open. */
  hello?: object;
  message(message: Message): void;
  /** The first message is there, or the connection is lost. */
  connected(yes: boolean): void;
}

/** The address of the feed, for a page at this address. */
export function feedAddress(page: string): string {
  const address = new URL("api/v1/feed", page);
  address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
  address.hash = "";
  return address.href;
}

/** Keeps a connection open until the function that it returns is called. */
export function openFeed<Message>(listener: FeedListener<Message>): () => void {
  let wait_ms = FIRST_WAIT_MS;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let socket: WebSocket | undefined;
  let ended = false;

  function open(): void {
    let live = false;
    const opened = new WebSocket(feedAddress(location.href));
    socket = opened;
    opened.onopen = () => {
      if (listener.hello) opened.send(JSON.stringify(listener.hello));
    };
    opened.onmessage = (event: MessageEvent<string>) => {
      if (!live) {
        live = true;
        wait_ms = FIRST_WAIT_MS;
        listener.connected(true);
      }
      listener.message(JSON.parse(event.data) as Message);
    };
    opened.onclose = () => {
      listener.connected(false);
      if (ended) return;
      timer = setTimeout(open, wait_ms);
      wait_ms = Math.min(2 * wait_ms, LONGEST_WAIT_MS);
    };
  }

  open();
  return () => {
    ended = true;
    clearTimeout(timer);
    socket?.close();
  };
}
