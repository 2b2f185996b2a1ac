// SPDX-License-Identifier: BSD-3-Clause
// The map on a canvas: squares of 256 x 256 columns kept as pictures, redrawn only where cells changed.
import { faded, parse, ramp, rgba, robotColor, surpriseColor } from "./colors";
import type { Label, Node, Track, TruthClass } from "./api";
import { SIDE, type Cells, type Tile, type TileSet } from "./tiles";

export type Layer = "label" | "certainty" | "surprise" | "age" | "robot" | "coverage" | "truth";
export const LAYERS: Layer[] = ["label", "certainty", "surprise", "age", "robot", "coverage", "truth"];
export interface Cell { x: number; y: number; z: number; label: number; seen: number; robot: number; certainty: number; surprise: number; truth: number | null }

const CHUNK = 8; // tiles along the edge of a picture
const SILENT_S = 5, HEARTBEAT_BYTES = 250, HEARTBEAT_SHARE = 0.1; // of the budget, at most, while content waits

// Another way to show the same cells, under this canvas.
export interface DepthView {
  forget(): void; // every cell is gone
  soil(tile: string): void; // its cells or their colours have changed
  frame(width: number, height: number): void;
  project(x: number, y: number, z: number): [number, number] | null; // metres to pixels; null: out of sight
  drawFrame(c: CanvasRenderingContext2D, width: number, height: number): void; // what lies over the robots
}

interface Chunk { canvas: HTMLCanvasElement; context: CanvasRenderingContext2D; x: number; y: number; tiles: Set<string> }

export class MapView {
  cellSize = 1; base = 0; sequence = 0; life = "";
  layer: Layer = "label"; selected: number | null = null; onlyRobot: number | null = null;
  showTracks = true; showRobots = true; tracksUntil = Infinity;
  center = { x: 0, y: 0 }; scale = 4; // metres; pixels a metre
  tracks: Track[] = []; nodes: Node[] = [];
  lastFrameMs = 0;
  covered = 0; bar = 34; // pixels at the right, at the top that something lies over
  showCross = false; // who has no mouse asks for what is under it
  depth: DepthView | null = null; // shown instead of the flat map
  readonly tiles = new Map<string, Tile>();
  private truth = new Map<string, Tile>(); // with classes as labels
  private truthColors = new Map<number, number>();
  private chunks = new Map<string, Chunk>();
  private dirty = new Set<string>();
  private colors = new Map<number, number>();
  private oldest = 0; private newest = 1;
  private painted = [0, 1]; // the oldest and newest that colours of ages were chosen for
  private asked = false;

  constructor(readonly canvas: HTMLCanvasElement) {}

  get isEmpty(): boolean { return this.tiles.size === 0; }

  take(set: TileSet): void {
    this.cellSize = set.cellSize; this.base = set.base; this.sequence = set.sequence; this.life = set.life;
    if (set.since === 0) { this.tiles.clear(); this.chunks.clear(); this.dirty.clear(); this.depth?.forget(); }
    for (const tile of set.tiles) {
      const key = tile.x + "," + tile.y;
      this.tiles.set(key, tile);
      this.soil(key);
    }
    this.oldest = Infinity; this.newest = -Infinity;
    for (const tile of this.tiles.values()) {
      if (tile.oldest < this.oldest) this.oldest = tile.oldest;
      if (tile.newest > this.newest) this.newest = tile.newest;
    }
    const step = (this.painted[1] - this.painted[0]) / 64; // less is not to be seen
    if (!(Math.abs(this.newest - this.painted[1]) <= step && Math.abs(this.oldest - this.painted[0]) <= step)) {
      this.painted = [this.oldest, this.newest];
      if (this.layer === "age") this.repaint();
    }
    this.draw();
  }

  private soil(key: string): void { this.dirty.add(key); this.depth?.soil(key); }

  setLabels(labels: Label[]): void {
    const before = this.colors;
    this.colors = new Map(labels.map((l) => [l.label, parse(l.color)]));
    if ([...this.colors].some(([label, color]) => before.get(label) !== color)) this.repaint();
  }

  setTruth(set: TileSet, classes: TruthClass[]): void {
    this.truth = new Map(set.tiles.map((t) => [t.x + "," + t.y, t]));
    this.truthColors = new Map(classes.map((c) => [c.id, parse(c.color)]));
    if (this.layer === "truth") this.repaint();
  }

  repaint(): void {
    for (const key of this.tiles.keys()) this.soil(key);
    this.draw();
  }

  ageRange(): [number, number] { return [0, Math.max(0, (this.newest - this.oldest) / 10)]; }

