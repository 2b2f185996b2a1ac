# SPDX-License-Identifier: BSD-3-Clause
"""Probabilities of several contexts, mixed into one. Integers only, as everywhere in the format."""

_MOST = 2047
_SQUASH = (22, 36, 60, 98, 162, 267, 439, 720, 1179, 1921, 3108, 4971, 7812, 11955, 17625, 24743, 32768, 40793, 47911,
           53581, 57724, 60565, 62428, 63615, 64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514)
_BELIEF = (0, 110, 160, 190, 210, 225, 236, 245)


def _clamp(value, low, high):
    return low if value < low else high if value > high else value


def squash(odds):
    odds = _clamp(odds, -_MOST, _MOST) + 2048
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


def _towards_zero(value, divisor):
    return value // divisor if value >= 0 else -(-value // divisor)


class Contexts(dict):
    """[P(1) x 65536, bits seen] per context; begin as (32768, 0) when first used."""

    def __missing__(self, key):
        self[key] = context = [32768, 0]
        return context


class Mixer:
    def __init__(self, count):
        self.count, self.sets = count, {}

    def bit(self, bits, contexts, which):
        weights = self.sets.setdefault(which, [14336] * self.count)
        odds, total = [], 0
        for weight, (one, seen) in zip(weights, contexts):
            belief = _BELIEF[seen] if seen < len(_BELIEF) else 256
            odds.append(_towards_zero(_STRETCH[one >> 4] * belief, 256))
            total += weight * odds[-1]
        one = squash(_clamp(_towards_zero(total, 65536), -_MOST, _MOST))
        bit = bits.plain(65536 - _clamp(one, 32, 65504))
        error = (65536 if bit else 0) - one
        for k, context in enumerate(contexts):
            weights[k] += _towards_zero(odds[k] * error, 1 << 15)
            context[0] += _towards_zero(((65535 if bit else 0) - context[0]) * 2, 2 * context[1] + 3)
            if context[1] < 250:
                context[1] += 1
        return bit
