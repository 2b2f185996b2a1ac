// SPDX-License-Identifier: BSD-3-Clause
// One picture, larger; and, while the mission goes on, what a sharper one would cost before anybody asks for it.
import { ask, askSharper, type Picture, type Price } from "./api";
import { el, seconds } from "./dom";
import type { Pictures } from "./pictures";

const kilobytes = (bytes: number): string => `${(bytes / 1000).toFixed(1)} kB`;

export function priceText(price: Price): string {
  if (price.state === "sharp") return "It is as sharp as it gets: there is nothing to pay.";
  const { request, answer } = price.bytes;
  const when = price.heard_ago_s === null ? `; ${price.robot} was never heard, so nobody knows when`
    : price.seconds === null ? `; no bound on when: ${price.robot} has more to see or to learn, which takes most of its budget` : `, at most ${Math.ceil(price.seconds)} s`;
  const ago = price.heard_ago_s !== null && price.heard_ago_s > 60 ? ` (${price.robot} was last heard ${seconds(price.heard_ago_s)} ago)` : "";
  return `A sharper one costs at most ${kilobytes(request + answer)} on the link (${request} B to ask, ${answer} B to answer)${when}${ago}.`;
}

// isLive: there is somebody to ask; mayAsk: and this page may.
export function closer(pictures: Pictures, p: Picture, isLive: boolean, mayAsk: boolean): HTMLElement {
  const said = el("p", { class: "price", role: "status" }, isLive ? "asking for the price…" : "The mission is over: nobody can make it sharper.");
  const hands = el("div", { class: "buttons" });
  if (isLive) void price();
  async function price(): Promise<void> {
    try {
      const known = await ask<Price>(`/api/ask?robot=${p.robot}&topic=${p.topic}&example=${p.example}`);
      said.textContent = priceText(known);
      if (known.state !== "sharp" && mayAsk) hands.replaceChildren(el("button", { class: "pay", click: () => void pay() }, "Ask for it"));
      else if (known.state !== "sharp") said.textContent += " Open the URL that serve printed to ask for it.";
    } catch (problem) { said.textContent = (problem as Error).message; }
  }
  async function pay(): Promise<void> {
    hands.replaceChildren();
    try {
      const answer = await askSharper({ robot: p.robot, topic: p.topic, example: p.example });
      said.textContent = answer.state === "sharp" ? "It has come." : "Asked. It comes when the link allows, here and to all nodes.";
    } catch (problem) { said.textContent = (problem as Error).message; }
  }
  return el("div", { class: "closer" }, pictures.image("closer", p),
    el("div", {}, el("p", {}, `As ${p.robot} saw its topic ${p.topic} at ${seconds(p.seen_s)}.`), said, hands));
}
