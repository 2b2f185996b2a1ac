#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How the page keeps up: a made node with a million cells, twelve robots that change it five times a second.

Usage: page_benchmark.py BIN_DIR WEB_DIR [SECONDS [SCREENSHOT]]; WEB_DIR as page_bundle.sh makes it. Prints the rows of docs/benchmarks.md. No test:
it asserts no time.
"""
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

BIN, WEB = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
SECONDS = sys.argv[3] if len(sys.argv) > 3 else "20"
SIDE, ROBOTS, CELL, LABELS = 1000, 12, 0.25, 24
BLOCK = 16
FOOTPRINT = 16, 12  # cells that a robot sees at once


class MadeNode(threading.Thread):
    """Answers as fusion_node --state does."""

    def __init__(self, folder):
        super().__init__(daemon=True)
        self.started, self.version, self.changed = time.monotonic(), 0, {}  # blocks by the version in which they changed
        self.cells = [[self.line(i, j, i // 90 * 7 + j // 70, 0, 1.0) for i in range(SIDE)] for j in range(SIDE)]
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.bind(os.path.join(folder, "node.sock"))
        self.socket.listen(16)
        self.labels = "label,name,cells,area_m2,robots,first_seen_s\\n" + "".join(
            f"{n * 10000},,{SIDE * SIDE // LABELS},1.000,R00;R01,0.000\\n" for n in range(LABELS))
        self.rows_of_labels = json.dumps([{"label": n * 10000, "name": "", "cells": SIDE * SIDE // LABELS, "area_m2": 1.0,
                                           "robots": ["R00", "R01"], "first_seen_s": 0.0, "last_seen_s": 0.0, "certainty": 0.5}
                                          for n in range(LABELS)])

    @staticmethod
    def line(i, j, mixed, robot, seen):
        return f"{CELL * i:.3f},{CELL * j:.3f},0.000,{mixed % LABELS * 10000},R{robot:02d},{seen:.3f},{0.5 + mixed % 50 / 100:.4f}"

    def place(self, robot, tick):
        """Lanes of its own, to and fro."""
        way = (tick * 4) % (2 * (SIDE - FOOTPRINT[0]))
        return min(way, 2 * (SIDE - FOOTPRINT[0]) - way), robot * (SIDE // ROBOTS) + tick // 250 % 5 * FOOTPRINT[1]

    def move(self):
        tick = int((time.monotonic() - self.started) * 5)
        while self.version < tick:
            self.version += 1
            for robot in range(ROBOTS):
                x, y = self.place(robot, self.version)
                for j in range(y, y + FOOTPRINT[1]):
                    for i in range(x, x + FOOTPRINT[0]):
                        self.cells[j][i] = self.line(i, j, i * 31 // 40 + j // 9 + self.version // 40, robot, self.version / 5)
                        self.changed[i // BLOCK, j // BLOCK] = self.version

    def status(self):
        nodes = []
        for robot in range(ROBOTS):
            x, y = self.place(robot, self.version)
            nodes.append({"name": f"R{robot:02d}", "phase": "flying", "heard_s": self.version / 5, "observation": self.version,
                          "num_observations": 100000, "topics": 9, "cells": SIDE * SIDE // ROBOTS, "bytes_sent": 300 * self.version,
                          "budget": 2000, "queue_bytes": 0, "ms_per_frame": 20.0, "position_m": [CELL * x, CELL * y, 5.0],
                          "rejected": 0, "conflicts": 0, "heard_whole": False, "agreement": "none"})
        return {"mission_id": 1, "cell_size_m": CELL, "cells": SIDE * SIDE, "labels": LABELS,
                "digest": {"state": f"{self.version:016x}", "map": f"{self.version:016x}"}, "nodes": nodes}

    def map(self, has):
        """As fusion_node: whole, or the squares of 16 x 16 columns that changed since."""
        changes, cells = "", ""
        if not has:
            cells = "".join("\\n".join(row) + "\\n" for row in self.cells)
        else:
            columns = [column for column, version in self.changed.items() if version > int(has, 16)]
            changes = f'"since": "{has}", "columns": {json.dumps(columns)}, '
            cells = "".join("\\n".join(self.cells[j][x * BLOCK:(x + 1) * BLOCK]) + "\\n" for x, y in columns
                            for j in range(y * BLOCK, min(SIDE, (y + 1) * BLOCK)))
        return (f'{{"cell_size_m": {CELL}, "digest": "{self.version:016x}", {changes}"labels_csv": "{self.labels}", "labels": {self.rows_of_labels}, '
                f'"global_map_csv": "x_m,y_m,z_m,label,robot,seen_s,certainty\\n{cells}"}}\n')

    def run(self):
        while True:
            link = self.socket.accept()[0]
            with link:
                question = json.loads(link.makefile("r", encoding="utf-8").readline())
                self.move()
                if question["query"] == "map":
                    link.sendall(self.map(question.get("has", "")).encode())
                else:
                    answer = {"status": self.status(), "pictures": {"labels": []}, "events": {"events": []}}.get(question["query"], {"error": "made up"})
                    link.sendall((json.dumps(answer) + "\n").encode())


def main():
    with tempfile.TemporaryDirectory(prefix="shoal_page_") as folder:
        MadeNode(folder).start()
        begun = time.monotonic()
        server = subprocess.Popen([os.path.join(BIN, "operator_console"), "serve", "--node", folder, "--port", "0", "--json"],
                                  stdout=subprocess.PIPE)
        try:
            url = json.loads(server.stdout.readline())["url"]
            subprocess.run(["node", "page_benchmark.mjs", url, SECONDS, *sys.argv[4:]], cwd=WEB, check=True, timeout=300)
            with open(f"/proc/{server.pid}/status", encoding="utf-8") as file:
                peak = next(int(line.split()[1]) for line in file if line.startswith("VmHWM"))
            with open(f"/proc/{server.pid}/stat", encoding="utf-8") as file:
                spent = sum(int(v) for v in file.read().split()[13:15]) / os.sysconf("SC_CLK_TCK")
            print(f"server: {peak / 1024:.0f} MB at most, {100 * spent / (time.monotonic() - begun):.0f} % of a core")
        finally:
            server.send_signal(signal.SIGINT)
            server.wait(timeout=20)


if __name__ == "__main__":
    main()
