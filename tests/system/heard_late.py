# SPDX-License-Identifier: BSD-3-Clause
"""heard_late.py RECORDING OUT: the same recording by somebody who heard a message of R00's late, so that for seconds nobody can know
for sure what a node held that had it in time."""
import struct
import sys

HEAD = struct.Struct(">IqqII")  # LCM's: sync word, number, microseconds, lengths of channel and message

events = []
with open(sys.argv[1], "rb") as log:
    while head := log.read(HEAD.size):
        sync, number, at, channel_size, message_size = HEAD.unpack(head)
        assert sync == 0xEDA1DA01, "an event begins here"
        events.append([at, log.read(channel_size), log.read(message_size)])
bricks = [i for i, event in enumerate(events) if event[1] == b"SHOAL_R00_BRICK"]
assert len(bricks) >= 8, f"R00 said {len(bricks)} messages of bricks"
soon, late = bricks[2], bricks[7]  # in flight
events.insert(late, [events[late][0], *events.pop(soon)[1:]])
with open(sys.argv[2], "wb") as log:
    for number, (at, channel, message) in enumerate(events):
        log.write(HEAD.pack(0xEDA1DA01, number, at, len(channel), len(message)) + channel + message)