  // The colour of one of a tile's cells; `column` is where its truth stands.
  colorer(): (cells: Cells, i: number, tile: Tile, column: number) => number {
    const { selected, onlyRobot, layer, colors, truthColors } = this;
    const [oldest, newest] = this.painted, span = Math.max(1, newest - oldest);
    const grey = rgba(150, 150, 150), unknown = rgba(205, 209, 213), covered = rgba(68, 140, 150);
    const steps = Uint32Array.from({ length: 256 }, (_, i) => ramp(i / 255));
    const alarms = Uint32Array.from({ length: 64 }, (_, i) => surpriseColor(i / 8));
    const robots = new Map<number, number>();
    const plain = (cells: Cells, i: number, tile: Tile, column: number): number => {
      switch (layer) {
        case "label": return colors.get(cells.label[i]) ?? grey;
        case "certainty": return steps[cells.certainty[i]];
        case "surprise": return alarms[Math.min(63, cells.surprise[i])];
        case "age": return steps[Math.max(0, Math.min(255, Math.round(255 * (1 - (newest - cells.seen[i]) / span))))];
        case "robot": {
          let color = robots.get(cells.robot[i]);
          if (color === undefined) robots.set(cells.robot[i], (color = parse(robotColor(cells.robot[i]))));
          return color;
        }
        case "coverage": return covered;
        case "truth": return cells !== tile ? unknown : truthColors.get(this.truth.get(tile.x + "," + tile.y)?.label[column] ?? -1) ?? unknown;
      }
    };
    return (cells, i, tile, column) => {
      if (cells.label[i] < 0) return 0;
      const color = plain(cells, i, tile, column);
      return (selected === null || cells.label[i] === selected) && (onlyRobot === null || cells.robot[i] === onlyRobot) ? color : faded(color);
    };
  }

  private paint(): void {
    const color = this.colorer();
    const image = new ImageData(SIDE, SIDE);
    const pixels = new Uint32Array(image.data.buffer);
    for (const key of this.dirty) {
      const tile = this.tiles.get(key);
      if (!tile) continue;
      const cx = Math.floor(tile.x / CHUNK), cy = Math.floor(tile.y / CHUNK), chunkKey = cx + "," + cy;
      let chunk = this.chunks.get(chunkKey);
      if (!chunk) {
        const canvas = document.createElement("canvas");
        canvas.width = canvas.height = CHUNK * SIDE;
        chunk = { canvas, context: canvas.getContext("2d")!, x: cx, y: cy, tiles: new Set() };
        this.chunks.set(chunkKey, chunk);
      }
      chunk.tiles.add(key);
      for (let j = 0; j < SIDE; ++j) for (let i = 0; i < SIDE; ++i) pixels[(SIDE - 1 - j) * SIDE + i] = color(tile, j * SIDE + i, tile, j * SIDE + i);
      chunk.context.putImageData(image, (tile.x - cx * CHUNK) * SIDE, (CHUNK - 1 - (tile.y - cy * CHUNK)) * SIDE);
    }
    this.dirty.clear();
  }

