# SPDX-License-Identifier: BSD-3-Clause
"""Which cells a message speaks of, and what each has around it that came before."""
from .bit_mixer import Contexts, Mixer
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


class Geometry:
    def __init__(self):
        self.lowest, self.highest = Models(), Models()
        self.alike = {c: [(2000, 26000, 50000, 63500)[bin(c & 7).count("1")], 3] for c in range(64)}
        self.heights, self.diagonals, self.mixer = Contexts(), Contexts(), Mixer(3)

    def read(self, bits, brick, field):
        """Adds the cells of a brick to `field`."""
        lowest, highest = bits.tree(self.lowest, 4), bits.tree(self.highest, 4)
        x0, y0, z0 = (16 * index for index in brick)

        def step(x, y, z):
            found = field.nearest(x, y, z)
            return 0 if found is None else min(max(found[0] - z, -3), 3) + 4

        for x in range(x0, x0 + 16):
            for y in range(y0, y0 + 16):
                began = 0
                alone = int(step(x, y - 1, z0 + lowest) == 0 and step(x - 1, y, z0 + lowest) == 0)
                for z in range(z0 + lowest, z0 + highest + 1):
                    west, south = step(x - 1, y, z), step(x, y - 1, z)
                    southwest, northwest = step(x - 1, y - 1, z), step(x - 1, y + 1, z)
                    same = ((west == 4) | (south == 4) << 1 | (southwest == 4) << 2 | (west > 4) << 3 |
                            (south > 4) << 4 | began << 5)
                    contexts = (self.alike[same], self.heights[west, south, began],
                                self.diagonals[southwest, northwest, west, began])
                    if self.mixer.bit(bits, contexts, alone):
                        field.add(x, y, z)
                        began = 1
