/** The WebSocket of the printer: opened again after each loss, at most every five seconds. */

import type { FeedMessage } from "./messages";

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 5000;

export interface FeedListener {
  message(message: FeedMessage): void;
  /** The connection is there, or lost. */
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
export function openFeed(listener: FeedListener): () => void {
  let wait_ms = FIRST_WAIT_MS;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let socket: WebSocket | undefined;
  let ended = false;

  function open(): void {
    const opened = new WebSocket(feedAddress(location.href));
    socket = opened;
    opened.onopen = () => opened.send(JSON.stringify({ type: "listen", console: true }));
    opened.onmessage = (event: MessageEvent<string>) => {
      const message = JSON.parse(event.data) as FeedMessage;
      if (message.type === "status") {
        wait_ms = FIRST_WAIT_MS;
        listener.connected(true);
      }
      listener.message(message);
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