  draw(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.frame(); });
  }

  toScreen(x: number, y: number): [number, number] {
    return [this.canvas.clientWidth / 2 + (x - this.center.x) * this.scale, this.canvas.clientHeight / 2 - (y - this.center.y) * this.scale];
  }
  toWorld(px: number, py: number): [number, number] {
    return [this.center.x + (px - this.canvas.clientWidth / 2) / this.scale, this.center.y - (py - this.canvas.clientHeight / 2) / this.scale];
  }

  private frame(): void {
    const begun = performance.now();
    const ratio = devicePixelRatio || 1, width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const c = this.canvas.getContext("2d")!;
    c.setTransform(1, 0, 0, 1, 0, 0);
    if (this.depth) {
      c.clearRect(0, 0, this.canvas.width, this.canvas.height);
      c.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.depth.frame(width, height);
      this.drawRobots(c);
      this.depth.drawFrame(c, width, height);
    } else {
      this.drawFlat(c, ratio, width, height);
      c.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.drawRobots(c);
      this.drawScale(c, height);
    }
    if (this.showCross) this.drawCross(c);
    this.lastFrameMs = performance.now() - begun;
  }

  private drawFlat(c: CanvasRenderingContext2D, ratio: number, width: number, height: number): void {
    this.paint();
    c.fillStyle = "#eef0f2";
    c.fillRect(0, 0, this.canvas.width, this.canvas.height);
    const side = CHUNK * SIDE * this.cellSize;
    c.imageSmoothingEnabled = this.scale * this.cellSize * ratio < 1;
    for (const chunk of this.chunks.values()) {
      // Index i is centred at i x size: its low edge half a cell below. Edges are rounded alike, so that none gapes.
      const [left, bottom] = this.toScreen(chunk.x * side - this.cellSize / 2, chunk.y * side - this.cellSize / 2);
      const [right, top] = this.toScreen((chunk.x + 1) * side - this.cellSize / 2, (chunk.y + 1) * side - this.cellSize / 2);
      if (right < 0 || left > width || bottom < 0 || top > height) continue;
      const x = Math.round(left * ratio), y = Math.round(top * ratio);
      c.drawImage(chunk.canvas, x, y, Math.round(right * ratio) - x, Math.round(bottom * ratio) - y);
    }
  }

  private drawRobots(c: CanvasRenderingContext2D): void {
    const newest = Math.max(...this.nodes.map((n) => n.heard_s), 0);
    const project = (p: number[]): [number, number] | null => this.depth ? this.depth.project(p[1], p[2], p[3]) : this.toScreen(p[1], p[2]);
    const last = new Map<string, number[]>();
    for (const node of this.nodes) if (node.observation >= 0) last.set(node.name, [node.heard_s, ...node.position_m]);
    c.lineJoin = "round";
    for (const track of this.tracks) {
      const points: number[][] = track.points.filter((p) => p[0] <= this.tracksUntil);
      if (points.length === 0) continue;
      // Status comes more often than tracks; of the past only tracks tell.
      const end = points[points.length - 1], now = last.get(track.robot);
      if (now && this.tracksUntil === Infinity && now[0] > end[0]) points.push(now);
      else last.set(track.robot, end);
      if (!this.showTracks) continue;
      const number = Number(track.robot.slice(1));
      for (const [style, thickness] of [["rgba(255,255,255,.75)", 3.5], [robotColor(number), 1.5]] as const) {
        c.strokeStyle = style;
        c.lineWidth = thickness;
        c.globalAlpha = this.onlyRobot === null || this.onlyRobot === number ? 0.9 : 0.15;
        c.beginPath();
        let down = false;
        for (const p of points) {
          const at = project(p);
          if (at && down) c.lineTo(...at); else if (at) c.moveTo(...at);
          down = at !== null;
        }
        c.stroke();
      }
      c.globalAlpha = 1;
    }
    if (!this.showRobots) return;
    c.font = "600 11px system-ui, sans-serif";
    c.textBaseline = "middle";
    for (const node of this.nodes) {
      if (node.phase === "node" || node.observation < 0) continue;
      const where = last.get(node.name)!, at = project(where);
      if (!at) continue;
      const [x, y] = at;
      const color = isSilent(node, newest) ? "#8a8f96" : robotColor(Number(node.name.slice(1)));
      const below = this.depth?.project(where[1], where[2], 0);
      if (below) { // where over the map it is
        c.strokeStyle = color; c.lineWidth = 1; c.setLineDash([3, 3]);
        c.beginPath(); c.moveTo(x, y); c.lineTo(...below); c.stroke();
        c.setLineDash([]);
        c.beginPath(); c.arc(...below, 2, 0, 2 * Math.PI); c.fillStyle = color; c.fill();
      }
      c.beginPath();
      c.arc(x, y, 6, 0, 2 * Math.PI);
      c.fillStyle = node.phase === "flying" ? color : "#fff";
      c.fill();
      c.lineWidth = 2.5;
      c.strokeStyle = node.phase === "flying" ? "#fff" : color;
      c.stroke();
      const width = c.measureText(node.name).width + 8;
      c.fillStyle = "rgba(255,255,255,.88)";
      c.beginPath();
      c.roundRect(x + 9, y - 8, width, 16, 4);
      c.fill();
      c.fillStyle = "#1d2733";
      c.fillText(node.name, x + 13, y + 0.5);
    }
  }

  // The middle of what is to be seen of the map, pixels.
  cross(): [number, number] {
    const bar = this.bar + 18;
    return [(this.canvas.clientWidth - this.covered) / 2, bar + (this.canvas.clientHeight - bar) / 2];
  }
  private drawCross(c: CanvasRenderingContext2D): void {
    const [x, y] = this.cross();
    for (const [color, thickness] of [["#fff", 4], ["#1d2733", 1.5]] as const) {
      c.strokeStyle = color; c.lineWidth = thickness;
      c.beginPath();
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) { c.moveTo(x + 4 * dx, y + 4 * dy); c.lineTo(x + 14 * dx, y + 14 * dy); }
      c.stroke();
    }
  }

  private drawScale(c: CanvasRenderingContext2D, height: number): void {
    const goal = 110 / this.scale, power = 10 ** Math.floor(Math.log10(goal));
    const metres = [5, 2, 1].map((k) => k * power).find((m) => m <= goal) ?? power;
    const width = metres * this.scale, y = height - 18;
    c.fillStyle = "rgba(255,255,255,.88)";
    c.beginPath(); c.roundRect(12, y - 18, width + 16, 28, 5); c.fill();
    c.strokeStyle = "#1d2733"; c.lineWidth = 1.5;
    c.beginPath(); c.moveTo(20, y - 3); c.lineTo(20, y + 2); c.lineTo(20 + width, y + 2); c.lineTo(20 + width, y - 3); c.stroke();
    c.fillStyle = "#1d2733"; c.font = "11px system-ui, sans-serif"; c.textBaseline = "alphabetic";
    c.fillText(`${metres} m`, 24, y - 4);
  }

  // The column's highest cell, or the one nearest to a height.
  cellAt(x: number, y: number, z: number | null = null): Cell | null {
    const cx = Math.floor(x / this.cellSize + 0.5), cy = Math.floor(y / this.cellSize + 0.5);
    const tx = Math.floor(cx / SIDE), ty = Math.floor(cy / SIDE);
    const tile = this.tiles.get(tx + "," + ty);
    const i = (cy - ty * SIDE) * SIDE + (cx - tx * SIDE);
    if (!tile || tile.label[i] < 0) return null;
    let best = this.cellOf(tile, tile, i, i);
    tile.lower.place.forEach((place, n) => {
      if (z === null || place !== i) return;
      const cell = this.cellOf(tile, tile.lower, n, i);
      if (Math.abs(cell.z - z) < Math.abs(best.z - z)) best = cell;
    });
    return best;
  }

  cellOf(tile: Tile, cells: Cells, i: number, column: number): Cell {
    const truth = cells === tile ? this.truth.get(tile.x + "," + tile.y)?.label[column] ?? -1 : -1;
    return { x: (tile.x * SIDE + column % SIDE) * this.cellSize, y: (tile.y * SIDE + Math.floor(column / SIDE)) * this.cellSize, z: cells.height[i] * this.cellSize,
             truth: truth < 0 ? null : truth, label: cells.label[i], seen: this.base + cells.seen[i] / 10, robot: cells.robot[i], certainty: cells.certainty[i] / 255, surprise: cells.surprise[i] / 8 };
  }

  // The box around all cells, indices: x, y and z from, x, y and z to; null while there are none.
  bounds(): [number, number, number, number, number, number] | null {
    let [x0, y0, z0, x1, y1, z1] = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
    for (const { x, y, box, span } of this.tiles.values()) if (box) {
      x0 = Math.min(x0, x * SIDE + box[0]); y0 = Math.min(y0, y * SIDE + box[1]); z0 = Math.min(z0, span[0]);
      x1 = Math.max(x1, x * SIDE + box[2]); y1 = Math.max(y1, y * SIDE + box[3]); z1 = Math.max(z1, span[1]);
    }
    return x0 > x1 ? null : [x0, y0, z0, x1, y1, z1];
  }

  fit(): void {
    const bounds = this.bounds();
    if (!bounds) return;
    const [x0, y0, , x1, y1] = bounds;
    this.center = { x: ((x0 + x1) / 2) * this.cellSize, y: ((y0 + y1) / 2) * this.cellSize };
    // The bar above the map hides nothing.
    const bar = this.bar + 18, height = Math.max(50, this.canvas.clientHeight - bar), width = Math.max(50, this.canvas.clientWidth - this.covered);
    this.scale = 0.95 * Math.min(width / ((x1 - x0 + 1) * this.cellSize), height / ((y1 - y0 + 1) * this.cellSize));
    this.center.x += this.covered / 2 / this.scale;
    this.center.y += bar / 2 / this.scale;
    this.draw();
  }

  zoom(factor: number, px = this.canvas.clientWidth / 2, py = this.canvas.clientHeight / 2): void {
    const [x, y] = this.toWorld(px, py);
    this.scale = Math.max(0.02, Math.min(400, this.scale * factor));
    const [nx, ny] = this.toWorld(px, py);
    this.center = { x: this.center.x + x - nx, y: this.center.y + y - ny };
    this.draw();
  }

  pan(px: number, py: number): void {
    this.center = { x: this.center.x - px / this.scale, y: this.center.y + py / this.scale };
    this.draw();
  }
}

// Heard last while others were heard later, and not because it has landed.
// Four heartbeats, as seldom as its budget makes them.
export const isSilent = (node: Node, newest: number): boolean =>
  node.phase === "flying" && newest - node.heard_s > Math.max(SILENT_S, node.budget > 0 ? (4 * HEARTBEAT_BYTES) / (HEARTBEAT_SHARE * node.budget) : 0);
