// SPDX-License-Identifier: BSD-3-Clause
// The map as the server sends it: squares of 32 x 32 columns, as typed arrays over the bytes of the answer.

export const SIDE = 32;
const COLUMNS = SIDE * SIDE;

export interface Tile {
  x: number; y: number;
  label: Int32Array; seen: Int32Array; robot: Int16Array; height: Int16Array; certainty: Uint8Array;
}

export interface TileSet { cellSize: number; base: number; sequence: number; since: number; life: string; tiles: Tile[] }

// Throws what is wrong with the bytes.
export function decodeTiles(buffer: ArrayBuffer): TileSet {
  const view = new DataView(buffer);
  if (buffer.byteLength < 48 || view.getUint32(0, true) !== 0x31544853) throw new Error("these bytes are no map");
  const count = view.getUint32(4, true);
  const tileBytes = 8 + COLUMNS * 13;
  if (buffer.byteLength !== 48 + count * tileBytes) throw new Error("this map was cut short");
  const tiles: Tile[] = [];
  for (let i = 0, at = 48; i < count; ++i, at += tileBytes) {
    const body = at + 8;
    tiles.push({
      x: view.getInt32(at, true), y: view.getInt32(at + 4, true),
      label: new Int32Array(buffer, body, COLUMNS), seen: new Int32Array(buffer, body + 4 * COLUMNS, COLUMNS),
      robot: new Int16Array(buffer, body + 8 * COLUMNS, COLUMNS), height: new Int16Array(buffer, body + 10 * COLUMNS, COLUMNS),
      certainty: new Uint8Array(buffer, body + 12 * COLUMNS, COLUMNS),
    });
  }
  return {
    cellSize: view.getFloat64(8, true), base: view.getFloat64(16, true), sequence: Number(view.getBigUint64(24, true)),
    since: Number(view.getBigUint64(32, true)), life: view.getBigUint64(40, true).toString(), tiles,
  };
}
