#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Another decoder of pieces, written from docs/wire.md alone: reads golden messages and compares."""
import struct
import sys


class Bits:
    def __init__(self, data):
        self.data, self.at, self.range = data, 0, 2**32 - 1
        self.code = 0
        for _ in range(4):
            self.code = self.code << 8 | self.next()

    def next(self):
        self.at += 1
        return self.data[self.at - 1] if self.at <= len(self.data) else 0

    def normalize(self):
        while self.range < 2**24:
            self.range <<= 8
            self.code = (self.code << 8 | self.next()) & 0xFFFFFFFF

    def bit(self, model):
        zero, seen = model
        bound = (self.range >> 16) * zero
        one = self.code >= bound
        if one:
            self.code -= bound
            self.range -= bound
        else:
            self.range = bound
        move = ((0 if one else 65536) - zero) * 2
        zero += abs(move) // (2 * seen + 3) * (1 if move > 0 else -1)
        model[:] = [min(max(zero, 32), 65504), min(seen + 1, 100)]
        self.normalize()
        return int(one)

    def direct(self, bits):
        value = 0
        for _ in range(bits):
            self.range >>= 1
            one = self.code >= self.range
            if one:
                self.code -= self.range
            value = value << 1 | int(one)
            self.normalize()
        return value

    def wide(self):
        width = self.direct(6)
        return 1 << (width - 1) | self.direct(width - 1) if width else 0


class Models(dict):
    """Models that come into being, (32768, 0) unless said otherwise, when first used."""

    def __missing__(self, key):
        self[key] = [32768, 0]
        return self[key]


def tree(bits, models, b):
    node = 1
    for _ in range(b):
        node = 2 * node + bits.bit(models[node])
    return node - (1 << b)


def small(bits, models):
    length = 0
    while length < 31 and bits.bit(models["length", length]):
        length += 1
    value = 1
    for i in range(length):
        if i == 0:
            bit = bits.bit(models["first", length])
        elif i == 1:
            bit = bits.bit(models["second", length, value & 1])
        else:
            bit = bits.direct(1)
        value = value << 1 | bit
    return value - 1


def long(bits, models):
    width = tree(bits, models, 6)
    return 1 << (width - 1) | bits.direct(width - 1) if width else 0


def topic(bits, num_words):
    created, weight = bits.wide(), bits.wide()
    sizes = [bits.wide() for _ in range(bits.direct(6) + 1)]
    ends = [sum(sizes[: i + 1]) for i in range(len(sizes))]

    def group(word):
        return min(next(i for i, end in enumerate(ends) if word < end), 3)

    gaps = [Models() for _ in range(4)]
    counts = [[Models() for _ in range(4)] for _ in range(4)]
    words, follows, last = [], 0, 0
    for _ in range(num_words):
        word = follows + small(bits, gaps[group(follows)])
        count = small(bits, counts[group(word)][last])
        words.append((word, count + 1))
        follows, last = word + 1, min(count.bit_length(), 3)
    return created, weight, sizes, words


def cells(bits):
    x0, x1, y0, y1, z0, z1 = (bits.direct(4) for _ in range(6))
    models = {}
    for context in range(64):
        alike = bin(context & 7).count("1")
        models[context] = {3: [2000, 6], 2: [16000, 2], 1: [32768, 0], 0: [49000, 2]}[alike]
        if alike == 0 and context & 32:
            models[context] = [63500, 6]
    there = set()
    for x in range(x0, x1 + 1):
        for y in range(y0, y1 + 1):
            for z in range(z0, z1 + 1):
                west, south = (x - 1, y, z) in there, (x, y - 1, z) in there
                west_up, south_up = (x - 1, y, z + 1) in there, (x, y - 1, z + 1) in there
                w = west if x > x0 else south
                if x == x0 and y == y0:
                    w = z0 == z1
                s = south if y > y0 else w
                sw = (x - 1, y - 1, z) in there if x > x0 and y > y0 else s
                w_up = west_up if x > x0 else south_up
                s_up = south_up if y > y0 else w_up
                below = any((x, y, k) in there for k in range(z))
                context = w + 2 * s + 4 * sw + 8 * w_up + 16 * s_up + 32 * below
                if bits.bit(models[context]):
                    there.add((x, y, z))
    return sorted(there)


def neighbours(there):
    result = []
    for x, y, z in there:
        found = [there.index((x, y, z - 1))] if (x, y, z - 1) in there else []
        for column in ((x, y - 1), (x - 1, y), (x - 1, y - 1), (x - 1, y + 1)):
            heights = [c[2] for c in there if c[:2] == column]
            if heights:
                found.append(there.index(column + (min(heights, key=lambda h: (abs(h - z), h)),)))
        result.append((found + found[:1] * 4)[:4])
    return result


