// SPDX-License-Identifier: BSD-3-Clause
// Two fingers on a canvas.

export class Pinch {
  private readonly fingers = new Map<number, [number, number]>();
  private last: [number, number, number] | null = null; // distance, middle

  constructor(canvas: HTMLElement) {
    canvas.addEventListener("pointerdown", (e) => { if (e.pointerType === "touch") { this.put(e); if (this.isOn) this.step(); } });
    canvas.addEventListener("pointermove", (e) => { if (this.fingers.has(e.pointerId)) this.put(e); });
    for (const end of ["pointerup", "pointercancel"] as const) canvas.addEventListener(end, (e) => { this.fingers.delete(e.pointerId); this.last = null; });
  }

  get isOn(): boolean { return this.fingers.size === 2; }

  // Since the last step: by how much they went apart, and around which place of the canvas, pixels.
  step(): [number, number, number] {
    const [[ax, ay], [bx, by]] = [...this.fingers.values()];
    const now: [number, number, number] = [Math.max(1, Math.hypot(ax - bx, ay - by)), (ax + bx) / 2, (ay + by) / 2];
    const factor = this.last ? now[0] / this.last[0] : 1;
    this.last = now;
    return [factor, now[1], now[2]];
  }

  private put(e: PointerEvent): void { this.fingers.set(e.pointerId, [e.offsetX, e.offsetY]); }
}
