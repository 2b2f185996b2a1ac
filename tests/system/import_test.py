#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""ROS 2 bags, written here byte for byte, become recordings that a robot flies.

Usage: import_test.py BIN_DIR DOCS_DIR [unittest arguments]
"""
import json
import os
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import jsonschema

BIN, DOCS = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
WIDTH, HEIGHT = 64, 48


class Cdr:
    """Plain CDR, as ROS 2 serialises."""

    def __init__(self, big=False):
        self.order, self.body = ">" if big else "<", b""
        self.head = bytes([0, 0 if big else 1, 0, 0])

    def put(self, code, *values):
        for value in values:
            size = struct.calcsize(code)
            self.body += bytes(-len(self.body) % size) + struct.pack(self.order + code, value)
        return self

    def text(self, value):
        self.put("I", len(value) + 1)
        self.body += value.encode() + b"\0"
        return self

    def sequence(self, data):
        self.put("I", len(data))
        self.body += data
        return self

    def header(self, stamp_us, frame):
        return self.put("i", stamp_us // 10**6).put("I", stamp_us % 10**6 * 1000).text(frame)

    def bytes(self):
        return self.head + self.body


def noise(count, seed):
    state, out = seed * 2654435761 % 2**32 or 1, bytearray()
    for _ in range(count):
        state = (state * 1664525 + 1013904223) % 2**32
        out.append(state >> 24)
    return bytes(out)


def image(us, encoding, data, step, big=False):
    cdr = Cdr(big).header(us, "camera_optical").put("I", HEIGHT, WIDTH).text(encoding).put("B", big).put("I", step)
    return cdr.sequence(data).bytes()


def camera_info(us, distortion=0.0):
    cdr = Cdr().header(us, "camera_optical").put("I", HEIGHT, WIDTH).text("plumb_bob").put("I", 5)
    cdr.put("d", distortion, 0, 0, 0, 0).put("d", 50, 0, 31.5, 0, 51, 23.5, 0, 0, 1)
    return cdr.put("d", *[0] * 9).put("d", *[0] * 12).put("I", 0, 0).put("I", 0, 0, 0, 0).put("B", 0).bytes()


def odometry(us, x, q=(0, 0, 0, 1)):
    return Cdr().header(us, "map").text("base_link").put("d", x, 2.5, 4, *q).put("d", *[0] * 84).bytes()


def pose_stamped(us, x, q):
    return Cdr(big=True).header(us, "map").put("d", x, 2.5, 4, *q).bytes()


TYPES = {"/cam/image": "sensor_msgs/msg/Image", "/cam/depth": "sensor_msgs/msg/Image",
         "/cam/info": "sensor_msgs/msg/CameraInfo", "/odom": "nav_msgs/msg/Odometry", "/chatter": "std_msgs/msg/String"}
T0 = 1_700_000_000_000_000


def dive(frames=3):
    """Messages of a short flight, and the pixels of its first picture as the recording must show them (RGB)."""
    messages = [("/chatter", Cdr().text("hello").bytes()), ("/cam/info", camera_info(T0))]
    first = None
    for n in range(frames):
        us = T0 + n * 1_000_000
        step = WIDTH * 3 + 5  # rows are padded
        rows = [noise(WIDTH * 3, 100 * n + y + 1) for y in range(HEIGHT)]
        first = first or b"".join(rows)
        messages.append(("/odom", odometry(us, n * 0.25)))
        messages.append(("/cam/depth", image(us, "32FC1", struct.pack("<f", 2.0004) * (WIDTH * HEIGHT - 1) +
                                             struct.pack("<f", float("nan")), WIDTH * 4)))
        messages.append(("/cam/image", image(us, "rgb8", b"".join(row + b"x" * 5 for row in rows), step)))
    return messages, first


def write_db3(path, messages, types=None):
    types = types or TYPES
    with sqlite3.connect(path) as db:
        db.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, "
                   "offered_qos_profiles TEXT)")
        db.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        ids = {name: n + 1 for n, name in enumerate(types)}
        for name, kind in types.items():
            db.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", (ids[name], name, kind))
        for n, (topic, data) in enumerate(messages):
            db.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", (ids[topic], n, data))
    db.close()


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def mcap(messages, chunked, compression=""):
    magic = b"\x89MCAP0\r\n"
    body, ids = b"", {}
    for n, (name, kind) in enumerate(TYPES.items(), 1):
        ids[name] = n
        body += record(3, struct.pack("<H", n) + text(kind) + text("ros2msg") + struct.pack("<I", 0))
        body += record(4, struct.pack("<HH", n, n) + text(name) + text("cdr") + struct.pack("<I", 0))
    for n, (topic, data) in enumerate(messages):
        body += record(5, struct.pack("<HIQQ", ids[topic], n, n, n) + data)
    if chunked:
        body = record(6, struct.pack("<QQQI", 0, 9, len(body), zlib.crc32(body)) + text(compression) +
                      struct.pack("<Q", len(body)) + body)
    return magic + record(1, text("ros2") + text("by hand")) + body + record(15, struct.pack("<I", 0)) + \
        record(2, struct.pack("<QQI", 0, 0, 0)) + magic


def png(path):
    """Width, height, bits, channels and bytes of a PNG without interlace."""
    with open(path, "rb") as file:
        data, at, packed = file.read(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", data[at + 8:at + 18])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    channels = {0: 1, 2: 3}[colour]
    pixel, raw = channels * bits // 8, zlib.decompress(packed)
    row_bytes, out, above = width * pixel, b"", bytes(width * pixel)
    for y in range(height):
        kind, row = raw[y * (row_bytes + 1)], bytearray(raw[y * (row_bytes + 1) + 1:(y + 1) * (row_bytes + 1)])
        for i in range(row_bytes):
            left, up = (row[i - pixel] if i >= pixel else 0), above[i]
            corner = above[i - pixel] if i >= pixel else 0
            guess = left + up - corner
            paeth = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            row[i] = (row[i] + (0, left, up, (left + up) // 2, paeth)[kind]) % 256
        out, above = out + bytes(row), bytes(row)
    return width, height, bits, channels, out


class Import(unittest.TestCase):
    def setUp(self):
        self.top = tempfile.mkdtemp(prefix="shoal_import_")
        self.addCleanup(shutil.rmtree, self.top)
        self.out = os.path.join(self.top, "out")

    def run_console(self, *arguments, expect=0):
        done = subprocess.run([os.path.join(BIN, "operator_console"), "import", *arguments], capture_output=True, text=True,
                              timeout=60, check=False)
        self.assertEqual(done.returncode, expect, done.stderr)
        return done

    def write(self, name, content):
        path = os.path.join(self.top, name)
        with open(path, "wb") as file:
            file.write(content)
        return path

    def check_dive(self, bag, *more):
        done = json.loads(self.run_console(bag, "--out", self.out, "--json", *more).stdout)
        with open(os.path.join(DOCS, "schemas", "import.schema.json"), encoding="utf-8") as file:
            jsonschema.validate(done, json.load(file))
        self.assertEqual((done["images"], done["depths"], done["poses"], done["left_out"]), (3, 3, 3, {}))
        self.assertEqual((done["image"], done["depth"], done["pose"], done["info"]),
                         ("/cam/image", "/cam/depth", "/odom", "/cam/info"))
        read = {}
        for name in ("rgb.txt", "depth.txt", "groundtruth.txt", "camera.json"):
            with open(os.path.join(self.out, name), encoding="utf-8") as file:
                read[name] = file.read()
        self.assertEqual(read["rgb.txt"].splitlines()[1], "1700000000.000000 rgb/1700000000.000000.png")
        self.assertEqual(len(read["depth.txt"].splitlines()), 4)
        self.assertEqual([float(v) for v in read["groundtruth.txt"].splitlines()[2].split()],
                         [1700000001.0, 0.25, 2.5, 4, 0, 0, 0, 1])
        self.assertEqual(json.loads(read["camera.json"]), {"width": 64, "height": 48, "fx": 50, "fy": 51, "cx": 31.5, "cy": 23.5,
                                                           "depth_factor": 1000})
        self.assertEqual(png(os.path.join(self.out, "rgb/1700000000.000000.png")), (WIDTH, HEIGHT, 8, 3, dive()[1]))
        depth = png(os.path.join(self.out, "depth/1700000000.000000.png"))
        self.assertEqual(depth[:4], (WIDTH, HEIGHT, 16, 1))
        self.assertEqual(depth[4], struct.pack(">H", 2000) * (WIDTH * HEIGHT - 1) + b"\0\0")

    def test_a_db3_bag_and_a_robot_flies_it(self):
        bag = os.path.join(self.top, "bag")
        os.mkdir(bag)
        write_db3(os.path.join(bag, "bag_0.db3"), dive()[0])
        self.check_dive(bag)
        subprocess.run([os.path.join(BIN, "robot_agent"), "--single", "--robot", "R00", "--source", self.out, "--observations",
                        "0", "--cell-size-m", "0.2", "--out", os.path.join(self.top, "flown")], check=True, timeout=120,
                       capture_output=True)
        with open(os.path.join(self.top, "flown", "poses.txt"), encoding="utf-8") as file:
            poses = [[float(v) for v in line.split()] for line in file]
        self.assertEqual(poses, [[n, n * 0.25, 2.5, 4, 0, 0, 0, 1] for n in range(3)])

    def test_a_bag_in_two_files_is_one(self):
        bag = os.path.join(self.top, "bag")
        os.mkdir(bag)
        messages = dive()[0]
        write_db3(os.path.join(bag, "bag_0.db3"), messages[:5])
        write_db3(os.path.join(bag, "bag_1.db3"), messages[5:])
        self.check_dive(bag)

    def test_mcap_plain(self):
        self.check_dive(self.write("a.mcap", mcap(dive()[0], chunked=False)))

    def test_mcap_in_chunks(self):
        self.check_dive(self.write("a.mcap", mcap(dive()[0], chunked=True)))

    def test_mcap_that_was_cut_off_is_read_as_far_as_it_goes(self):
        whole = mcap(dive()[0], chunked=False)
        bag = self.write("a.mcap", whole[:len(whole) - 3000])
        done = json.loads(self.run_console(bag, "--out", self.out, "--json").stdout)
        self.assertEqual(done["images"], 2)

    def test_another_packing_is_refused_by_name(self):
        bag = self.write("a.mcap", mcap(dive()[0], chunked=True, compression="lz4"))
        self.assertIn("packed with lz4; none and zstd", self.run_console(bag, "--out", self.out, expect=1).stderr)

    def test_poses_of_the_body_become_the_cameras(self):
        messages = [m for m in dive()[0] if m[0] != "/odom"]
        half = 0.5 ** 0.5
        for n in range(3):  # the body has turned left by a quarter: its x is the world's y
            messages.append(("/pose", pose_stamped(T0 + n * 1_000_000, n, (0, 0, half, half))))
        types = {**TYPES, "/pose": "geometry_msgs/msg/PoseStamped"}
        bag = os.path.join(self.top, "bag.db3")
        write_db3(bag, messages, types)
        self.run_console(bag, "--out", self.out, "--pose", "/pose", "--camera-on-body", "1", "0", "-0.5", "1", "0", "0", "0")
        with open(os.path.join(self.out, "groundtruth.txt"), encoding="utf-8") as file:
            pose = [float(v) for v in file.read().splitlines()[1].split()]
        for value, expected in zip(pose, [1700000000, 0, 3.5, 3.5, half, half, 0, 0]):
            self.assertAlmostEqual(value, expected, 6)

    def test_what_cannot_be_read_is_left_out_and_said(self):
        messages, _ = dive()
        messages.append(("/cam/image", image(T0 + 9_000_000, "bayer_rggb8", b"", 64)))
        messages.append(("/cam/image", image(T0 + 9_000_000, "rgb8", b"short", WIDTH * 3)))
        messages.append(("/cam/depth", b"\0\1\0\0"))
        messages.append(("/odom", odometry(T0 + 5, 1, q=(0, 0, 0, 0))))
        messages.append(("/odom", odometry(T0, 1)))
        bag = os.path.join(self.top, "bag.db3")
        write_db3(bag, messages)
        done = json.loads(self.run_console(bag, "--out", self.out, "--json").stdout)
        self.assertEqual(sum(done["left_out"].values()), 5, done)
        self.assertEqual((done["images"], done["depths"], done["poses"]), (3, 3, 3))

    def test_wrong_use_says_what_would_be_right(self):
        bag = os.path.join(self.top, "bag.db3")
        write_db3(bag, dive()[0], {**TYPES, "/odom2": "nav_msgs/msg/Odometry"})
        self.run_console(bag, "--out", self.out)  # /odom2 has no message
        self.assertIn("holds something already", self.run_console(bag, "--out", self.out, expect=2).stderr)
        self.assertIn("it could be: /cam/image",
                      self.run_console(bag, "--out", self.out + "2", "--image", "/nowhere", expect=2).stderr)
        both = os.path.join(self.top, "both.db3")
        write_db3(both, dive()[0] + [("/odom2", odometry(T0, 1))], {**TYPES, "/odom2": "nav_msgs/msg/Odometry"})
        self.assertIn("say --pose: /odom, /odom2", self.run_console(both, "--out", self.out + "2", expect=2).stderr)
        self.assertIn("is no MCAP file", self.run_console(self.write("x.mcap", b"nonsense"), "--out", self.out + "3",
                                                          expect=1).stderr)
        self.assertIn("x.db3", self.run_console(self.write("x.db3", b"nonsense" * 100), "--out", self.out + "3",
                                                expect=1).stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
