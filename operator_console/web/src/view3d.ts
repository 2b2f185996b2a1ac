// SPDX-License-Identifier: BSD-3-Clause
// The same cells in 3-D, on a canvas of their own under the flat map's. Fetched when somebody first asks for it.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, ColorManagement, DynamicDrawUsage, Frustum, GridHelper, InstancedBufferAttribute, InstancedBufferGeometry,
  LinearSRGBColorSpace, Matrix4, Mesh, PerspectiveCamera, Points, Scene, ShaderMaterial, Sphere, Vector3, WebGLRenderer,
} from "three";
import type { Cell, DepthView, MapView } from "./map_view";
import { SIDE, type Cells, type Tile } from "./tiles";

const CHUNK = 4; // tiles along the edge of what is drawn at once
const COLUMNS = SIDE * SIDE;
const FIELD_OF_VIEW = 45; // degrees, up and down
const MOST_BOXES = { hardware: 400_000, software: 60_000 }; // more cells are drawn as squares that face the eye
// Columns of every fourth row and line come first, then of every second, then the others, so that who has no hardware for it
// draws a part of many cells, larger, while something moves.
const STRIDES = [4, 2, 1];
const MOST_SQUARES = { hardware: 4_000_000, software: 60_000 }; // while something moves
const STILL_MS = 700;
const levelOf = (column: number): number => { const any = (column % SIDE) | (column >> 5); return any & 1 ? 2 : any & 2 ? 1 : 0; };
const LEVEL = Uint8Array.from({ length: COLUMNS }, (_, column) => levelOf(column));

interface Range { start: number; capacity: number }
interface Slot { ranges: Range[]; used: number } // a range a level
interface Chunk {
  x: number; y: number; slots: Map<string, Slot>; object: Mesh | Points | null; offsets: BufferAttribute; colors: BufferAttribute; sphere: Sphere;
  upTo: number[]; // of the buffers, by level
}
export interface Camera { azimuth: number; elevation: number; distance: number; z: number } // degrees, metres

ColorManagement.enabled = false;
// A cell without colour is nowhere.
const BOX = `attribute vec3 offset; attribute vec4 shade; uniform float size; varying vec3 color; varying vec3 place;
void main() { place = position; color = shade.rgb * (0.62 + 0.38 * max(0.0, normal.z) + 0.16 * abs(normal.x));
  gl_Position = shade.a < 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * modelViewMatrix * vec4(position * size + offset, 1.0); }`;
const EDGED = `varying vec3 color; varying vec3 place;
void main() { vec3 face = abs(place); float edge = face.x + face.y + face.z - max(face.x, max(face.y, face.z)) - min(face.x, min(face.y, face.z)), pixel = fwidth(edge);
  gl_FragColor = vec4(color * (1.0 - 0.22 * smoothstep(0.5 - 1.5 * pixel, 0.5, edge) * (1.0 - smoothstep(0.04, 0.12, pixel))), 1.0); }`; // thin lines, when they are not all there is
const SQUARE = `attribute vec4 shade; uniform float size; uniform float scale; varying vec3 color;
void main() { color = shade.rgb; vec4 at = modelViewMatrix * vec4(position, 1.0);
  gl_Position = shade.a < 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * at; gl_PointSize = max(1.0, 1.15 * size * scale / -at.z); }`;
const PAINT = `varying vec3 color; void main() { gl_FragColor = vec4(color, 1.0); }`;

