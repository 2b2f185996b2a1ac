# SPDX-License-Identifier: BSD-3-Clause
"""Columns of values over the cells of a brick: the parts of three payloads."""
from .errors import require
from .layout import MAX_TIME, STEPS
from .range_coder import Models


def occupancy(bits, count):
    """The cells there, (x, y, z) in [0, 16) each, ascending."""
    x0, x1, y0, y1, z0, z1 = (bits.direct(4) for _ in range(6))
    models = []
    for context in range(64):
        alike = bin(context & 7).count("1")
        model = {3: (2000, 6), 2: (16000, 2), 1: (32768, 0), 0: (49000, 2)}[alike]
        models.append(list((63500, 6) if alike == 0 and context & 32 else model))
    columns, cells = {}, []  # (x, y) -> a bit per z
    for x in range(x0, x1 + 1):
        for y in range(y0, y1 + 1):
            west, south, southwest = (columns.get(c, 0) for c in ((x - 1, y), (x, y - 1), (x - 1, y - 1)))
            own = 0
            for z in range(z0, z1 + 1):
                if x > x0:
                    w, w_up = west >> z & 1, west >> z + 1 & 1
                else:
                    w, w_up = south >> z & 1, south >> z + 1 & 1
                    if y == y0 and z0 == z1:
                        w = 1
                s, s_up = (south >> z & 1, south >> z + 1 & 1) if y > y0 else (w, w_up)
                sw = southwest >> z & 1 if x > x0 and y > y0 else s
                if bits.bit(models[w | s << 1 | sw << 2 | w_up << 3 | s_up << 4 | (32 if own else 0)]):
                    own |= 1 << z
                    cells.append((x, y, z))
            columns[x, y] = own
    require(len(cells) == count, f"{len(cells)} cells, {count} were announced", "bad payload")
    return cells


def neighbours(cells):
    """Per cell up to four positions of cells before it, the first repeated; () where there is none."""
    columns, result = {}, []  # (x, y) -> [(z, position)]
    for position, (x, y, z) in enumerate(cells):
        own = columns.setdefault((x, y), [])
        found = [own[-1][1]] if own and own[-1][0] == z - 1 else []
        for column in ((x, y - 1), (x - 1, y), (x - 1, y - 1), (x - 1, y + 1)):
            near = columns.get(column)
            if near:
                found.append(min(near, key=lambda c: abs(c[0] - z))[1])  # the lower of two as near comes first
        own.append((z, position))
        result.append((found + found[:1] * 4)[:4])
    return result


def palette(bits, limit, max_size=4096):
    size = bits.wide()
    require(1 <= size <= max_size, "size of a palette", "bad payload")
    models, values, follows = Models(), [], 0
    for _ in range(size):
        value = follows + bits.long(models)
        require(value <= limit, "a value of a palette", "bad payload")
        values.append(value)
        follows = value + 1
    return values


def indices(bits, near_cells, size, ordered):
    if size == 1:
        return [0] * len(near_cells)
    hits, names, distance, above = {}, Models(), Models(), [32768, 0]
    width, result = (size - 1).bit_length(), []
    for near_cell in near_cells:
        near = [result[n] for n in near_cell]
        value = None
        if near:
            a, b, c, d = near
            pattern = (a == b) | (a == c) << 1 | (a == d) << 2 | (b == c) << 3 | (b == d) << 4 | (c == d) << 5
            for k in range(4):
                if near[k] in near[:k]:
                    continue
                model = hits.get((pattern, k))
                if model is None:
                    model = [32768, 0] if k else [2000, 6] if pattern == 63 else [16000, 2]
                    hits[pattern, k] = model
                if bits.bit(model):
                    value = near[k]
                    break
        if value is None and near and ordered:
            up = bits.bit(above)
            step = bits.small(distance) + 1
            value = near[0] + step if up else near[0] - step
        elif value is None:
            value = bits.tree(names, width)
        require(0 <= value < size, "an index into a palette", "bad payload")
        result.append(value)
    return result


def column(bits, near_cells, limit, ordered=False):
    values = palette(bits, limit)
    return [values[i] for i in indices(bits, near_cells, len(values), ordered)]


def times(bits, near_cells):
    period = bits.wide()
    require(1 <= period <= MAX_TIME, "period of the times", "bad payload")
    return [period * t for t in column(bits, near_cells, MAX_TIME // period, ordered=True)]


def levels(bits, near_cells):
    models, result = [Models() for _ in range(5)], []
    for near_cell in near_cells:
        expected, context = 32, 4
        if near_cell:
            a, b, c, d = (result[n] for n in near_cell)
            expected = (2 * a + 2 * b + c + d + 3) // 6
            spread = abs(a - b) + abs(b - c)
            context = 0 if spread == 0 else 1 if spread < 4 else 2 if spread < 12 else 3
        coded = bits.small(models[context])
        value = expected + (-(coded + 1) // 2 if coded & 1 else coded // 2)
        require(0 <= value <= STEPS, "a certainty", "bad payload")
        result.append(value)
    return result


def in_world(cells, message):
    x0, y0, z0 = (16 * message["brick_" + axis] for axis in "xyz")
    return [(x0 + x, y0 + y, z0 + z) for x, y, z in cells]
