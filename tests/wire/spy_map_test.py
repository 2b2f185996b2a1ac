#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What lcm-spy's window draws, cell by cell and word by word, against shoal_reader.py; then damaged messages.

Usage: spy_map_test.py SOURCE_DIR JARS OUT WRITE_RECORDING [LOG...]   JARS: a Java class path. Pictures are left in OUT.
"""
import glob
import os
import struct
import subprocess
import sys
import tempfile

SOURCE, JARS, OUT, WRITE_RECORDING = sys.argv[1:5]
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(SOURCE, "common", "wire", "python"))
import shoal_reader  # noqa: E402

GOLDEN = [os.path.join(SOURCE, "tests", "data", "wire", name + ".bin")
          for name in ("topics", "topics_shared", "bricks", "certainties", "repair_brick", "repair_topic")]


def read(path):
    with open(path, "rb") as file:
        return file.read()


def golden_log(path):
    """A recording of the golden messages, each by the robot it is of."""
    with open(path, "wb") as log:
        names = ["heartbeat"] + [os.path.basename(g)[:-4] for g in GOLDEN]
        for i, name in enumerate(names):
            data = read(os.path.join(SOURCE, "tests", "data", "wire", name + ".bin"))
            m = shoal_reader.decode(data)
            kind = "REPAIR" if name.startswith("repair") else m["kind"]
            channel = f"SHOAL_{shoal_reader.robot_name(m.get('robot', 3))}_{kind}".encode()
            log.write(struct.pack(">IqqII", 0xEDA1DA01, i, i, len(channel), len(data)) + channel + data)


HOSTILE = os.path.join(SOURCE, "tests", "data", "wire", "hostile", "places.bin")  # refused by both


def close(a, b):
    """Java's HSB and Python's HSV may round a channel to either side."""
    return all(abs(int(a[i:i + 2], 16) - b[i // 2]) <= 1 for i in (0, 2, 4))


def golden_words():
    """The golden topics as SpyMapTest prints them."""
    lines = []
    for path in GOLDEN:
        m = shoal_reader.decode(read(path))
        for t in m.get("topics", []):
            words = ", ".join(f"{word}={count}" for word, count in t["words"])
            lines.append(f"golden {m['robot']} {m['epoch']} {t['observation']} {t['part']} {t['num_parts']} "
                         f"[{t['topic']}] {t['weight']} {t['group_sizes']} {{{words}}}")
    return lines


def compare(log, classes, damaged=()):
    out = subprocess.run(["java", "-Djava.awt.headless=true", "-cp", JARS + ":" + classes, "SpyMapTest", log, OUT, *damaged],
                   check=True, timeout=100, stdout=subprocess.PIPE, text=True).stdout
    print(out.splitlines()[-1])
    if damaged:
        said = [line for line in out.splitlines() if line.startswith("golden")]
        assert said == golden_words() and said, (said, golden_words())
    mission = shoal_reader.read_log(log)
    cells, topics = {}, {}
    for line in open(os.path.join(OUT, "spy_map.txt")):
        robot, what, rest = line.rstrip("\n").split(" ", 2)
        name = shoal_reader.robot_name(int(robot))
        if what == "cell":
            at, said, color = rest[:-8].split("]")[0][1:], rest[:-8].split("[")[2].rstrip("] "), rest[-6:]
            value = tuple(int(v) for v in said.split(","))
            assert close(color, shoal_reader.color_of(value[0])), (color, value)
            cells[name, tuple(int(v) for v in at.split(","))] = value
        else:
            topic, weight, more = rest.split(" ", 2)
            sizes, words = more[1:-1].split("] {")
            topics[name, int(topic)] = (int(weight), [int(s) for s in sizes.split(",")],
                                        {int(w.split("=")[0]): int(w.split("=")[1]) for w in words.split(",") if w})
    expected = {(robot, cell): value for robot in mission.robots() for cell, value in mission.cells(robot).items()}
    assert expected and cells == expected, f"{len(cells)} cells, expected {len(expected)}"
    expected = {(robot, topic): (t["weight"], t["group_sizes"], t["words"])
                for robot in mission.robots() for topic, t in mission.topics(robot).items()}
    assert topics == expected, f"{len(topics)} topics, expected {len(expected)}"
    print(f"{os.path.basename(log)}: {len(cells)} cells and {len(topics)} topics as shoal_reader.py has them")


def main():
    with tempfile.TemporaryDirectory() as work:
        subprocess.run(["javac", "-nowarn", "-cp", JARS, "-d", work,
                        os.path.join(SOURCE, "tests", "wire", "SpyMapTest.java")], check=True)
        golden_log(os.path.join(work, "golden.lcmlog"))
        compare(os.path.join(work, "golden.lcmlog"), work, GOLDEN)
        refused = subprocess.run(["java", "-cp", JARS + ":" + work, "SpyMapTest", "--refused", HOSTILE],
                                 timeout=60, stdout=subprocess.PIPE, text=True).stdout
        assert refused == "refused: places for cells\n", refused
        subprocess.run([WRITE_RECORDING, work], check=True, timeout=60)
        for log in [os.path.join(work, "mission.lcmlog"), *sys.argv[5:]]:
            compare(log, work)


main()
