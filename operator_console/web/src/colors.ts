// SPDX-License-Identifier: BSD-3-Clause
// Colours. Those of labels come from the server: they are those of global_map.png. Little-endian RGBA words.

export const rgba = (r: number, g: number, b: number): number => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
export const parse = (hex: string): number =>
  rgba(parseInt(hex.slice(1, 3), 16), parseInt(hex.slice(3, 5), 16), parseInt(hex.slice(5, 7), 16));

// Cividis: dark blue to yellow, even in lightness, alike for people who see colours differently.
const STOPS = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];
export function ramp(share: number): number {
  const at = Math.max(0, Math.min(1, share)) * (STOPS.length - 1);
  const i = Math.min(STOPS.length - 2, Math.floor(at)), f = at - i;
  const mix = (c: number): number => Math.round(STOPS[i][c] * (1 - f) + STOPS[i + 1][c] * f);
  return rgba(mix(0), mix(1), mix(2));
}
export const rampCss = `linear-gradient(90deg, ${STOPS.map((s) => `rgb(${s})`).join(", ")})`;

// What stands out: from pale to dark red, and what does not in pale grey. Steps of 1/8 up to 6; more is as dark.
const ALARM = [[254, 217, 142], [254, 153, 41], [217, 95, 14], [153, 52, 4], [82, 20, 0]];
export const LEAST_SURPRISE = 1.5, MOST_SURPRISE = 6;
export const USUAL = "#d5dae0";
export function surpriseColor(surprise: number): number {
  if (surprise <= 0) return parse(USUAL);
  const at = Math.max(0, Math.min(1, (surprise - LEAST_SURPRISE) / (MOST_SURPRISE - LEAST_SURPRISE))) * (ALARM.length - 1);
  const i = Math.min(ALARM.length - 2, Math.floor(at)), mix = (c: number): number => Math.round(ALARM[i][c] + (at - i) * (ALARM[i + 1][c] - ALARM[i][c]));
  return rgba(mix(0), mix(1), mix(2));
}
export const alarmCss = `linear-gradient(90deg, ${ALARM.map((s) => `rgb(${s})`).join(", ")})`;

// Okabe and Ito's, then Tol's muted ones.
const ROBOTS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#332288", "#999933", "#882255", "#44aa99",
                "#117733", "#aa4499"];
export const robotColor = (robot: number): string => ROBOTS[((robot % ROBOTS.length) + ROBOTS.length) % ROBOTS.length];

// Classes of traffic, in the order in which they are sent.
const CLASSES: Record<string, string> = {
  heartbeat: "#7f8c9b", matches: "#332288", topics: "#0072b2", bricks: "#009e73", certainty: "#e69f00", pictures: "#cc79a7",
  repair: "#d55e00", local: "#bbbbbb", sent: "#0072b2",
};
export const classColor = (name: string): string => CLASSES[name] ?? "#882255";

// Towards the paper: what is not meant just now.
export const faded = (c: number): number => {
  const f = (shift: number, paper: number): number => Math.round(((c >>> shift) & 255) * 0.18 + paper * 0.82);
  return rgba(f(0, 240), f(8, 242), f(16, 244));
};
