#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""shoal_reader.py, which is written from docs/wire.md alone, against our own decoders.

Usage: reader_test.py WRITE_RECORDING SOURCE_DIR [unittest arguments]
"""
import ast
import collections
import glob
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

WRITE_RECORDING, SOURCE = sys.argv[1], os.path.abspath(sys.argv[2])
PYTHON = os.path.join(SOURCE, "common", "wire", "python")
READER = os.path.join(PYTHON, "shoal_reader.py")
sys.dont_write_bytecode = True
sys.path.insert(0, PYTHON)

import shoal_reader  # noqa: E402
from shoal_wire import layout  # noqa: E402


def read(path):
    with open(path, "rb") as file:
        return file.read()


def golden():
    return {os.path.basename(path): read(path) for path in sorted(glob.glob(SOURCE + "/tests/data/wire/*.bin"))}


TYPES = {"BRICK": "bricks", "CERTAINTY": "certainties"}  # the others are named as their channels


def run(*arguments, expect=0):
    done = subprocess.run([sys.executable, "-B", READER, *arguments], capture_output=True, text=True, timeout=60)
    if done.returncode != expect:
        raise AssertionError(f"{arguments}: exit {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done


class Types(unittest.TestCase):
    def test_fields_and_fingerprints_are_those_of_the_lcm_files_and_of_the_document(self):
        document = read(SOURCE + "/docs/wire.md").decode()
        for kind in layout.FIELDS:
            text = read(f"{SOURCE}/lcmtypes/shoal_{TYPES.get(kind, kind.lower())}_t.lcm").decode()
            text = re.sub("//.*", "", text)
            members = re.findall(r"(\w+)\s+(\w+)(?:\[(\w+)\])?;", text[text.index("struct"):])
            self.assertEqual([(name, lcm_type, size or None) for lcm_type, name, size in members], layout.members(kind))
            row = re.search(rf"\| `{kind}` \|.*", document).group()
            self.assertIn(f"`{layout.FINGERPRINTS[kind]:016x}`", row)
            self.assertIn(f"| {layout.LAYOUT[kind].size} |", row)

    def test_golden_messages_have_the_fingerprints(self):
        for name, data in golden().items():
            of_type = name.split(".")[0].split("_")[0]
            kinds = {TYPES.get(kind, kind.lower()): kind for kind in layout.FIELDS}
            self.assertEqual(shoal_reader.decode(data)["kind"], kinds[of_type])

    def test_it_needs_the_standard_library_only(self):
        own = {"shoal_wire", "shoal_reader"}
        for path in glob.glob(PYTHON + "/**/*.py", recursive=True):
            for node in ast.walk(ast.parse(read(path), path, feature_version=(3, 8))):
                names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
                if isinstance(node, ast.ImportFrom) and node.level == 0:
                    names = [node.module]
                for name in names:
                    self.assertIn(name.split(".")[0], own | set(sys.stdlib_module_names), path)


class Messages(unittest.TestCase):
    def test_every_truncation_is_refused(self):
        for name, data in golden().items():
            for size in range(len(data)):
                with self.assertRaises(shoal_reader.BadMessage, msg=f"{name} cut to {size}"):
                    shoal_reader.decode(data[:size])

    # Length and checksum put right, so that payload decoders see the damage: they return, or refuse.
    def test_any_damage_is_refused_or_decoded(self):
        refused = collections.Counter()
        for data in golden().values():
            fixed = layout.LAYOUT[shoal_reader.peek(data)[0]].size
            damaged = [data[:size] for size in range(fixed, len(data))]
            damaged += [data[:at] + bytes([data[at] ^ flip]) + data[at + 1:]
                        for at in range(20, len(data)) for flip in (1, 2, 16, 128, 255)]
            for message in damaged:
                m = bytearray(message)
                m[fixed - 6:fixed] = struct.pack(">Hi", 0, len(m) - fixed)
                m[fixed - 6:fixed - 4] = struct.pack(">H", checksum(bytes(m)))
                try:
                    shoal_reader.decode(bytes(m))
                except shoal_reader.BadMessage as error:
                    refused[error.reason] += 1
        self.assertEqual(set(refused), {"unknown format", "field out of range", "bad payload", "not canonical", "too short"})

    def test_cells_are_looked_for_in_so_many_places_only(self):
        with self.assertRaises(shoal_reader.BadMessage) as caught:
            shoal_reader.decode(read(SOURCE + "/tests/data/wire/hostile/places.bin"))
        self.assertEqual(caught.exception.reason, "bad payload")

    def test_another_format_is_refused_by_that_reason(self):
        for data in golden().values():
            with self.assertRaises(shoal_reader.BadMessage) as caught:
                shoal_reader.decode(data[:20] + b"\2" + data[21:])
            self.assertEqual(caught.exception.reason, "unknown format")

    def test_a_datagram_is_header_channel_and_message(self):
        data = golden()["topics.bin"]
        packet = b"LC02\0\0\0\7SHOAL_R03_TOPICS\0" + data
        self.assertEqual(shoal_reader.parse_datagram(packet), ("SHOAL_R03_TOPICS", data))
        self.assertEqual(shoal_reader.parse_channel("SHOAL_R03_TOPICS"), ("R03", "TOPICS"))
        for bad in (b"", packet[:8], packet[:20], b"LC03" + packet[4:], packet[:8] + 64 * b"A" + b"\0" + data):
            with self.assertRaises(shoal_reader.BadMessage):
                shoal_reader.parse_datagram(bad)


def checksum(message):
    """CRC-16/CCITT-FALSE bit by bit, as docs/wire.md defines it; the message's own is 0."""
    crc = 0xFFFF
    for byte in message:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ (0x1021 if crc & 0x8000 else 0)) & 0xFFFF
    return crc


