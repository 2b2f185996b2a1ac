// SPDX-License-Identifier: BSD-3-Clause
// The map as the server sends it: squares of 32 x 32 columns, as typed arrays over the bytes of the answer.

export const SIDE = 32;
const COLUMNS = SIDE * SIDE;

export interface Cells { label: Int32Array; seen: Int32Array; robot: Int16Array; height: Int16Array; certainty: Uint8Array; surprise: Uint8Array }
export interface Tile extends Cells {
  x: number; y: number;
  lower: Cells & { place: Uint16Array }; // what lies under the columns' highest cells, when it was asked for
  oldest: number; newest: number; // of `seen`; Infinity, -Infinity for an empty tile
  count: number; // of columns that were seen
  box: [number, number, number, number] | null; // columns that were seen: from i, j to i, j
  span: [number, number]; // of `height`, lower cells too
}

export interface TileSet { cellSize: number; base: number; sequence: number; since: number; life: string; tiles: Tile[] }

// Throws what is wrong with the bytes.
export function decodeTiles(buffer: ArrayBuffer): TileSet {
  const view = new DataView(buffer);
  if (buffer.byteLength < 48 || view.getUint32(0, true) !== 0x32544853) throw new Error("these bytes are no map");
  const count = view.getUint32(4, true), tiles: Tile[] = [];
  let at = 48;
  const shorts = (n: number): Int16Array => { const a = new Int16Array(buffer, at, n); at += 2 * n; return a; };
  const places = (n: number): Uint16Array => { const a = new Uint16Array(buffer, at, n); at += 2 * n; return a; };
  const longs = (n: number): Int32Array => { const a = new Int32Array(buffer, at, n); at += 4 * n; return a; };
  const bytes = (n: number): Uint8Array => { const a = new Uint8Array(buffer, at, n); at += n; return a; };
  try {
    for (let i = 0; i < count; ++i) {
      const x = view.getInt32(at, true), y = view.getInt32(at + 4, true), n = view.getUint32(at + 8, true);
      at += 16;
      const top = { label: longs(COLUMNS), seen: longs(COLUMNS), robot: shorts(COLUMNS), height: shorts(COLUMNS), certainty: bytes(COLUMNS), surprise: bytes(COLUMNS) };
      const lower = { label: longs(n), seen: longs(n), place: places(n), height: shorts(n), robot: shorts(n), certainty: bytes(n), surprise: bytes(n) };
      tiles.push(measured({ x, y, ...top, lower, oldest: Infinity, newest: -Infinity, count: 0, box: null, span: [0, 0] }));
    }
  } catch { at = -1; }
  if (at !== buffer.byteLength) throw new Error("this map was cut short");
  return {
    cellSize: view.getFloat64(8, true), base: view.getFloat64(16, true), sequence: Number(view.getBigUint64(24, true)),
    since: Number(view.getBigUint64(32, true)), life: view.getBigUint64(40, true).toString(), tiles,
  };
}

function measured(tile: Tile): Tile {
  let [i0, j0, i1, j1, low, high] = [SIDE, SIDE, -1, -1, Infinity, -Infinity];
  for (let j = 0, at = 0; j < SIDE; ++j) for (let i = 0; i < SIDE; ++i, ++at) if (tile.label[at] >= 0) {
    ++tile.count;
    if (i < i0) i0 = i;
    if (i > i1) i1 = i;
    if (j < j0) j0 = j;
    j1 = j;
    const seen = tile.seen[at], height = tile.height[at];
    if (seen < tile.oldest) tile.oldest = seen;
    if (seen > tile.newest) tile.newest = seen;
    if (height < low) low = height;
    if (height > high) high = height;
  }
  for (const height of tile.lower.height) if (height < low) low = height;
  if (i1 >= 0) { tile.box = [i0, j0, i1, j1]; tile.span = [low, high]; }
  return tile;
}
