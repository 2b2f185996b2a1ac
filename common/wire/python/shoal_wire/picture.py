# SPDX-License-Identifier: BSD-3-Clause
"""A map as a picture, without a library for pictures."""
import colorsys
import struct
import zlib

from .digests import mix
from .errors import BadFile


def color_of(label):
    """(r, g, b) of a label or topic, the same in every picture."""
    value = mix(label + 17)
    hue, saturation, brightness = value % 180, 110 + (value >> 16) % 130, 130 + (value >> 32) % 115
    return tuple(round(255 * c) for c in colorsys.hsv_to_rgb(hue / 180, saturation / 255, brightness / 255))


def png(labels):
    """A picture, as the bytes of a PNG, of {(x, y, z): label}: seen from above, north up, the highest cell on top."""
    if not labels:
        raise BadFile("nothing has been mapped yet: there is nothing to draw")
    top = {}
    for x, y, z in sorted(labels, key=lambda cell: cell[2]):
        top[x, y] = labels[x, y, z]
    x0, x1 = min(x for x, _ in top), max(x for x, _ in top)
    y0, y1 = min(y for _, y in top), max(y for _, y in top)
    width, height = x1 - x0 + 1, y1 - y0 + 1
    if width * height > 1 << 26:
        raise BadFile(f"the map spans {width} x {height} cells: too much for a picture")
    scale = max(1, 720 // max(width, height))
    colors, rows = {label: bytes(color_of(label)) for label in set(top.values())}, []
    for y in range(y1, y0 - 1, -1):
        line = b"".join((colors[top[x, y]] if (x, y) in top else b"\xe1\xe1\xe1") * scale for x in range(x0, x1 + 1))
        rows.append((b"\0" + line) * scale)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width * scale, height * scale, 8, 2, 0, 0, 0)
    body = zlib.compress(b"".join(rows), 6)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")
