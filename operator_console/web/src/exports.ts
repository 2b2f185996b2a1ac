// SPDX-License-Identifier: BSD-3-Clause
// The dialog with all files that other programs read.
import type { Mission } from "./api";
import { byId, el } from "./dom";

const KEPT = "shoal origin";

export function openExports(mission: Mission): void {
  const box = byId<HTMLDialogElement>("exports");
  const field = (name: string, what: string): HTMLInputElement => el("input", { id: "at" + name, inputmode: "decimal", size: "13", "data-what": what }) as HTMLInputElement;
  const fields = [field("latitude", "latitude °"), field("longitude", "longitude °"), field("heading", "heading °")];
  (JSON.parse(localStorage.getItem(KEPT) ?? "[]") as string[]).forEach((text, i) => { if (fields[i]) fields[i].value = text; });
  const links = mission.exports.map((f) => {
    const link = el("a", { class: "button", "data-format": f.format }, f.beside.length > 0 ? f.file + ".zip" : f.file);
    return { f, link, row: el("tr", {}, el("td", {}, link), el("td", {}, f.what), el("td", { class: "dim" }, f.origin === "no" ? "metres" : f.origin === "may" ? "metres or on Earth" : "on Earth")) };
  });
  const fault = el("p", { class: "fault", role: "status" });
  const update = (): void => {
    const [latitude, longitude, heading] = fields.map((i) => i.value.trim());
    const given = latitude !== "" || longitude !== "";
    const within = (text: string, limit: number): boolean => text !== "" && Math.abs(Number(text)) <= limit;
    const good = within(latitude, 89) && within(longitude, 180) && (heading === "" || within(heading, 360));
    fault.textContent = given && !good ? "An origin is a latitude within ±89° and a longitude within ±180°; the heading lies within ±360°." : "";
    localStorage.setItem(KEPT, JSON.stringify([latitude, longitude, heading]));
    for (const { f, link } of links) {
      const earth = given && good && f.origin !== "no";
      const query = new URLSearchParams({ format: f.format, ...(f.beside.length > 0 ? { packed: "zip" } : {}), ...(earth ? { latitude, longitude, ...(heading === "" ? {} : { heading }) } : {}) });
      const off = f.origin === "must" && !earth;
      link.classList.toggle("off", off);
      link.title = off ? "Say first where the mission was." : f.beside.length > 0 ? "with " + f.beside.join(", ") : "";
      if (off) { link.removeAttribute("href"); link.removeAttribute("download"); }
      else { link.setAttribute("href", "/api/export?" + query.toString()); link.setAttribute("download", ""); }
    }
  };
  fields.forEach((i) => i.addEventListener("input", update));
  box.replaceChildren(el("h2", {}, "The map for other programs"), el("table", {}, ...links.map((l) => l.row)),
    el("h3", {}, "Where on Earth was (0, 0)?"), el("p", { class: "dim" }, "Degrees of WGS 84. The heading is where +Y points, clockwise from true north; empty: north."),
    el("p", { class: "origin" }, ...fields.map((i) => el("label", {}, i.dataset.what!, i))), fault, el("form", { method: "dialog" }, el("button", {}, "Close")));
  update();
  if (!box.open) box.showModal();
}
