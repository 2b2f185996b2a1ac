// SPDX-License-Identifier: BSD-3-Clause
// Bytes per second on the link over mission time, stacked by class of traffic, with the budget as a line.
import { classColor } from "./colors";
import type { Traffic } from "./api";

export function drawLink(canvas: HTMLCanvasElement, traffic: Traffic, only: string | null, until: number): void {
  const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const c = canvas.getContext("2d")!;
  c.scale(ratio, ratio);
  const nodes = traffic.nodes.filter((n) => only === null || n.node === only);
  const sums = new Map<number, number[]>();
  for (const node of nodes) for (const [t, ...bytes] of node.bins) {
    const sum = sums.get(t) ?? bytes.map(() => 0);
    bytes.forEach((b, i) => (sum[i] += b / traffic.bin_s));
    sums.set(t, sum);
  }
  const times = [...sums.keys()].sort((a, b) => a - b);
  if (times.length < 2) { // of a run without its recording nothing is known but the sums
    c.fillStyle = "#5b6673"; c.font = "12px system-ui, sans-serif"; c.textAlign = "center";
    c.fillText(times.length === 0 ? "nothing has been sent" : "only a recording knows when what was sent", width / 2, height / 2);
    return;
  }
  const budget = nodes.every((n) => n.budget > 0) ? nodes.reduce((s, n) => s + n.budget, 0) : 0;
  const peak = Math.max(...[...sums.values()].map((s) => s.reduce((a, b) => a + b, 0)), 1);
  const top = budget > 0 && budget < 3 * peak ? Math.max(peak, budget * 1.08) : peak * 1.05;
  const left = 54, bottom = height - 16, plot = bottom - 8;
  const first = times[0], last = Math.max(times[times.length - 1] + traffic.bin_s, first + traffic.bin_s);
  const x = (t: number): number => left + ((t - first) / (last - first)) * (width - left - 4);
  for (const t of times) {
    let y = bottom;
    sums.get(t)!.forEach((rate, i) => {
      const h = (rate / top) * plot;
      c.fillStyle = classColor(traffic.classes[i]);
      c.globalAlpha = t <= until ? 1 : 0.25;
      c.fillRect(x(t), y - h, Math.max(1, x(t + traffic.bin_s) - x(t) - 0.5), h);
      y -= h;
    });
  }
  c.globalAlpha = 1;
  c.strokeStyle = "#c9ced4";
  c.beginPath(); c.moveTo(left, bottom + 0.5); c.lineTo(width - 4, bottom + 0.5); c.stroke();
  c.fillStyle = "#5b6673"; c.font = "11px system-ui, sans-serif"; c.textAlign = "right";
  c.fillText(rateText(top), left - 5, 14);
  c.fillText("0", left - 5, bottom);
  c.textAlign = "left"; c.fillText(`${Math.round(first)} s`, left, height - 3);
  c.textAlign = "right"; c.fillText(`${Math.round(last)} s`, width - 4, height - 3);
  if (budget > 0 && budget <= top) {
    const y = bottom - (budget / top) * plot;
    c.strokeStyle = "#b3261e"; c.setLineDash([5, 4]); c.beginPath(); c.moveTo(left, y); c.lineTo(width - 4, y); c.stroke(); c.setLineDash([]);
    c.fillStyle = "#b3261e"; c.fillText("budget", width - 6, y - 3);
  }
}

export const rateText = (rate: number): string => (rate >= 10000 ? `${(rate / 1000).toFixed(0)} kB/s` : rate >= 1000 ? `${(rate / 1000).toFixed(1)} kB/s` : `${Math.round(rate)} B/s`);
