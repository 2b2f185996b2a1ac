# SPDX-License-Identifier: BSD-3-Clause
"""LCM logs, damaged ones too."""
import mmap
import os
import struct

from .errors import BadFile


class Log:
    """The events of an LCM log, in the order of the file: iterate for (time_us, channel, data).

    time_us is wall time at which the logger received it. After damage it goes on at the next event; `damaged` and
    `damaged_bytes` count what was passed over, as `operator_console` does.
    """

    SYNC = b"\xed\xa1\xda\x01"

    def __init__(self, path):
        self.path, self.damaged, self.damaged_bytes = path, 0, 0
        try:
            with open(path, "rb") as file:
                empty = os.fstat(file.fileno()).st_size == 0
                self.data = b"" if empty else mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        except (OSError, ValueError) as error:
            raise BadFile(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from None

    def _header(self, at):
        """(time_us, length of the channel, length of the data) of the event at `at`; None when none is there."""
        header = self.data[at:at + 28]
        if len(header) < 28 or header[:4] != self.SYNC:
            return None
        time_us, channel, size = struct.unpack_from(">qII", header, 12)
        sane = 1 <= channel <= 63 and size < 2**31 and at + 28 + channel + size <= len(self.data)
        return (time_us, channel, size) if sane else None

    def _find(self, start, end):
        """Where the first event in [start, end) begins, else `end`."""
        while True:
            start = self.data.find(self.SYNC, start, end + 3)
            if start < 0 or start >= end:
                return end
            if self._header(start):
                return start
            start += 1

    def __iter__(self):
        at, size = 0, len(self.data)
        self.damaged = self.damaged_bytes = 0
        while at < size:
            header = self._header(at)
            end = at + 28 + header[1] + header[2] if header else size
            # Believed when a next event or the end follows; or when rubbish does, but no event begins inside.
            if not header or not (end == size or self._header(end) or self._find(at + 1, end) == end):
                found = self._find(at + 1, end)
                self.damaged += 1
                self.damaged_bytes += found - at
                at = found
                continue
            channel = at + 28
            data = channel + header[1]
            yield header[0], self.data[channel:data].decode("latin-1"), self.data[data:end]
            at = end
