#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Packs what shoal_harvest_topics wrote into tests/data/harvest/topics.bin, which harvest.h reads.

  build/bin/shoal_harvest_topics --world reef:sparse reef:varied reef:tuning --robots 3 6 12 --parts 25 50 100 \
      --observations 40 --out FILE
  tests/eval/pack_harvest.py FILE tests/data/harvest/topics.bin

A zlib stream of LEB128 numbers: what the missions are, then the gaps between all words, then all weights.
"""
import json
import sys
import zlib

MISSIONS = {('reef:sparse', 3, 25), ('reef:sparse', 3, 100), ('reef:sparse', 6, 50), ('reef:sparse', 12, 25),
            ('reef:sparse', 12, 100), ('reef:varied', 3, 25), ('reef:varied', 3, 100), ('reef:varied', 6, 50),
            ('reef:varied', 12, 25), ('reef:varied', 12, 100), ('reef:tuning', 6, 100), ('reef:tuning', 12, 50)}


def put(out, *numbers):
    for n in numbers:
        while n >= 128:
            out.append(n & 127 | 128)
            n >>= 7
        out.append(n)


def put_list(out, numbers):
    put(out, len(numbers), *numbers)


def main(source, target):
    missions = [m for m in map(json.loads, open(source)) if (m['world'], m['robots'], m['part']) in MISSIONS]
    if len(missions) != len(MISSIONS):
        sys.exit(f'{source}: {len(missions)} of the missions wanted, {len(MISSIONS)} would be right')
    head, gaps, weights = bytearray(), bytearray(), bytearray()
    put(head, len(missions))
    for m in missions:
        put_list(head, m['world'].encode())
        put(head, m['robots'], m['part'], m['vocabulary'])
        put_list(head, m['group_first'])
        put(head, len(m['topics']))
        for t in m['topics']:
            put(head, t['robot'], t['topic'], t['cells'])
            put_list(head, t['classes'])
            put(head, len(t['words']))
            before = -1
            for word, weight in t['words']:
                put(gaps, word - before - 1)
                put(weights, weight)
                before = word
    with open(target, 'wb') as file:
        file.write(zlib.compress(bytes(head + gaps + weights), 9))


if __name__ == '__main__':
    main(*sys.argv[1:])
