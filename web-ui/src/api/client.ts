/** Requests to the printer. Each throws a Refusal with the sentence of the server, or of the
 * connection. */

import type { FaultStatus } from "./schema";

const ROOT = "api/v1/";

/** Why something was not done, for the user to read. */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly fault: FaultStatus,
  ) {
    super(fault.text);
  }
}

interface RefusalBody {
  error?: { code: string; part: string; message: string; action: string };
}

function isRefusal(body: unknown): body is Required<RefusalBody> {
  if (typeof body !== "object" || body === null || !("error" in body)) return false;
  return typeof body.error === "object" && body.error !== null && "message" in body.error;
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
  try {
    response = await fetch(ROOT + path, request);
  } catch {
    throw refused(0, "Passo does not answer", "Check that it is running");
  }
  const text = await response.text();
  const answer: unknown = text && isJson(response) ? JSON.parse(text) : undefined;
  if (response.ok) return answer as Answer;
  if (isRefusal(answer)) {
    const { code, part, message, action } = answer.error;
    throw new Refusal(response.status, { code, part, text: message, action });
  }
  throw refused(response.status, `Passo answers with status ${response.status}`, "");
}

function isJson(response: Response): boolean {
  return response.headers.get("content-type")?.startsWith("application/json") ?? false;
}

function refused(status: number, text: string, action: string): Refusal {
  return new Refusal(status, { code: "", part: "", text, action });
}

/** A name in a path. */
export function segment(name: string): string {
  return encodeURIComponent(name);
}