def palette(bits):
    models, values = Models(), []
    for _ in range(bits.wide()):
        values.append(long(bits, models) + (values[-1] + 1 if values else 0))
    return values


def indices(bits, near_cells, size, order):
    if size == 1:
        return [0] * len(near_cells)
    hits, names, distance, above = {}, Models(), Models(), [32768, 0]
    result = []
    for near_cell in near_cells:
        near = [result[n] for n in near_cell]
        value = None
        if near:
            pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
            pattern = sum((near[a] == near[b]) << i for i, (a, b) in enumerate(pairs))
            for k in range(4):
                if near[k] in near[:k]:
                    continue
                first = [2000, 6] if pattern == 63 else [16000, 2]
                if bits.bit(hits.setdefault((pattern, k), first if k == 0 else [32768, 0])):
                    value = near[k]
                    break
        if value is None and near and order:
            up = bits.bit(above)
            step = small(bits, distance) + 1
            value = near[0] + step if up else near[0] - step
        elif value is None:
            value = tree(bits, names, (size - 1).bit_length())
        result.append(value)
    return result


def levels(bits, near_cells):
    models, result = [Models() for _ in range(5)], []
    for near_cell in near_cells:
        near = [result[n] for n in near_cell]
        expected, context = 32, 4
        if near:
            expected = (2 * near[0] + 2 * near[1] + near[2] + near[3] + 3) // 6
            spread = abs(near[0] - near[1]) + abs(near[1] - near[2])
            context = 0 if spread == 0 else 1 if spread < 4 else 2 if spread < 12 else 3
        coded = small(bits, models[context])
        result.append(expected + (coded // 2 if coded % 2 == 0 else -(coded + 1) // 2))
    return result


def read(path, fields):
    """The type's own fields by their struct codes, and the payload."""
    with open(path, "rb") as file:
        data = file.read()
    front = struct.unpack_from(">qqiB", data)
    own = struct.unpack_from(">" + fields, data, 21)
    fixed = 21 + struct.calcsize(">" + fields) + 6
    (n,) = struct.unpack_from(">i", data, fixed - 4)
    assert n == len(data) - fixed and front[3] == 1, path
    return own, data[fixed:]


def expect(what, got, wanted):
    if got != wanted:
        sys.exit(f"{what}: got {got}, wanted {wanted}")


def main(folder):
    own, payload = read(folder + "/topics.bin", "BBhiihi")
    expect("topics_t", own, (1, 3, 3, 1, 60, 12, 6))
    words = [(0, 3), (17, 41), (18, 1), (199, 7), (200, 100), (263, 2)]
    expect("topic", topic(Bits(payload), own[-1]), (3000000, 812, [200, 64], words))

    own, payload = read(folder + "/brick.bin", "BBhiiiiih")
    expect("brick_t", own, (0, 1, 3, 1, 54, -2, 1, 0, 11))
    bits = Bits(payload)
    there = cells(bits)
    wanted = [(x, y, x // 3) for x in range(4) for y in range(3) if (x, y) != (2, 1)]
    expect("cells", there, wanted)
    near = neighbours(there)
    topics = palette(bits)
    topics = [topics[i] for i in indices(bits, near, len(topics), False)]
    expect("topics of cells", topics, [0 if x < 2 else 12 for x, _, _ in wanted])
    period = bits.wide()
    times = [t * period for t in palette(bits)]
    times = [times[i] for i in indices(bits, near, len(times), True)]
    expect("times", times, [(50 + 2 * y) * 1000000 for _, y, _ in wanted])

    own, payload = read(folder + "/certainty.bin", "BBhiiiiih")
    bits = Bits(payload)
    there = cells(bits)
    expect("cells", there, [(0, y, 0) for y in range(9)])
    expect("levels", levels(bits, neighbours(there)), [7 * y for y in range(9)])

    own, payload = read(folder + "/map_1.bin", "qiiiiih")
    expect("map_t", own, (77, 1, 2, 0, 0, 0, 6))
    bits = Bits(payload)
    there = cells(bits)
    wanted = [(x, y, 0) for x in range(2) for y in range(3)]
    expect("cells", there, wanted)
    near = neighbours(there)
    for what, values in (("labels", [110003] * 6), ("robots", [y % 2 for _, y, _ in wanted])):
        known = palette(bits)
        expect(what, [known[i] for i in indices(bits, near, len(known), False)], values)
    period = bits.wide()
    times = [t * period for t in palette(bits)]
    times = [times[i] for i in indices(bits, near, len(times), True)]
    expect("times", times, [(10 + y) * 500000 for _, y, _ in wanted])
    expect("levels", levels(bits, near), [21 * (x + 1) for x, _, _ in wanted])
    print("four messages read")


if __name__ == "__main__":
    main(sys.argv[1])
