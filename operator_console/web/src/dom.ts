// SPDX-License-Identifier: BSD-3-Clause
// Elements, made of text: nothing that a robot or an operator said is ever read as HTML.

export const byId = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

type Child = Node | string | null | false;
export function el(tag: string, attributes: Record<string, string | ((event: Event) => void)> = {}, ...children: Child[]): HTMLElement {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value);
  }
  element.append(...children.filter((c): c is Node | string => c !== null && c !== false));
  return element;
}

// What a row needs to be pressed by mouse and by key.
export const pressable = (act: () => void): Record<string, string | ((event: Event) => void)> => ({
  tabindex: "0", role: "button", click: act,
  keydown: (e) => { if (["Enter", " "].includes((e as KeyboardEvent).key) && e.target === e.currentTarget) { e.preventDefault(); e.stopPropagation(); act(); } },
});

// Fills a box anew; what had the focus in it has it again: rows and their buttons are known by data-key.
export function refill(box: HTMLElement, ...children: HTMLElement[]): void {
  const key = box.contains(document.activeElement) ? (document.activeElement as HTMLElement).dataset.key : undefined;
  box.replaceChildren(...children);
  if (key !== undefined) box.querySelector<HTMLElement>(`[data-key="${CSS.escape(key)}"]`)?.focus({ preventScroll: true });
}

export const seconds = (s: number): string => {
  if (s >= 1e8) return new Date(s * 1000).toISOString().slice(11, 19);
  const whole = Math.floor(s), m = Math.floor(whole / 60) % 60, h = Math.floor(whole / 3600);
  const pad = (n: number): string => String(n).padStart(2, "0");
  return h > 0 ? `${h}:${pad(m)}:${pad(whole % 60)}` : `${m}:${pad(whole % 60)}`;
};
export const area = (m2: number): string => (m2 >= 1000 ? `${Math.round(m2).toLocaleString("en")} m²` : m2 >= 10 ? `${m2.toFixed(0)} m²` : `${m2.toFixed(2)} m²`);
