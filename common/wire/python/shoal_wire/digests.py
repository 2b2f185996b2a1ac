# SPDX-License-Identifier: BSD-3-Clause
"""The hashes by which nodes know that they hold the same."""
import struct

from .layout import MASK, OPERATORS, STEPS


_HALF = 2**32 - 1


def mix(x):
    x = (x + 0x9E3779B97F4A7C15) & MASK
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 & MASK
    x = (x ^ x >> 27) * 0x94D049BB133111EB & MASK
    return x ^ x >> 31


def hash_of(values, start=0):
    """The hash that all digests are made of: folds integers, in order, into 64 bits."""
    for value in values:
        start = mix(start ^ mix(value & MASK))
    return start


def _signed(bits):
    return bits - 2**32 if bits >> 31 else bits


def edit_hash(m):
    """The hash of what an edit says: a decoded message of kind EDIT."""
    def text(said):
        return [len(said.encode()), *said.encode()]

    values = text(m["author"]) + [m["counter"], m["made_us"]]
    if m["operation"] == "name":
        values += [0, *m["topics"][0], *text(m["name"])]
    elif m["operation"] in ("link", "unlink"):
        values += [1, *m["topics"][0], *m["topics"][1], int(m["operation"] == "unlink")]
    elif m["operation"] == "exclude":
        values += [2, m["robot"]]
    else:
        values += [3, *text(m["undone"][0]), m["undone"][1]]
    return hash_of(values)


def content_hash(m):
    """The hash of a piece: a decoded message of kind TOPICS, BRICK, CERTAINTY, PICTURE, SETTINGS or EDIT."""
    if m["kind"] == "EDIT":
        own = edit_hash(m)
        return hash_of([OPERATORS, 4, m["counter"], _signed(own >> 32), _signed(own & 0xFFFFFFFF), 0, 0, 0, 1, own])
    if m["kind"] == "SETTINGS":
        edge = struct.unpack(">q", struct.pack(">d", m["cell_size_m"]))[0]
        return hash_of([m["robot"], 6, 0, 0, 0, m["epoch"], 0, 0, 1, m["words"], m["hyperparameters"], edge])
    number = {"TOPICS": 1, "BRICK": 2, "CERTAINTY": 3, "PICTURE": 5}[m["kind"]]
    index = (m["topic"], m.get("example", 0), 0) if number in (1, 5) else (m["brick_x"], m["brick_y"], m["brick_z"])
    values = [m["robot"], number, *index, m["epoch"], m["observation"], m["part"], m["num_parts"]]
    if number == 1:
        values += [m["created_us"], m["weight"], len(m["group_sizes"]), *m["group_sizes"]]
        for entry in m["words"]:
            values += entry
    elif number == 5:
        values += [*m["cell"], m["seen_us"], len(m["layer"]), *m["layer"]]
    else:
        for cell, *rest in m["cells" if number == 2 else "certainties"]:
            values += [*cell, *rest]
    return hash_of(values)


def map_digest(cells, correspondences):
    """The digest of a fused map: cells {(x, y, z): (label, robot, seen_us, steps)}, [(robot, topic, label)]."""
    bits = [struct.unpack(">i", struct.pack(">f", steps / STEPS))[0] for steps in range(STEPS + 1)]
    digest = 0
    for (x, y, z), (label, robot, seen_us, steps) in cells.items():
        own = hash_of(((x & _HALF) << 32 | y & _HALF, (z & _HALF) << 32 | robot & _HALF, seen_us, bits[steps]))
        digest = digest + own * (mix(label) | 1) & MASK
    for entry in correspondences:
        digest = hash_of(entry, digest)
    return digest
