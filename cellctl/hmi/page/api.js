// Questions and commands to the API, which answers in the language of the page.

import { language } from "./texts.js";

export class Refusal extends Error {
  constructor(status, problem) {
    super(problem.detail || String(status));
    this.status = status;
    this.problem = problem;
  }
}

async function answered(response) {
  if (response.ok) return response.json();
  let problem = {};
  try { problem = await response.json(); } catch { /* no problem details: the status says enough */ }
  throw new Refusal(response.status, problem);
}

export async function ask(path) {
  return answered(await fetch(`/api/v1/${path}`, { signal: AbortSignal.timeout(10000), headers: { "Accept-Language": language } }));
}

export async function send(method, path, body, headers = {}) {
  return answered(await fetch(`/api/v1/${path}`, {
    method, body: JSON.stringify(body), signal: AbortSignal.timeout(15000),
    headers: { "Content-Type": "application/json", "Accept-Language": language, ...headers },
  }));
}

// The key makes one press one command, however often the request is repeated on its way.
export function command(wanted, decision, reason = "") {
  return send("POST", "commands", { command: wanted, decision, reason }, { "Idempotency-Key": crypto.randomUUID() });
}
