#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Reads what Shoal says on LCM: recordings, datagrams, messages. Python 3.8 or newer and nothing else.

    python3 shoal_reader.py mission.lcmlog --png map.png --csv map.csv --json

As a module:

    import shoal_reader
    mission = shoal_reader.read_log("mission.lcmlog")
    mission.robots()                     # ["R00", "R01", ...]
    mission.cells("R00")                 # {(x, y, z): (topic, seen_us, certainty steps of 1/63)}
    mission.surprises("R00")             # {(x, y, z): how unusual the cell was when it was seen}
    mission.topics("R00")                # {id: {"created_us", "weight", "group_sizes", "words": {word: count}}}
    mission.map()                        # the fused map: {"cells": {(x, y, z): (label, robot, seen_us, steps)}, ...}
    shoal_reader.decode(message)         # one message as a dict, or BadMessage

The format is that of docs/wire.md; names here are those of the document and of lcmtypes/*.lcm. A cell is centred at
its index times mission.cell_size_m metres. Times are microseconds of mission time.

What this reader leaves out: it does not encode again what it decoded, so it accepts payloads that are valid but not
canonical; payloads of pieces that a newer version replaced are not looked into, unless with --messages.
"""
import argparse
import collections
import json
import os
import struct
import sys

from shoal_wire.errors import BadFile, BadMessage
from shoal_wire.layout import KINDS
from shoal_wire.log import Log
from shoal_wire.message import decode, parse_channel, parse_datagram, peek, robot_name
from shoal_wire.mission import Mission, read_log
from shoal_wire.picture import color_of, png
from shoal_wire.seal import read_key, unsealed
from shoal_wire.tables import map_csv, robot_csv

__all__ = ["BadFile", "BadMessage", "Log", "Mission", "color_of", "decode", "map_csv", "parse_channel",
           "parse_datagram", "peek", "png", "read_key", "read_log", "robot_csv", "robot_name", "summary", "unsealed"]


def summary(mission, fused):
    """What a mission holds, for people and as JSON: nodes, robots with their topics, map, refusals."""
    robots = {}
    for robot in mission.robots():
        said = mission.heartbeats.get(robot)
        robots[robot] = {"cells": len(mission.cells(robot)), "digest": f"{mission.digest(robot):016x}",
                         "whole": bool(said) and said["own_digest"] == mission.digest(robot),
                         "topics": mission.topics(robot)}
    result = {"mission": mission.mission, "cell_size_m": mission.cell_size_m, "messages": mission.heard,
              "refused": dict(sorted(mission.refused.items())), "state_digest": f"{mission.state_digest():016x}",
              "robots": robots, "nodes": dict(sorted(mission.heartbeats.items())), "map": None}
    if fused:
        counted = collections.Counter(label for label, *_ in fused["cells"].values())
        named = {row["label"]: row["name"] for row in fused["labels"]}
        result["map"] = {"node": fused["node"], "source": fused["source"], "digest": f"{fused['digest']:016x}",
                         "cells": len(fused["cells"]), "correspondences": fused["correspondences"],
                         "labels": [{"label": label, "name": named.get(label, ""), "cells": cells,
                                     "color": "#%02x%02x%02x" % color_of(label)}
                                    for label, cells in sorted(counted.items())]}
    return result


def _print_summary(s):
    print(f"mission {s['mission']}, cells of {s['cell_size_m']} m, {s['messages']} messages, state {s['state_digest']}")
    for reason, count in s["refused"].items():
        print(f"refused {count}: {reason}")
    for robot, r in s["robots"].items():
        print(f"{robot}  {r['cells']} cells, {len(r['topics'])} topics{'' if r['whole'] else ', not all it has'}")
    if s["map"] is None:
        print("no fused map was published")
        return
    fused = s["map"]
    print(f"map of {fused['node']}  {fused['cells']} cells, {len(fused['labels'])} labels (from {fused['source']})")
    for row in fused["labels"]:
        print(f"  {row['color']}  {row['label']:>8}  {row['cells']:>8} cells  {row['name']}")


def _write(path, data):
    try:
        with open(path, "wb") as file:
            file.write(data)
    except OSError as error:
        raise BadFile(f"cannot write {path}: {error.strerror}") from None


def _print_messages(path, key):
    log = Log(path)
    if log.data[:4] == b"LC02":
        channel, data = parse_datagram(log.data[:])
        print(json.dumps({"channel": channel, **decode(unsealed(channel, data, key))}))
    elif len(log.data) >= 8 and struct.unpack(">Q", log.data[:8])[0] in KINDS:
        print(json.dumps({"channel": "", **decode(log.data[:])}))
    else:
        _print_log(log, key)


def _print_log(log, key):
    count = 0
    for _, channel, data in log:
        try:
            line = {"channel": channel, **decode(unsealed(channel, data, key if parse_channel(channel) else None))}
        except BadMessage as error:
            line = {"channel": channel, "refused": error.reason, "detail": str(error)}
        print(json.dumps(line))
        count += 1
    if not count:
        raise BadFile(f"{log.path} is no LCM log, no LCM datagram and no message of Shoal's")


def _run(options):
    key = read_key(options.key) if options.key else None
    if options.messages:
        _print_messages(options.log, key)
        return
    mission = read_log(options.log, options.mission, key)
    if options.robot and options.robot not in mission.robots():
        raise BadFile(f"{options.log} holds nothing of {options.robot}; "
                      f"it holds {', '.join(mission.robots()) or 'no robot'}")
    fused = mission.map(options.node)
    if options.node and fused is None:
        raise BadFile(f"{options.log} holds no whole map of {options.node}; maps are from "
                      f"{', '.join(mission.nodes_with_maps()) or 'nobody'}")
    if (options.png or options.csv) and not options.robot and fused is None:
        raise BadFile(f"{options.log} holds no whole fused map; --robot draws a robot's own")
    if options.robot:
        own = mission.cells(options.robot)
        labels, text = {cell: c[0] for cell, c in own.items()}, robot_csv(own, mission.cell_size_m)
    elif fused:
        labels, text = {cell: c[0] for cell, c in fused["cells"].items()}, map_csv(fused["cells"], mission.cell_size_m)
    if options.png:
        _write(options.png, png(labels))
    if options.csv:
        _write(options.csv, text.encode())
    if options.json:
        print(json.dumps(summary(mission, fused), indent=1))
    elif not options.png and not options.csv:
        _print_summary(summary(mission, fused))


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="shoal_reader.py", epilog="Exit codes: 0 good, 1 failed, 2 wrong usage.",
        description="Reads a recording of a Shoal mission: robots' maps and topics, and the fused map. "
        "Without an option it says what is there.")
    parser.add_argument("log", metavar="FILE", help="an LCM log; with --messages also one LCM datagram or one message")
    parser.add_argument("--png", metavar="FILE", help="draw the map, seen from above, north up")
    parser.add_argument("--csv", metavar="FILE", help="the map's cells, as global_map.csv (with --robot as map.csv)")
    parser.add_argument("--json", action="store_true", help="what is there, with every robot's topics, as JSON")
    parser.add_argument("--messages", action="store_true",
                        help="every message decoded, a line of JSON each, and nothing else")
    parser.add_argument("--robot", metavar="R00", help="draw and write this robot's own map instead of the fused one")
    parser.add_argument("--node", metavar="NAME", help="whose fused map (default: OPERATOR's, else the first by name)")
    parser.add_argument("--mission", metavar="ID", type=int,
                        help="which mission (default: that of the first heartbeat)")
    parser.add_argument("--key", metavar="FILE", help="the team's key: leave out what it did not seal")
    options = parser.parse_args(arguments)
    if options.messages and (options.png or options.csv or options.json or options.robot or options.node):
        parser.error("--messages goes with no other output")
    try:
        _run(options)
        sys.stdout.flush()
    except (BadFile, BadMessage) as error:
        print(f"shoal_reader.py: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:  # the reader of our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


if __name__ == "__main__":
    sys.exit(main())
