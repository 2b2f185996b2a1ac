#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that flies by its own cameras: a recording played onto LCM gives the map that flying its folder gives.

Usage: live_camera_test.py BIN_DIR [unittest arguments], inside a network namespace of its own.
"""
import json
import math
import os
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

BIN = os.path.abspath(sys.argv[1])
AGENT, CONSOLE = os.path.join(BIN, "robot_agent"), os.path.join(BIN, "operator_console")
WIDTH, HEIGHT, FRAMES = 160, 120, 15
CAMERA = {"width": WIDTH, "height": HEIGHT, "fx": 100, "fy": 100, "cx": 79.5, "cy": 59.5, "depth_factor": 500}
CAMERA_GROUP, CAMERA_PORT = "239.255.76.67", 7822


def png(path, bits, channels, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, bits, 2 if channels == 3 else 0, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                   chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 1)) + chunk(b"IEND", b""))


def write_recording(folder):
    """Patches of three kinds seen from 2 m above, along x; depth and poses on clocks of their own."""
    for kind in ("rgb", "depth"):
        os.makedirs(os.path.join(folder, kind))
    noise = 12345
    lists = {"rgb": "# timestamp filename\n", "depth": "# timestamp filename\n"}
    for i in range(FRAMES):
        shot, ranged = 100 + 0.2 * i, 100.004 + 0.2 * i
        rows = []
        for v in range(HEIGHT):
            row = bytearray()
            for u in range(WIDTH):
                noise = (noise * 1103515245 + 12345) & 0x7FFFFFFF
                x, y = (u + 10 * i) // 40, v // 40
                grain = (noise >> 16) % (20, 90, 50)[(x + y) % 3]
                row += bytes(min(255, c + grain) for c in ((60, 90, 40), (120, 40, 90), (20, 60, 160))[(x * 2 + y) % 3])
            rows.append(bytes(row))
        png(os.path.join(folder, "rgb", f"{i}.png"), 8, 3, rows)
        lists["rgb"] += f"{shot:.6f} rgb/{i}.png\n"
        depth = struct.pack(f">{WIDTH}H", *(0 if (u + i) % 50 == 0 else 1000 + u % 7 for u in range(WIDTH)))
        png(os.path.join(folder, "depth", f"{i}.png"), 16, 1, [depth] * HEIGHT)
        lists["depth"] += f"{ranged:.6f} depth/{i}.png\n"
    for kind, text in lists.items():
        with open(os.path.join(folder, kind + ".txt"), "w", encoding="utf-8") as file:
            file.write(text)
    with open(os.path.join(folder, "groundtruth.txt"), "w", encoding="utf-8") as file:
        for k in range(60):  # every .07 s, from before the first picture to after the last
            t, tilt = 99.9 + 0.07 * k, 0.1 * math.sin(k)
            file.write(f"{t:.6f} {t - 100:.6f} 0.0 2.0 {math.cos(tilt):.9f} {math.sin(tilt):.9f} 0 0\n")
    with open(os.path.join(folder, "camera.json"), "w", encoding="utf-8") as file:
        json.dump(CAMERA, file)


def read(path):
    with open(path, "rb") as file:
        return file.read()


class LiveCamera(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.top = tempfile.mkdtemp(prefix="shoal_live_")
        cls.folder = os.path.join(cls.top, "recording")
        write_recording(cls.folder)
        cls.camera = os.path.join(cls.folder, "camera.json")
        cls.flown = os.path.join(cls.top, "flown")
        subprocess.run([AGENT, "--single", "--source", cls.folder, "--cell-size-m", "0.2", "--out", cls.flown],
                       check=True, timeout=120, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.top)

    def setUp(self):
        self.started = []

    def tearDown(self):
        for process in self.started:
            if process.poll() is None:
                process.kill()
            process.wait()

    def start_agent(self, name, *more):
        self.log = os.path.join(self.top, name + ".log")
        with open(self.log, "w", encoding="utf-8") as log:
            process = subprocess.Popen(
                [AGENT, "--robot", "R00", "--source", "lcm:AUV1", "--camera", self.camera, "--cell-size-m", "0.2",
                 "--lcm-url", "udpm://239.255.76.67:7821?ttl=0", "--out", os.path.join(self.top, name),
                 "--source-url", f"udpm://{CAMERA_GROUP}:{CAMERA_PORT}?ttl=0", *more], stdout=log, stderr=log)
        self.started.append(process)
        self.wait_for(" flies ")
        return process

    def wait_for(self, text, limit=120):
        deadline = time.monotonic() + limit
        while text not in read(self.log).decode():
            self.assertLess(time.monotonic(), deadline, f"waited in vain for \"{text}\":\n" + read(self.log).decode())
            time.sleep(0.1)

    def play(self):
        done = subprocess.run([CONSOLE, "play", self.folder, "--prefix", "AUV1", "--rate", "1", "--lcm-url",
                               f"udpm://{CAMERA_GROUP}:{CAMERA_PORT}?ttl=0"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"said {FRAMES} images, {FRAMES} depth images and 60 poses", done.stderr)

    def land(self, process):
        self.wait_for("landed after")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 0)

    def expect_the_flown_map(self, name):
        folder = os.path.join(self.top, name, "robots", "R00")
        for file in ("poses.txt", "map.csv", "topics.json"):
            self.assertEqual(read(os.path.join(folder, file)), read(os.path.join(self.flown, file)), file)
        self.assertGreater(len(read(os.path.join(folder, "map.csv")).splitlines()), 100)

    def test_a_played_recording_gives_the_map_of_its_folder(self):
        agent = self.start_agent("played", "--source-timeout-s", "4")
        self.play()
        self.land(agent)
        self.expect_the_flown_map("played")
        self.assertNotIn("left out", read(self.log).decode())

    def test_rubbish_on_the_cameras_channels_is_counted_and_changes_nothing(self):
        agent = self.start_agent("rubbish", "--observations", str(FRAMES))
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(sock.close)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        for i in range(300):
            channel = b"AUV1_" + (b"IMAGE", b"DEPTH", b"IMAGES", b"POSE")[i % 4]
            body = bytes((i * 7 + k * 31) % 256 for k in range(i))
            sock.sendto(b"LC02" + i.to_bytes(4, "big") + channel + b"\0" + body, (CAMERA_GROUP, CAMERA_PORT))
            time.sleep(0.001)
        self.play()
        self.land(agent)
        self.expect_the_flown_map("rubbish")
        self.assertRegex(read(self.log).decode(), r"left out: \d+ messages refused: too short, \d+ messages refused: wrong type")

    def test_lands_when_told_to_though_nothing_was_ever_seen(self):
        agent = self.start_agent("idle")
        time.sleep(0.5)
        agent.send_signal(signal.SIGTERM)
        self.assertEqual(agent.wait(timeout=20), 0)

    def test_says_what_it_needs(self):
        for more, what in [([], "--camera"), (["--camera", self.camera], "--cell-size-m"),
                           (["--camera", self.camera, "--cell-size-m", "1", "--single"], "--single"),
                           (["--camera", self.top + "/none.json", "--cell-size-m", "1"], "none.json")]:
            done = subprocess.run([AGENT, "--source", "lcm:AUV1", *more], capture_output=True, text=True, timeout=20)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(what, done.stderr)
        done = subprocess.run([AGENT, "--source", "lcm:A B", "--camera", self.camera, "--cell-size-m", "1"],
                              capture_output=True, text=True, timeout=20)
        self.assertEqual(done.returncode, 2)
        self.assertIn("prefix", done.stderr)
        done = subprocess.run([CONSOLE, "play", self.top], capture_output=True, text=True, timeout=20)
        self.assertEqual(done.returncode, 2)
        self.assertIn("rgb", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
