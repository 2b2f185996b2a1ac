# SPDX-License-Identifier: BSD-3-Clause
"""Probabilities of several contexts, mixed into one. Integers only, as everywhere in the format."""
from operator import mul

_MOST = 2047
_SQUASH = (22, 36, 60, 98, 162, 267, 439, 720, 1179, 1921, 3108, 4971, 7812, 11955, 17625, 24743, 32768, 40793, 47911,
           53581, 57724, 60565, 62428, 63615, 64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514)
_BELIEF = (0, 110, 160, 190, 210, 225, 236, 245)


def squash(odds):
    odds = (-_MOST if odds < -_MOST else _MOST if odds > _MOST else odds) + 2048
    i, rest = odds >> 7, odds & 127
    return (_SQUASH[i] * (128 - rest) + _SQUASH[i + 1] * rest + 64) >> 7


def _make_stretch():
    table, odds = [], -_MOST
    for p in range(4096):
        while odds < _MOST and squash(odds) < 16 * p + 8:
            odds += 1
        table.append(odds)
    return table


_STRETCH = _make_stretch()


# What a context says, by how sure it is and by its probability; // rounds down, the format towards zero.
_ODDS = [[odds * belief // 256 if odds >= 0 else -(-odds * belief // 256) for odds in _STRETCH] for belief in _BELIEF + (256,)]
_SURE = len(_BELIEF)


class Contexts(dict):
    """[P(1) x 65536, bits seen] per context; begin as (32768, 0) when first used."""

    def __missing__(self, key):
        self[key] = context = [32768, 0]
        return context


class Mixer:
    def __init__(self, count):
        self.count, self.sets = count, {}

    def bit(self, bits, contexts, which):
        """One bit; nearly all of a reader's time is spent here, so calls are few. int() rounds towards zero, and what it is
        given is exact: quotients of numbers below 2 ** 53 that are no integers do not round to one."""
        weights = self.sets.get(which)
        if weights is None:
            weights = self.sets[which] = [14336] * self.count
        odds = [_ODDS[seen if seen < _SURE else _SURE][one >> 4] for one, seen in contexts]
        one = squash(int(sum(map(mul, weights, odds)) / 65536))
        bit = bits.plain(65536 - (32 if one < 32 else 65504 if one > 65504 else one))
        error = (65536 if bit else 0) - one
        target = 65535 if bit else 0
        self.sets[which] = [weight + int(odd * error / 32768) for weight, odd in zip(weights, odds)]
        for context in contexts:
            one, seen = context
            context[0] = one + int((target - one) * 2 / (2 * seen + 3))
            if seen < 250:
                context[1] = seen + 1
        return bit