class Recording(unittest.TestCase):
    """A log that write_recording wrote, with what our own decoders, store and fusion make of it."""

    @classmethod
    def setUpClass(cls):
        cls.top = tempfile.mkdtemp(prefix="shoal_reader_")
        subprocess.run([WRITE_RECORDING, cls.top], check=True, timeout=60)
        cls.log = os.path.join(cls.top, "mission.lcmlog")
        cls.state = json.loads(read(os.path.join(cls.top, "state.json")))
        cls.mission = shoal_reader.read_log(cls.log)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.top)

    def test_every_message_decodes_as_ours_do(self):
        ours = read(os.path.join(self.top, "messages.jsonl")).decode().splitlines()
        theirs = run("--messages", os.path.join(self.top, "everything.lcmlog")).stdout.splitlines()
        self.assertEqual(len(theirs), len(ours))
        kinds = collections.Counter()
        for our_line, their_line in zip(ours, theirs):
            expected, got = json.loads(our_line), json.loads(their_line)
            got.pop("detail", None)
            self.assertEqual(got, expected)
            kinds[got.get("kind", "refused")] += 1
        self.assertEqual(set(kinds), set(layout.FIELDS) | {"refused"})

    def test_robots_are_what_our_store_holds(self):
        self.assertEqual(self.mission.state_digest(), self.state["state_digest"])
        self.assertEqual(self.mission.robots(), sorted(self.state["robots"]))
        for robot, expected in self.state["robots"].items():
            self.assertEqual(self.mission.digest(robot), expected["digest"])
            self.assertEqual(len(self.mission.cells(robot)), expected["cells"])
            words = {str(topic): {str(word): count for word, count in t["words"].items()}
                     for topic, t in self.mission.topics(robot).items()}
            self.assertEqual(words, expected["words"])
            self.assertEqual(len(words), 4, "one of five is retired")

    def test_edits_are_in_the_order_in_which_they_count(self):
        self.assertEqual([(m["author"], m["counter"], m["operation"]) for m in self.mission.edits()],
                         [("SHORE", 1, "name"), ("SHORE", 2, "exclude"), ("OPERATOR", 1, "undo")])
        self.assertEqual(self.mission.excluded(), [])

    def test_what_is_refused_is_counted_as_ours(self):
        self.assertEqual(dict(self.mission.refused), self.state["refused"])

    def test_a_key_leaves_out_what_it_did_not_seal(self):
        log, key, other = (os.path.join(self.top, name) for name in ("sealed.lcmlog", "team.key", "other.key"))
        checked = shoal_reader.read_log(log, key=shoal_reader.read_key(key))
        self.assertEqual(checked.state_digest(), self.state["state_digest"])
        refused = dict(checked.refused)
        ours = [channel for _, channel, _ in shoal_reader.Log(self.log)]
        self.assertEqual(refused.pop("not of our key"), sum(c.startswith("SHOAL_") for c in ours[::5]))
        strangers = refused.pop("channel", 0)  # without a seal they are none of ours either
        expected = dict(self.state["refused"])
        self.assertLessEqual(strangers, expected.pop("channel", 0))
        self.assertEqual(refused, expected)
        # Unseen: the seals come off, the checksums still find what was altered.
        self.assertEqual(shoal_reader.read_log(log).state_digest(), self.state["state_digest"])
        self.assertIn("whole", run(log, "--key", key, "--json").stdout)
        self.assertIn("no heartbeat", run(log, "--key", other, expect=1).stderr)
        self.assertIn("no key file", run(log, "--key", self.log, expect=1).stderr)
        lines = [json.loads(line) for line in run("--messages", log, "--key", key).stdout.splitlines()]
        self.assertEqual(sum(line.get("refused") == "not of our key" for line in lines), checked.refused["not of our key"])

    def test_the_published_map_is_ours(self):
        fused = self.mission.map()
        self.assertEqual((fused["node"], fused["source"], fused["digest"]), ("OPERATOR", "MAP", self.state["map_digest"]))
        expected = read(os.path.join(self.top, "global_map.csv")).decode()
        self.assertEqual(shoal_reader.map_csv(fused["cells"], self.mission.cell_size_m), expected)

    def test_correspondences_alone_give_the_same_map(self):
        fused = self.mission.map("SHORE")
        self.assertEqual((fused["source"], fused["digest"]), ("MATCHES", self.state["map_digest"]))
        self.assertEqual(fused["cells"], self.mission.map()["cells"])

    def test_correspondences_of_another_state_say_so(self):
        mission = shoal_reader.Mission(self.mission.mission)
        for _, channel, data in shoal_reader.Log(self.log):
            if not channel.startswith("SHOAL_R02"):
                mission.hear(channel, data)
        self.assertEqual(mission.map("SHORE")["source"], "MATCHES of another state")
        self.assertEqual(mission.robots(), ["R00", "R01"])

    def test_the_command_line_writes_the_map(self):
        out, picture = os.path.join(self.top, "map.csv"), os.path.join(self.top, "map.png")
        done = run(self.log, "--csv", out, "--png", picture, "--json")
        self.assertEqual(read(out), read(os.path.join(self.top, "global_map.csv")))
        told = json.loads(done.stdout)
        self.assertEqual({name: r["whole"] for name, r in told["robots"].items()}, {"R00": True, "R01": False, "R02": True})
        self.assertEqual(told["map"]["cells"], len(read(out).splitlines()) - 1)
        self.assertEqual(sum(row["cells"] for row in told["map"]["labels"]), told["map"]["cells"])
        self.assertIn('Seegräser, "tall"', [row["name"] for row in told["map"]["labels"]])
        width, height, pixels = decode_png(read(picture))
        columns = {cell[:2] for cell in self.mission.map()["cells"]}
        span = [max(c[i] for c in columns) - min(c[i] for c in columns) + 1 for i in (0, 1)]
        scale = width // span[0]
        self.assertEqual((width, height), (span[0] * scale, span[1] * scale))
        empty = sum(pixel == (225, 225, 225) for row in pixels[::scale] for pixel in row[::scale])
        self.assertEqual(span[0] * span[1] - empty, len(columns))

    def test_a_message_or_a_datagram_in_a_file_is_read_too(self):
        data, path = golden()["bricks.bin"], os.path.join(self.top, "lone")
        for whole, channel in ((data, ""), (b"LC02\0\0\0\0SHOAL_R03_BRICK\0" + data, "SHOAL_R03_BRICK")):
            with open(path, "wb") as file:
                file.write(whole)
            told = json.loads(run("--messages", path).stdout)
            self.assertEqual((told["channel"], told["kind"], len(told["bricks"])), (channel, "BRICK", 2))
            with open(path, "wb") as file:
                file.write(whole[:-1])
            self.assertEqual(run("--messages", path, expect=1).stderr, "shoal_reader.py: bad length: n is 34\n")

    def test_a_robots_own_map(self):
        out = os.path.join(self.top, "own.csv")
        run(self.log, "--csv", out, "--robot", "R01")
        lines = read(out).decode().splitlines()
        self.assertEqual(lines[0], "x_m,y_m,z_m,topic,seen_s,certainty")
        self.assertEqual(len(lines) - 1, self.state["robots"]["R01"]["cells"])
        self.assertIn("R01", run(self.log).stdout)

    def test_a_damaged_log_is_read_as_far_as_it_goes(self):
        data = bytearray(read(self.log))
        for at in range(3000, len(data), 7013):
            data[at] ^= 0x55
        path = os.path.join(self.top, "broken.lcmlog")
        with open(path, "wb") as file:
            file.write(data[:len(data) - 7])
        mission = shoal_reader.read_log(path, self.mission.mission)
        self.assertGreater(mission.refused["damaged log"], 0)
        self.assertGreater(len(mission.cells("R00")), 200)

    def test_any_cut_of_a_log_gives_whole_events_or_a_clear_error(self):
        whole = read(self.log)[:1500]
        path = os.path.join(self.top, "cut.lcmlog")
        ends, at = [], 0
        while at + 28 < len(whole):
            at += 28 + sum(struct.unpack_from(">II", whole, at + 20))
            ends.append(at)
        self.assertGreater(len(ends), 2)
        for size in range(len(whole)):
            with open(path, "wb") as file:
                file.write(whole[:size])
            log = shoal_reader.Log(path)
            self.assertEqual(len(list(log)), sum(end <= size for end in ends), size)
            self.assertEqual(log.damaged, 0 if size in [0] + ends else 1, size)
            with self.assertRaises(shoal_reader.BadFile):
                shoal_reader.read_log(path)

    def test_what_is_wrong_is_said_in_one_line(self):
        rubbish = os.path.join(self.top, "rubbish")
        with open(rubbish, "wb") as file:
            file.write(b"rubbish" * 1000)
        for expect, words, arguments in [
                (1, "nothing.lcmlog", [os.path.join(self.top, "nothing.lcmlog")]),
                (1, "directory", [self.top]),
                (1, "heartbeat", [rubbish]), (1, "no LCM log", [rubbish, "--messages"]),
                (1, "R09", [self.log, "--robot", "R09"]), (1, "NOBODY", [self.log, "--node", "NOBODY"]),
                (1, "no whole fused map", [self.log, "--mission", "5", "--png", "x.png"]),
                (1, "cannot write", [self.log, "--csv", self.top]),
                (2, "--messages", [self.log, "--messages", "--json"]), (2, "usage", [])]:
            done = run(*arguments, expect=expect)
            self.assertEqual(done.stdout, "")
            self.assertIn(words, done.stderr)
            self.assertNotIn("Traceback", done.stderr)
        self.assertIn("--png", run("--help").stdout)


def decode_png(data):
    """(width, height, rows of (r, g, b)) of a PNG with 8 bits a channel and no filters."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks = 8, {}
    while at < len(data):
        (size,) = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + size]
        assert struct.unpack_from(">I", data, at + 8 + size)[0] == zlib.crc32(kind + body)
        chunks[kind] = body
        at += 12 + size
    width, height, depth, color = struct.unpack_from(">IIBB", chunks[b"IHDR"])
    assert (depth, color) == (8, 2)
    raw, stride = zlib.decompress(chunks[b"IDAT"]), 1 + 3 * width
    assert len(raw) == height * stride and all(raw[y * stride] == 0 for y in range(height))
    return width, height, [list(zip(*[iter(raw[y * stride + 1:(y + 1) * stride])] * 3)) for y in range(height)]


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