export class View3D implements DepthView {
  azimuth = -20; elevation = 50; distance = 100; // from where the eye looks: 0 is from the south, 90 from straight above
  readonly target = new Vector3();
  drawn = 0; // cells
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 1000);
  private readonly chunks = new Map<string, Chunk>();
  private readonly dirty = new Set<string>();
  private readonly boxes: ShaderMaterial; private readonly squares: ShaderMaterial;
  private readonly box = new BoxGeometry(1, 1, 1);
  private readonly isSoftware: boolean;
  private asBoxes = true;
  private grid: GridHelper | null = null; private gridStep = 0;
  private width: number; private height: number; // of the canvas, as of the last frame
  private eye = "";
  private movedAt = -Infinity; private later = 0; // when the eye or a cell moved last

  // Throws when this browser has no WebGL.
  constructor(readonly canvas: HTMLCanvasElement, private readonly map: MapView) {
    const probe = document.createElement("canvas").getContext("webgl2"), names = probe?.getExtension("WEBGL_debug_renderer_info");
    this.isSoftware = !probe || /swiftshader|llvmpipe|softpipe|software/i.test(String(probe.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? probe.RENDERER)));
    probe?.getExtension("WEBGL_lose_context")?.loseContext();
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.isSoftware, powerPreference: "high-performance" });
    this.renderer.outputColorSpace = LinearSRGBColorSpace; // colours are shown as they are given
    this.renderer.setClearColor(0xeef0f2, 1);
    const uniforms = { size: { value: 1 }, scale: { value: 1 } };
    this.boxes = new ShaderMaterial({ vertexShader: BOX, fragmentShader: EDGED, uniforms });
    this.squares = new ShaderMaterial({ vertexShader: SQUARE, fragmentShader: PAINT, uniforms });
    this.camera.up.set(0, 0, 1);
    this.width = Math.max(1, map.canvas.clientWidth); this.height = Math.max(1, map.canvas.clientHeight);
    this.renderer.setSize(this.width, this.height, false);
    for (const key of map.tiles.keys()) this.soil(key);
  }

  forget(): void {
    for (const chunk of this.chunks.values()) this.drop(chunk);
    this.chunks.clear(); this.dirty.clear();
  }
  soil(tile: string): void { this.dirty.add(tile); }

  // ---------- cells into buffers

  private drop(chunk: Chunk): void {
    if (!chunk.object) return;
    this.scene.remove(chunk.object);
    chunk.object.geometry.dispose();
    chunk.object = null;
  }

  private build(): void {
    const cells = [...this.map.tiles.values()].reduce((sum, tile) => sum + tile.count + tile.lower.label.length, 0);
    const asBoxes = cells <= (this.isSoftware ? MOST_BOXES.software : MOST_BOXES.hardware);
    if (asBoxes !== this.asBoxes) { this.forget(); for (const key of this.map.tiles.keys()) this.soil(key); }
    this.asBoxes = asBoxes;
    if (this.dirty.size === 0) return;
    this.movedAt = performance.now();
    const color = this.map.colorer(), grown = new Map<string, Chunk>(), fill: [Chunk, Tile, Slot][] = [];
    for (const key of this.dirty) {
      const tile = this.map.tiles.get(key);
      if (!tile) continue;
      const cx = Math.floor(tile.x / CHUNK), cy = Math.floor(tile.y / CHUNK), chunkKey = cx + "," + cy;
      let chunk = this.chunks.get(chunkKey);
      if (!chunk) {
        const none = new BufferAttribute(new Float32Array(), 3);
        this.chunks.set(chunkKey, (chunk = { x: cx, y: cy, slots: new Map(), object: null, offsets: none, colors: none, sphere: new Sphere(), upTo: [] }));
      }
      const needs = STRIDES.map(() => 0), slot = chunk.slots.get(key);
      for (let column = 0; column < COLUMNS; ++column) if (tile.label[column] >= 0) ++needs[LEVEL[column]];
      for (const column of tile.lower.place) ++needs[LEVEL[column]];
      if (slot && slot.ranges.every((range, level) => range.capacity >= needs[level])) fill.push([chunk, tile, slot]);
      else { // room for some more, so that it does not grow each time
        const isFull = tile.count === COLUMNS && tile.lower.label.length === 0;
        chunk.slots.set(key, { ranges: needs.map((n) => ({ start: 0, capacity: isFull ? n : Math.ceil(1.3 * n) + 8 })), used: 0 });
        grown.set(chunkKey, chunk);
      }
    }
    this.dirty.clear();
    for (const chunk of grown.values()) {
      let room = 0;
      chunk.upTo = STRIDES.map((_, level) => {
        for (const { ranges } of chunk.slots.values()) { ranges[level].start = room; room += ranges[level].capacity; }
        return room;
      });
      this.drop(chunk);
      const attribute = (array: Float32Array | Uint8Array, size: number, normalized: boolean): BufferAttribute =>
        (this.asBoxes ? new InstancedBufferAttribute(array, size, normalized) : new BufferAttribute(array, size, normalized)).setUsage(DynamicDrawUsage);
      chunk.offsets = attribute(new Float32Array(3 * room), 3, false);
      chunk.colors = attribute(new Uint8Array(4 * room), 4, true);
      for (const [key, slot] of chunk.slots) this.fill(chunk, this.map.tiles.get(key)!, slot, color);
      chunk.object = this.asBoxes ? new Mesh(this.boxesOf(chunk), this.boxes) : new Points(this.squaresOf(chunk), this.squares);
      chunk.object.frustumCulled = false; // done here, by chunk
      this.scene.add(chunk.object);
    }
    for (const [chunk, tile, slot] of fill) {
      if ([...grown.values()].includes(chunk)) continue;
      this.fill(chunk, tile, slot, color);
      for (const { start, capacity } of slot.ranges) {
        chunk.offsets.addUpdateRange(3 * start, 3 * capacity);
        chunk.colors.addUpdateRange(4 * start, 4 * capacity);
      }
      chunk.offsets.needsUpdate = chunk.colors.needsUpdate = true;
    }
    this.measure();
  }

  private boxesOf(chunk: Chunk): BufferGeometry {
    const geometry = new InstancedBufferGeometry();
    geometry.index = this.box.index;
    geometry.attributes = { ...this.box.attributes, offset: chunk.offsets, shade: chunk.colors } as typeof geometry.attributes;
    geometry.instanceCount = chunk.offsets.count;
    return geometry;
  }

  private squaresOf(chunk: Chunk): BufferGeometry {
    return new BufferGeometry().setAttribute("position", chunk.offsets).setAttribute("shade", chunk.colors);
  }

  private fill(chunk: Chunk, tile: Tile, slot: Slot, color: ReturnType<MapView["colorer"]>): void {
    const size = this.map.cellSize, offsets = chunk.offsets.array as Float32Array, colors = new Uint32Array((chunk.colors.array as Uint8Array).buffer);
    const to = slot.ranges.map((range) => range.start);
    const put = (cells: Cells, i: number, column: number): void => {
      const at = to[LEVEL[column]]++;
      offsets[3 * at] = (tile.x * SIDE + (column % SIDE)) * size;
      offsets[3 * at + 1] = (tile.y * SIDE + (column >> 5)) * size;
      offsets[3 * at + 2] = cells.height[i] * size;
      colors[at] = color(cells, i, tile, column);
    };
    for (let i = 0; i < COLUMNS; ++i) if (tile.label[i] >= 0) put(tile, i, i);
    for (let i = 0; i < tile.lower.label.length; ++i) put(tile.lower, i, tile.lower.place[i]);
    slot.used = 0;
    slot.ranges.forEach((range, level) => {
      colors.fill(0, to[level], range.start + range.capacity);
      slot.used += to[level] - range.start;
    });
  }

  // How far each chunk reaches, and the ground under all.
  private measure(): void {
    const size = this.map.cellSize, bounds = this.map.bounds();
    this.drawn = 0;
    for (const chunk of this.chunks.values()) {
      let [low, high] = [Infinity, -Infinity];
      for (const [key, slot] of chunk.slots) {
        const { span, box } = this.map.tiles.get(key)!;
        this.drawn += slot.used;
        if (box) { low = Math.min(low, span[0]); high = Math.max(high, span[1]); }
      }
      const side = CHUNK * SIDE * size;
      chunk.sphere.center.set((chunk.x + 0.5) * side, (chunk.y + 0.5) * side, ((low + high) / 2) * size);
      chunk.sphere.radius = Math.hypot(side / Math.SQRT2, ((high - low) / 2 + 1) * size);
    }
    if (!bounds) return;
    const extent = size * Math.max(bounds[3] - bounds[0] + 1, bounds[4] - bounds[1] + 1), power = 10 ** Math.floor(Math.log10(extent / 5));
    const step = [5, 2, 1].map((k) => k * power).find((k) => k <= extent / 5) ?? power, lines = 2 * Math.ceil((0.75 * extent) / step);
    if (this.grid) { this.scene.remove(this.grid); this.grid.dispose(); }
    this.gridStep = step;
    this.grid = new GridHelper(lines * step, lines, 0xc4cbd3, 0xd5dae0);
    this.grid.rotation.x = Math.PI / 2;
    const middle = (from: number, to: number): number => Math.round(((from + to) / 2) * size / step) * step;
    this.grid.position.set(middle(bounds[0], bounds[3]), middle(bounds[1], bounds[4]), (bounds[2] - 0.6) * size);
    this.scene.add(this.grid);
  }

  // ---------- the eye

  private place(): void {
    const eye = [this.azimuth, this.elevation, this.distance, ...this.target, this.width, this.height].join(" ");
    if (eye !== this.eye) { this.eye = eye; this.movedAt = performance.now(); }
    const a = (this.azimuth * Math.PI) / 180, e = (this.elevation * Math.PI) / 180;
    this.camera.position.set(this.target.x + this.distance * Math.cos(e) * Math.sin(a), this.target.y - this.distance * Math.cos(e) * Math.cos(a), this.target.z + this.distance * Math.sin(e));
    // Straight from above, north is up whatever "up" is.
    this.camera.up.set(-Math.sin(a) * Math.sin(e), Math.cos(a) * Math.sin(e), Math.cos(e));
    this.camera.lookAt(this.target);
    this.camera.near = this.distance / 200; this.camera.far = this.distance * 40;
    this.camera.aspect = this.width / this.height;
    this.camera.updateProjectionMatrix(); this.camera.updateMatrixWorld();
  }

  frame(width: number, height: number): void {
    this.build();
    const ratio = this.isSoftware ? 1 : devicePixelRatio || 1;
    if (this.width !== width || this.height !== height || this.renderer.getPixelRatio() !== ratio) {
      this.width = width; this.height = height;
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
    }
    this.place();
    const seen = new Frustum().setFromProjectionMatrix(new Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse));
    for (const chunk of this.chunks.values()) if (chunk.object) chunk.object.visible = seen.intersectsSphere(chunk.sphere);
    const stride = this.asBoxes ? 1 : this.thin();
    this.boxes.uniforms.size.value = this.map.cellSize * stride;
    this.boxes.uniforms.scale.value = (height * ratio) / (2 * Math.tan((FIELD_OF_VIEW * Math.PI) / 360));
    this.squares.uniforms = this.boxes.uniforms;
    this.renderer.render(this.scene, this.camera);
  }

  // Draws as many levels as go at once; what is left out follows when nothing has moved for a while.
  private thin(): number {
    const visible = [...this.chunks.values()].filter((chunk) => chunk.object?.visible);
    const most = performance.now() - this.movedAt < STILL_MS ? MOST_SQUARES[this.isSoftware ? "software" : "hardware"] : Infinity;
    let level = STRIDES.length - 1;
    const count = (): number => visible.reduce((sum, chunk) => sum + chunk.upTo[level], 0);
    while (level > 0 && count() > most) --level;
    for (const chunk of visible) chunk.object!.geometry.setDrawRange(0, chunk.upTo[level]);
    clearTimeout(this.later);
    if (level < STRIDES.length - 1) this.later = window.setTimeout(() => this.map.draw(), STILL_MS + 50);
    return STRIDES[level];
  }

  project(x: number, y: number, z: number): [number, number] | null {
    const at = new Vector3(x, y, z).project(this.camera);
    return at.z < -1 || at.z > 1 ? null : [((at.x + 1) / 2) * this.width, ((1 - at.y) / 2) * this.height];
  }

  // How large the grid's squares are, and where north is.
  drawFrame(c: CanvasRenderingContext2D, _width: number, height: number): void {
    c.fillStyle = "rgba(255,255,255,.88)";
    c.beginPath(); c.roundRect(12, height - 38, 148, 30, 5); c.fill();
    c.fillStyle = "#1d2733"; c.font = "11px system-ui, sans-serif"; c.textBaseline = "middle"; c.textAlign = "left";
    const a = (-this.azimuth * Math.PI) / 180, [x, y] = [30, height - 23], lean = Math.max(0.45, Math.sin((this.elevation * Math.PI) / 180));
    const tip = (angle: number, length: number): [number, number] => [x + length * Math.sin(angle), y - length * Math.cos(angle) * lean];
    c.beginPath(); c.moveTo(...tip(a, 11)); c.lineTo(...tip(a + 2.5, 9)); c.lineTo(...tip(a + Math.PI, 4)); c.lineTo(...tip(a - 2.5, 9)); c.closePath(); c.fill();
    c.fillText("north", 47, y + 0.5);
    c.fillText(`grid ${this.gridStep} m`, 90, y + 0.5);
  }

  orbit(px: number, py: number): void {
    this.azimuth = ((((this.azimuth - px * 0.35 + 180) % 360) + 360) % 360) - 180;
    this.elevation = Math.max(3, Math.min(90, this.elevation + py * 0.35));
  }
  pan(px: number, py: number): void {
    const scale = (2 * this.distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360)) / this.height, a = (this.azimuth * Math.PI) / 180;
    const along = -px * scale, away = (py * scale) / Math.max(0.25, Math.sin((this.elevation * Math.PI) / 180));
    this.target.x += along * Math.cos(a) - away * Math.sin(a);
    this.target.y += along * Math.sin(a) + away * Math.cos(a);
  }
  zoom(factor: number): void { this.distance = Math.max(4 * this.map.cellSize, Math.min(1e6, this.distance / factor)); }

  fit(covered: number): void {
    const bounds = this.map.bounds();
    if (!bounds) return;
    const size = this.map.cellSize, [x0, y0, z0, x1, y1, z1] = bounds.map((i) => i * size);
    this.target.set((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2);
    const radius = Math.hypot(x1 - x0, y1 - y0, z1 - z0) / 2 + size, free = Math.max(0.3, 1 - covered / Math.max(1, this.width));
    this.distance = (radius * 0.92) / Math.sin((FIELD_OF_VIEW * Math.PI) / 360) / Math.min(1, (this.width * free) / this.height);
    this.pan((-covered / 2), 20);
  }

  // The flat map's view and back, so that both show the same place.
  look(center: { x: number; y: number }, scale: number): void {
    const bounds = this.map.bounds();
    this.target.set(center.x, center.y, bounds ? ((bounds[2] + bounds[5]) / 2) * this.map.cellSize : 0);
    this.distance = this.map.canvas.clientHeight / scale / (2 * Math.tan((FIELD_OF_VIEW * Math.PI) / 360));
  }
  scale(): number { return this.map.canvas.clientHeight / (2 * this.distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360)); }

  // The first cell that the eye meets at a pixel.
  pick(px: number, py: number): Cell | null {
    const from = this.camera.position, size = this.map.cellSize;
    const ray = new Vector3((2 * px) / this.width - 1, 1 - (2 * py) / this.height, 0.5).unproject(this.camera).sub(from).normalize();
    const origin = [from.x / size, from.y / size, from.z / size], way = [ray.x, ray.y, ray.z]; // in cells
    const meets = (x0: number, y0: number, z0: number, x1: number, y1: number, z1: number): number => {
      let near = 0, far = Infinity;
      const low = [x0, y0, z0], high = [x1, y1, z1];
      for (let k = 0; k < 3; ++k) {
        const a = (low[k] - 0.5 - origin[k]) / way[k], b = (high[k] + 0.5 - origin[k]) / way[k];
        near = Math.max(near, Math.min(a, b)); far = Math.min(far, Math.max(a, b));
      }
      return near <= far ? near : Infinity;
    };
    let best = Infinity, found: Cell | null = null;
    for (const tile of this.map.tiles.values()) {
      if (!tile.box) continue;
      const left = tile.x * SIDE, bottom = tile.y * SIDE;
      if (meets(left, bottom, tile.span[0], left + SIDE - 1, bottom + SIDE - 1, tile.span[1]) >= best) continue;
      const look = (cells: Cells, i: number, column: number): void => {
        const x = left + (column % SIDE), y = bottom + (column >> 5), at = meets(x, y, cells.height[i], x, y, cells.height[i]);
        if (at < best) { best = at; found = this.map.cellOf(tile, cells, i, column); }
      };
      for (let i = 0; i < COLUMNS; ++i) if (tile.label[i] >= 0) look(tile, i, i);
      for (let i = 0; i < tile.lower.label.length; ++i) look(tile.lower, i, tile.lower.place[i]);
    }
    return found;
  }
}
