# SPDX-License-Identifier: BSD-3-Clause
"""Columns of values over the cells of a message: the parts of three payloads."""
from .bit_mixer import Contexts, Mixer
from .cell_field import WEIGHTS
from .errors import require
from .layout import LEAST_SURPRISE, MAX_TIME, STEPS
from .range_coder import Models


def palette(bits, limit, max_size):
    size = bits.wide()
    require(1 <= size <= max_size, "size of a palette", "bad payload")
    models, values, follows = Models(), [], 0
    for _ in range(size):
        value = follows + bits.long(models)
        require(value <= limit, "a value of a palette", "bad payload")
        values.append(value)
        follows = value + 1
    return values


def _candidates(near):
    """At most four values with their votes, best first, and the sum of all votes."""
    votes = {}
    for value, weight in zip(near, WEIGHTS):
        if value >= 0:
            votes[value] = votes.get(value, 0) + weight
    return sorted(votes.items(), key=lambda item: -item[1])[:4], sum(votes.values())


class _Questions:
    """Is it the best candidate? the next? ..."""

    def __init__(self):
        self.shares = {}
        for share in range(16):
            for known in range(4):
                for rank, (least, step) in enumerate(((12000, 3350), (6000, 3300), (6000, 3000), (6000, 3000))):
                    self.shares[rank, share, known] = [least + share * step, 2]
        self.inner, self.names, self.rings, self.surprised, self.forms, self.levels = (Contexts() for _ in range(6))
        self.mixer = Mixer(7)

    def ask(self, bits, candidates, all_votes, rank, left, near, surprises, level, lie):
        asked, votes = candidates[rank]
        share, known = min(15, votes * 16 // left), min(3, all_votes // 30)
        relation = [0 if value < 0 else 2 if value == asked else 1 for value in near]

        def of(*places):
            return tuple(relation[place] for place in places)

        nearest, second, ring = of(0, 1, 2, 3), of(4, 5, 6, 18), of(7, 8, 9, 10)
        label, stack = min(asked, 31), lie[2:]
        contexts = (self.shares[rank, share, known], self.inner[rank, nearest, second],
                    self.names[label, nearest, rank], self.rings[rank, ring, nearest],
                    self.surprised[rank, share, surprises, min(3, len(candidates))],
                    self.forms[label, lie, of(0, 1)], self.levels[label, level, stack, of(18, 0)])
        return self.mixer.bit(bits, contexts, (rank, share // 4))


def indices(bits, field, size, ordered):
    if size == 1:
        return [0] * len(field.near)
    questions, result, surprise = _Questions(), [], []
    order, seen, hits = list(range(size)), [0] * size, Models()  # of names
    after, distance, last = [32768, 0], Models(), 0  # of steps
    for places, (_, _, z), lie in zip(field.near, field.cells, field.lies()):
        near = [-1 if place < 0 else result[place] for place in places]
        candidates, all_votes = _candidates(near)
        surprises = sum(bit for place, bit in zip(places[:2], (1, 2)) if place >= 0 and surprise[place])
        value, left, rank = None, all_votes, 0
        for rank in range(len(candidates)):
            if questions.ask(bits, candidates, all_votes, rank, left, near, surprises, z % 64, lie):
                value = candidates[rank][0]
                break
            left = max(1, left - candidates[rank][1])
        surprise.append(bool(candidates) and (rank > 0 or value is None))
        if value is None and ordered:
            origin, least = (candidates[0][0], 1) if candidates else (last, 0)
            up = bits.bit(after)
            step = bits.small(distance) + least
            value = origin + step if up else origin - step
        elif value is None:
            ruled_out = {candidate for candidate, _ in candidates}
            names = [name for name in order if name not in ruled_out]
            require(names, "every name is ruled out", "bad payload")
            value = names[-1]
            for asked, name in enumerate(names[:-1]):
                if bits.bit(hits[min(asked, 23)]):
                    value = name
                    break
        require(0 <= value < size, "an index into a palette", "bad payload")
        result.append(value)
        last = value
        if not ordered:
            seen[value] += 1
            place = at = order.index(value)
            while place > 0 and seen[order[place - 1]] < seen[value]:
                place -= 1
            order.insert(place, order.pop(at))
    return result


def column(bits, field, limit, max_size, ordered=False):
    values = palette(bits, limit, max_size)
    return [values[i] for i in indices(bits, field, len(values), ordered)]


def times(bits, field, max_size):
    period = bits.wide()
    require(1 <= period <= MAX_TIME, "period of the times", "bad payload")
    return [period * t for t in column(bits, field, MAX_TIME // period, max_size, ordered=True)]


def certainties(bits, field):
    return column(bits, field, STEPS, STEPS + 1)


def surprises(bits, field):
    steps = column(bits, field, STEPS, STEPS + 1)
    require(all(s == 0 or s >= LEAST_SURPRISE for s in steps), "surprise steps are 0 or lie in [12, 63]")
    return steps
