# SPDX-License-Identifier: BSD-3-Clause
"""The range coder of all payloads but heartbeats', and the numbers made of its bits."""
from .errors import require


class Bits:
    """Decodes one payload. Raises BadMessage when it is asked for more than any encoder's stream holds."""

    def __init__(self, data):
        self.data, self.at, self.range = data, 4, 2**32 - 1
        self.code = int.from_bytes((data[:4] + b"\0\0\0\0")[:4], "big")

    def normalize(self):
        while self.range < 1 << 24:
            self.range <<= 8
            byte = self.data[self.at] if self.at < len(self.data) else 0
            self.at += 1
            self.code = self.code << 8 | byte
        require(self.at - len(self.data) <= 4, "the payload ends early", "bad payload")

    def plain(self, zero):
        """One bit that is 0 with probability zero / 65536."""
        bound = (self.range >> 16) * zero
        if self.code < bound:
            self.range = bound
            one = 0
        else:
            self.code -= bound
            self.range -= bound
            one = 1
        if self.range < 1 << 24:
            self.normalize()
        return one

    def bit(self, model):
        """One bit; `model` is [zero, seen] and learns."""
        zero, seen = model
        one = self.plain(zero)
        if one:
            zero -= zero * 2 // (2 * seen + 3)
        else:
            zero += (65536 - zero) * 2 // (2 * seen + 3)
        model[0] = 32 if zero < 32 else 65504 if zero > 65504 else zero
        if seen < 100:
            model[1] = seen + 1
        return one

    def direct(self, bits):
        value = 0
        for _ in range(bits):
            self.range >>= 1
            one = self.code >= self.range
            if one:
                self.code -= self.range
            value = value << 1 | one
            self.normalize()
        return value

    def wide(self):
        width = self.direct(6)
        return 1 << (width - 1) | self.direct(width - 1) if width else 0

    def tree(self, models, bits):
        node = 1
        for _ in range(bits):
            node = 2 * node + self.bit(models[node])
        return node - (1 << bits)

    def small(self, models):
        length = 0
        while length < 31 and self.bit(models[length]):
            length += 1
        value = 1
        for i in range(length):
            if i == 0:
                bit = self.bit(models["first", length])
            elif i == 1:
                bit = self.bit(models["second", length, value & 1])
            else:
                bit = self.direct(1)
            value = value << 1 | bit
        return value - 1

    def long(self, models):
        width = self.tree(models, 6)
        return 1 << (width - 1) | self.direct(width - 1) if width else 0

    def end(self):
        require(self.at >= len(self.data), "bytes after the end of the payload", "not canonical")


class Models(dict):
    """Models that begin as (32768, 0) when first used."""

    def __missing__(self, key):
        self[key] = model = [32768, 0]
        return model
