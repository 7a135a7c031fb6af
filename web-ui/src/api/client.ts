/** Requests to the printer. Each throws a Refusal with the sentence of the server, or of the
 * connection. */

import type { FaultStatus, Refusal as RefusalBody } from "./schema";

export const ROOT = "api/v1/";

/** Why something was not done, for the user to read. */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly fault: FaultStatus,
  ) {
    super(fault.text);
  }
}

/** The JSON that the printer answers, or undefined if it answers none. */
export async function call<Answer>(
  method: "GET" | "POST" | "PUT" | "PATCH" | "DELETE",
  path: string,
  body?: unknown,
): Promise<Answer> {
  const request: RequestInit = { method, headers: { "X-Passo-Request": "1" } };
  if (body !== undefined) {
    request.body = JSON.stringify(body);
    request.headers = { ...request.headers, "Content-Type": "application/json" };
  }
  let response: Response;
  let text: string;
  try {
    response = await fetch(ROOT + path, request);
    text = await response.text();
  } catch {
    throw readRefusal(0, "");
  }
  if (!response.ok) throw readRefusal(response.status, text);
  return (text ? JSON.parse(text) : undefined) as Answer;
}

/** What the body of a refusal says; status 0 stands for no answer at all. */
export function readRefusal(status: number, text: string): Refusal {
  if (status === 0) {
    const fault = { text: "Passo does not answer", action: "Check that it is running" };
    return new Refusal(0, { code: "", part: "", ...fault });
  }
  try {
    const { code, part, message, action } = (JSON.parse(text) as RefusalBody).error;
    return new Refusal(status, { code, part, text: message, action });
  } catch {
    const fault = { text: `Passo answers with status ${status}`, action: "Look into its log" };
    return new Refusal(status, { code: "", part: "", ...fault });
  }
}

/** A name in a path. */
export function segment(name: string): string {
  return encodeURIComponent(name);
}

/** The words of a query. */
export function query(values: Record<string, string | number>): string {
  return new URLSearchParams(Object.entries(values).map(([key, value]) => [key, String(value)])).toString();
}
