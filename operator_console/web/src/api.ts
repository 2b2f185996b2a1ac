// SPDX-License-Identifier: BSD-3-Clause
// What the server says, and how it is asked. docs/openapi.json describes all of it.

export interface Mission {
  phase: "live" | "lost" | "reading" | "whole"; problem: string; sequence: number; time_s: number; times_s: number[];
  life: string; version: string; source: "node" | "run" | "log"; place: string; read_only: boolean; formats: string[];
  pictures: number; truth: boolean; exports: { format: string; file: string; beside: string[]; what: string; origin: "no" | "may" | "must" }[];
}
export interface Label {
  label: number; name: string; cells: number; area_m2: number; first_seen_s: number; last_seen_s: number;
  certainty: number; robots: string[]; color: string; library?: string[]; // what the library in force calls it
}
export interface Node {
  name: string; phase: string; heard_s: number; observation: number; num_observations: number; topics: number;
  cells: number; bytes_sent: number; budget: number; queue_bytes: number; position_m: [number, number, number];
  rejected: number; heard_whole: boolean; agreement: string;
}
export interface Status { mission_id: number; cell_size_m: number; cells: number; labels: number; nodes: Node[] }
export interface Track { robot: string; points: [number, number, number, number][] }
export interface Traffic { bin_s: number; classes: string[]; nodes: { node: string; budget: number; bins: number[][] }[] }
export interface Happening { time_s: number; kind: string; text: string }
export interface Topic { robot: string; topic: number; label: number; similarity: number }
export interface Why {
  label: number; name: string; matcher: string; similarity: string; sigma: number | null; margin: number | null;
  members: { robot: string; topic: number; cells: number; mean_similarity: number | null; nearest: Topic[]; outsider: Topic | null }[];
  nearest_label: { label: number; mean_similarity: number } | null;
  shared_words: { first: number; size: number; words: { word: number; share: number; members: number }[] }[];
}
export interface Picture { robot: string; topic: number; example: number; seen_s: number; layers: number; num_layers: number }
export interface Price {
  robot: string; topic: number; example: number; state: "sharp" | "not sharp" | "asked";
  bytes: { request: number; answer: number }; seconds: number | null; heard_ago_s: number | null;
}
export interface Holding { node: string; at_s: number; fuses: boolean; agrees: boolean | null; shares: { robot: string; whole: boolean; certain: boolean; until_s: number }[] }
export interface Place { x_m: number; y_m: number; z_m: number; surprise: number; label: number; name: string; area_m2: number; robots: string[]; first_seen_s: number; last_seen_s: number }
export interface TruthClass { id: number; name: string; color: string }
export interface CellHistory {
  cells: { x_m: number; y_m: number; z_m: number; label: number; name: string; robot: string; seen_s: number;
           history: { robot: string; seen_s: number; topic: number; label: number; certainty: number }[] }[];
}

// The token of the URL that serve printed. It leaves the address bar at once, so that no copied link carries it.
export function takeToken(): void {
  const hash = new URLSearchParams(location.hash.slice(1));
  const token = hash.get("token");
  if (token === null) return;
  sessionStorage.setItem("token", token);
  hash.delete("token");
  history.replaceState(null, "", "#" + hash.toString());
}
export const hasToken = (): boolean => sessionStorage.getItem("token") !== null;

// Ends all questions that are under way: a line that died while the machine slept never answers them.
let line = new AbortController();
export function hangUp(): void { line.abort(new Error("the line was dead")); line = new AbortController(); }

export async function ask<T>(path: string): Promise<T> {
  const response = await fetch(path, { signal: line.signal });
  const answer = await response.json();
  if (!response.ok) throw new Error(answer.error ?? response.statusText);
  return answer as T;
}

export async function askBytes(path: string): Promise<ArrayBuffer> {
  const response = await fetch(path, { signal: line.signal });
  if (!response.ok) throw new Error((await response.json()).error ?? response.statusText);
  return response.arrayBuffer();
}

export const decide = (edit: Record<string, string>): Promise<{ id: string; says: string }> => order("/api/edit", edit);
export const askSharper = (picture: { robot: string; topic: number; example: number }): Promise<Price> => order("/api/ask", picture);

async function order<T>(path: string, what: unknown): Promise<T> {
  const response = await fetch(path, {
    method: "POST", body: JSON.stringify(what),
    headers: { Authorization: "Bearer " + (sessionStorage.getItem("token") ?? ""), "Content-Type": "application/json" },
  });
  const answer = await response.json();
  if (response.status === 401) throw new Error("Open the URL that serve printed: this page has no key to change things.");
  if (!response.ok) throw new Error(answer.error ?? response.statusText);
  return answer as T;
}
