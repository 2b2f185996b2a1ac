# SPDX-License-Identifier: BSD-3-Clause
"""Which cells a message speaks of, and what each has around it that came before."""
from .bit_mixer import Contexts, Mixer
from .errors import require
from .layout import MAX_PLACES
from .range_coder import Models

# Columns in whose cells a cell looks for its like, nearest first: dx, dy, weight.
COLUMNS = ((-1, 0, 16), (0, -1, 16), (-1, -1, 9), (-1, 1, 9), (1, -1, 9), (-2, 0, 5), (0, -2, 5), (-2, -1, 4),
           (-1, -2, 4), (-2, 1, 4), (-1, 2, 4), (1, -2, 4), (2, -1, 4), (-2, -2, 3), (-2, 2, 3), (2, -2, 3),
           (-3, 0, 2), (0, -3, 2))
WEIGHTS = tuple(weight for _, _, weight in COLUMNS) + (16,)  # the last: the cell below


class CellField:
    def __init__(self):
        self.cells, self.near = [], []
        self.columns = {}  # (x, y) -> [(z, place)], ascending

    def nearest(self, x, y, z):
        """(height, place) of the cell of a column nearest to z, the lower of two; None when it is empty."""
        best = None
        for cell in reversed(self.columns.get((x, y), ())):
            if best is not None and abs(cell[0] - z) > abs(best[0] - z):
                break
            best = cell
        return best

    def lies(self):
        """How each cell lies: steps to the heights west and south, how many cells of its column are above and below."""
        lies = [None] * len(self.cells)

        def step(place, z):
            return 0 if place < 0 else min(max(self.cells[place][2] - z, -2), 2) + 3

        for column in self.columns.values():
            for below, (z, place) in enumerate(column):
                west, south = self.near[place][:2]
                above = len(column) - 1 - below
                lies[place] = step(west, z), step(south, z), min(above, 2), min(below, 2)
        return lies

    def add(self, x, y, z):
        near = []
        for dx, dy, _ in COLUMNS:
            found = self.nearest(x + dx, y + dy, z)
            near.append(-1 if found is None else found[1])
        own = self.columns.setdefault((x, y), [])
        near.append(own[-1][1] if own and own[-1][0] == z - 1 else -1)
        own.append((z, len(self.cells)))
        self.cells.append((x, y, z))
        self.near.append(near)


_AROUND = ((-1, 0), (0, -1), (-1, -1), (-1, 1), (-2, 0), (0, -2))


def _heights(around, z):
    """That of each column's cells, given by ascending heights, which is nearest to z, the lower of two, or None."""
    return [None if not column else column[0] if len(column) == 1 else min(column, key=lambda h: (abs(h - z), h))
            for column in around]


def _step(seen, z):
    return 0 if seen is None else 1 if seen < z - 3 else 7 if seen > z + 3 else seen - z + 4


def _trend(seen, onward, back, z):
    if seen is None or onward is None or back is None:
        return 0
    return min(max(seen + onward - back - z, -4), 3) + 5


class Geometry:
    def __init__(self):
        self.lowest, self.highest = Models(), Models()
        self.alike = {c: [(2000, 26000, 50000, 63500)[bin(c & 7).count("1")], 3] for c in range(64)}
        self.heights, self.diagonals, self.corners = Contexts(), Contexts(), Contexts()
        self.lines, self.slopes, self.patterns = Contexts(), Contexts(), Contexts()
        self.mixer = Mixer(7)
        self.places = 0  # asked about so far

    def read(self, bits, brick, field):
        """Adds the cells of a brick to `field`."""
        lowest, highest = bits.tree(self.lowest, 4), bits.tree(self.highest, 4)
        self.places += 256 * max(highest - lowest + 1, 0)
        require(self.places <= MAX_PLACES, "places for cells", "bad payload")
        x0, y0, z0 = (16 * index for index in brick)

        for x in range(x0, x0 + 16):
            for y in range(y0, y0 + 16):
                around = [[z for z, _ in field.columns.get((x + dx, y + dy), ())] for dx, dy in _AROUND]
                began, state = 0, int((field.nearest(x, y, z0 + lowest - 1) or (None,))[0] == z0 + lowest - 1)
                alone = not around[0] and not around[1]
                for z in range(z0 + lowest, z0 + highest + 1):
                    if self.mixer.bit(bits, self._contexts(around, z, began, state), (alone, state)):
                        field.add(x, y, z)
                        began = state = 1
                    elif state == 1:
                        state = 2

    def _contexts(self, around, z, began, state):
        heights = h_west, h_south, h_southwest, h_northwest, h_west2, h_south2 = _heights(around, z)
        west, south, southwest, northwest, west2, south2 = [_step(height, z) for height in heights]
        same = ((west == 4) | (south == 4) << 1 | (southwest == 4) << 2 | (west > 4) << 3 | (south > 4) << 4 |
                began << 5)
        trends = (_trend(h_west, h_south, h_southwest, z), _trend(h_west, h_west, h_west2, z),
                  _trend(h_south, h_south, h_south2, z))
        pattern = 0  # which of the four nearest columns have a cell below, beside, above
        for column in around[:4]:
            pattern <<= 3
            for height in column:
                if -2 < height - z < 2:
                    pattern |= 1 << (height - z + 1)
        return (self.alike[same], self.heights[west, south, state], self.diagonals[southwest, northwest, west, state],
                self.corners[west, south, southwest, northwest, state],
                self.lines[west, south, west2, south2, state], self.slopes[trends, state],
                self.patterns[pattern, state])
