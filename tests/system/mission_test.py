#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whole missions with real processes on a private network: files, determinism, questions, errors.

Usage: mission_test.py BIN_DIR DOCS_DIR [unittest arguments], inside a network namespace of its own.
"""
import base64
import csv
import glob
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import jsonschema

BIN, DOCS = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
CONSOLE = os.path.join(BIN, "operator_console")
SIZE = ["--robots", "3", "--observations", "6", "--seed", "7"]


def run(*arguments, expect=0, timeout=240, cwd=None):
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=timeout, cwd=cwd)
    if done.returncode != expect:
        raise AssertionError(f"{' '.join(arguments)}: exit {done.returncode}, not {expect}\n{done.stdout}\n{done.stderr}")
    return done


def launch(out, *more, world="reef:tuning"):
    return run(CONSOLE, "launch", "--world", world, *SIZE, "--out", out, *more)


def read(path):
    with open(path, "rb") as file:
        return file.read()


def check_schema(name, value):
    with open(os.path.join(DOCS, "schemas", name + ".schema.json"), encoding="utf-8") as file:
        jsonschema.validate(value, json.load(file))


def ask(*arguments):
    return json.loads(run(CONSOLE, *arguments, "--json").stdout)


class Mission(unittest.TestCase):
    """One recorded mission that most tests look at."""

    @classmethod
    def setUpClass(cls):
        cls.top = tempfile.mkdtemp(prefix="shoal_mission_")
        cls.a = os.path.join(cls.top, "a")
        launch(cls.a, "--rate", "max", "--single", "--record")
        with open(os.path.join(cls.a, "summary.json"), encoding="utf-8") as file:
            cls.summary = json.load(file)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.top)

    def check_csv(self, path, patterns):
        text = read(os.path.join(self.a, path)).decode()
        self.assertNotIn("\r", text)
        self.assertTrue(text.endswith("\n"))
        rows = list(csv.reader(text.splitlines()))
        self.assertEqual(rows[0], list(patterns))
        self.assertGreater(len(rows), 1, path)
        for row in rows[1:]:
            self.assertEqual(len(row), len(patterns), row)
            for field, pattern in zip(row, patterns.values()):
                self.assertRegex(field, "^" + pattern + "$", path)
        return rows[1:]

    METRES, CERTAINTY, ROBOT = r"-?\d+\.\d{3}", r"[01]\.\d{4}", r"R\d\d+"

    def test_every_file_has_its_columns(self):
        m, c = self.METRES, self.CERTAINTY
        cells = self.check_csv("global_map.csv", {"x_m": m, "y_m": m, "z_m": m, "label": r"\d+", "robot": self.ROBOT,
                                                  "seen_s": m, "certainty": c})
        places = [tuple(float(v) for v in row[:3]) for row in cells]
        self.assertEqual(places, sorted(set(places)), "rows are not in canonical order")
        labels = self.check_csv("labels.csv", {"label": r"\d+", "name": ".*", "cells": r"\d+", "area_m2": m,
                                               "robots": self.ROBOT + "(;" + self.ROBOT + ")*", "first_seen_s": m})
        counted = {row[0]: int(row[2]) for row in labels}
        for label in counted:
            self.assertEqual(counted[label], sum(row[3] == label for row in cells))
        self.assertEqual(sum(counted.values()), len(cells))
        for folder in ["robots/R00", "robots/R01", "robots/R02", "single"]:
            self.check_csv(folder + "/map.csv", {"x_m": m, "y_m": m, "z_m": m, "topic": r"\d+", "seen_s": m, "certainty": c})
            topics = json.loads(read(os.path.join(self.a, folder, "topics.json")))
            check_schema("topics", topics)
            for topic in topics["topics"]:
                self.assertEqual(topic["weight"], sum(topic["words"].values()))
                self.assertTrue(all(0 <= int(word) < topics["vocabulary"] for word in topic["words"]))
            poses = read(os.path.join(self.a, folder, "poses.txt")).decode().splitlines()
            self.assertEqual(len(poses), 18 if folder == "single" else 6)
            self.assertTrue(all(len(line.split()) == 8 for line in poses))
        for name in ["R00", "R01", "R02", "OPERATOR", "single"]:
            for line in read(os.path.join(self.a, "logs", name + ".log")).decode().splitlines():
                self.assertRegex(line, r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3} \w+ " + name + ": ")
        self.assertEqual(read(os.path.join(self.a, "global_map.png"))[:8], b"\x89PNG\r\n\x1a\n")

    def test_the_summary_says_what_happened(self):
        s = self.summary
        check_schema("summary", s)
        self.assertEqual((s["seed"], s["world"], s["robots"], s["observations"]), (7, "reef:tuning", ["R00", "R01", "R02"], 6))
        self.assertTrue(s["converged"])
        self.assertLessEqual(s["worst_window"]["bytes"], max(2000 * max(1, s["worst_window"]["length_s"]), 1428) + 1)
        cells = len(read(os.path.join(self.a, "global_map.csv")).splitlines()) - 1
        self.assertEqual(s["cells"], cells)
        for robot in s["robots"]:
            self.assertGreater(s["bytes"][robot]["topics"], 0)
            self.assertGreater(s["bytes"][robot]["bricks"], 0)

    def test_the_same_seed_gives_the_same_bytes_at_any_rate(self):
        b = os.path.join(self.top, "b")
        launch(b, "--rate", "10", "--budget", "0")
        for path in ["global_map.csv", "labels.csv"] + [
                f"robots/R0{r}/{name}" for r in range(3) for name in ("map.csv", "topics.json", "poses.txt")]:
            self.assertEqual(read(os.path.join(self.a, path)), read(os.path.join(b, path)), path)

    def test_names_go_along_to_the_next_mission(self):
        a, b = os.path.join(self.top, "named"), os.path.join(self.top, "library")
        shutil.copytree(self.a, a)
        file = os.path.join(self.top, "reef.library")
        self.assertIn("no label has a name", run(CONSOLE, "library", "save", "--run", a, "--out", file, expect=1).stderr)
        rows = ask("labels", "--run", a)["labels"]
        self.assertNotIn("library", rows[0])
        largest = sorted(rows, key=lambda row: -row["cells"])[:2]
        for row, name in zip(largest, ("brain coral", "sand")):
            run(CONSOLE, "name", str(row["label"]), name, "--run", a)
        saved = ask("library", "save", "--run", a, "--out", file)
        check_schema("library", saved)
        self.assertEqual([t["name"] for t in saved["topics"]], ["brain coral", "sand"])
        self.assertEqual(ask("library", "show", file), saved)
        launch(b, "--library", file, "--record")
        rows = ask("labels", "--run", b)
        check_schema("labels", rows)
        names = {row["name"]: row["library"] for row in rows["labels"]}
        for name in ("brain coral", "sand"):
            self.assertIn(name, names.get(name, []), rows)
        self.assertIn([], names.values(), "nothing is new")
        self.assertEqual(ask("library", "show", os.path.join(b, "library.json"))["digest"], saved["digest"])
        self.assertIn("* ", run(CONSOLE, "labels", "--run", b).stdout)
        again = os.path.join(self.top, "library_again")
        run(CONSOLE, "replay", os.path.join(b, "mission.lcmlog"), "--out", again)
        for path in ("global_map.csv", "labels.csv"):
            self.assertEqual(read(os.path.join(again, path)), read(os.path.join(b, path)), path)

    def test_a_bad_link_gives_the_same_bytes(self):
        link = os.path.join(self.top, "bay.json")
        with open(link, "w", encoding="utf-8") as file:
            json.dump({"like": "mesh", "loss": 0.3, "delay_s": 1.5, "reordering": 0.2, "duplication": 0.1,
                       "partitions": [{"from_s": 2, "until_s": 8, "groups": [["R00"], ["R01", "R02", "OPERATOR"]]}]}, file)
        out = os.path.join(self.top, "bay")
        launch(out, "--link", link)
        for path in ["global_map.csv", "labels.csv"]:
            self.assertEqual(read(os.path.join(self.a, path)), read(os.path.join(out, path)), path)
        with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        check_schema("summary", summary)
        self.assertEqual((summary["link"], summary["converged"]), (link, True))
        said = re.search(r"the link: (\d+) messages of others, \d+ delivered; lost (\d+), .* parted (\d+)",
                         read(os.path.join(out, "logs", "OPERATOR.log")).decode())
        sent, lost, parted = (int(n) for n in said.groups())
        self.assertGreater(lost, 0.15 * sent)
        self.assertGreater(parted, 0)

    def test_robots_that_crash_come_back_and_the_map_is_the_same(self):
        plan, out = os.path.join(self.top, "plan.txt"), os.path.join(self.top, "crashes")
        with open(plan, "w", encoding="utf-8") as file:
            file.write("# R01 while it flies, R02 when it has landed; R00 loses its disk\n3 R01 kill\n5.5 R01 restart\n"
                       "8 R02 kill\n12 R02 restart\n4 R00 kill\n9 R00 anew\n")
        done = launch(out, "--kill-plan", plan, "--record", "--link", "mesh")
        for robot in ["R00", "R01", "R02"]:
            self.assertRegex(done.stderr, robot + r" is killed at .* as planned")
            said = read(os.path.join(out, "logs", robot + ".log")).decode()
            self.assertEqual("goes on from a checkpoint" in said, robot != "R00", said)
            self.assertTrue(said.rstrip().split("landed after 6 observations")[1:], said)
        for path in ["global_map.csv", "labels.csv"] + [f"robots/R0{r}/map.csv" for r in range(3)]:
            self.assertEqual(read(os.path.join(self.a, path)), read(os.path.join(out, path)), path)
        log = os.path.join(out, "mission.lcmlog")
        answer = ask("verify", log)
        check_schema("verify", answer)
        self.assertEqual(answer["wrong"], [])
        nodes = [node["node"] for node in answer["nodes"] if node["node"] != "LAUNCH"]
        self.assertEqual(nodes, ["OPERATOR", "R00", "R00", "R01", "R01", "R02", "R02"])
        with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        for robot in ["R00", "R01", "R02"]:  # all that it said but for what followed the last heartbeat of each life
            lives = [node["bytes"] for node in answer["nodes"] if node["node"] == robot]
            told = sum(count for name, count in summary["bytes"][robot].items() if name != "local")
            self.assertGreater(told, max(lives), robot)
            self.assertLessEqual(told, sum(lives), robot)
            self.assertEqual([node["bytes_sent"] for node in summary["nodes"] if node["name"] == robot], [told])
        self.assertTrue(ask("replay", log, "--out", os.path.join(self.top, "crashes_again"))["whole"])

    def test_processes_that_are_killed_without_a_plan_come_back(self):
        out = os.path.join(self.top, "shot")
        flight = subprocess.Popen([CONSOLE, "launch", "--world", "reef:tuning", *SIZE, "--out", out, "--rate", "4"],
                                  stderr=subprocess.PIPE, text=True)
        try:
            for name in ["R01", "OPERATOR"]:
                deadline = time.time() + 60
                while time.time() < deadline:
                    shot = subprocess.run(["pgrep", "-f", f"(--robot|--node) {name} .*{out}( |$|/)"], capture_output=True, text=True)
                    if shot.stdout.split() and os.path.exists(os.path.join(out, "state", "robots", "R02.checkpoint")):
                        break
                    time.sleep(0.2)
                os.kill(int(shot.stdout.split()[0]), signal.SIGKILL)
            _, said = flight.communicate(timeout=200)
        finally:
            flight.kill()
            flight.wait()
        self.assertEqual(flight.returncode, 0, said)
        self.assertRegex(said, "R01 was killed by signal 9")
        self.assertRegex(said, "OPERATOR was killed by signal 9")
        for path in ["global_map.csv", "labels.csv"] + [f"robots/R0{r}/map.csv" for r in range(3)]:
            self.assertEqual(read(os.path.join(self.a, path)), read(os.path.join(out, path)), path)

    def test_robots_look_again_when_all_have_landed_unless_told_not_to(self):
        once = os.path.join(self.top, "once")
        launch(once, "--no-look-again")
        for out, looked in [(self.a, True), (once, False)]:
            with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
                summary = json.load(file)
            self.assertEqual((summary["looks_again"], summary["profile"]), (looked, "best"))
            for robot in ["R00", "R01", "R02"]:
                said = read(os.path.join(out, "logs", robot + ".log")).decode()
                self.assertEqual("looked again with" in said, looked, said)
        for robot in ["R00", "R01", "R02"]:
            path = f"robots/{robot}/topics.json"
            self.assertEqual(read(os.path.join(once, path)), read(os.path.join(self.a, path)))
        self.assertNotEqual(read(os.path.join(once, "global_map.csv")), read(os.path.join(self.a, "global_map.csv")))

    def test_a_file_of_somebody_elses_is_not_written_over(self):
        own = os.path.join(self.top, "own")
        os.makedirs(own)
        with open(os.path.join(own, "summary.html"), "w", encoding="utf-8") as file:
            file.write("mine")
        self.assertIn("holds a summary.html of its own", run(CONSOLE, "launch", "--world", "reef:tuning", *SIZE, "--out", own, expect=2).stderr)
        self.assertEqual(read(os.path.join(own, "summary.html")), b"mine")

    def test_another_seed_gives_another_map_and_nothing_is_left_of_the_old(self):
        c = os.path.join(self.top, "c")
        old = ["logs/OPERATOR.log", "mission.lcmlog", "pictures/99.png", "surprise.csv"]
        foreign = ["robots/notes.txt", "robots/R00/notes.txt", "pictures/reef.png", "notes/map.csv", "state/maps/7.png"]
        for path in old + foreign:
            os.makedirs(os.path.dirname(os.path.join(c, path)), exist_ok=True)
            with open(os.path.join(c, path), "w", encoding="utf-8") as file:
                file.write("old")
        again = [CONSOLE, "launch", "--world", "reef:tuning", *SIZE[:-1], "8", "--out", c]
        self.assertIn("did not end (mission.lcmlog)", run(*again, expect=2).stderr)
        self.assertIn(f"map: {c}/global_map.png", run(*again, "--overwrite").stdout)
        for path in old:
            if os.path.exists(os.path.join(c, path)):
                self.assertNotEqual(read(os.path.join(c, path)), b"old", path)
        self.assertFalse(os.path.exists(os.path.join(c, "pictures/99.png")))
        for path in foreign:
            self.assertEqual(read(os.path.join(c, path)), b"old", path)
        self.assertNotEqual(read(os.path.join(self.a, "global_map.csv")), read(os.path.join(c, "global_map.csv")))

    def test_evaluate_agrees_with_the_summary(self):
        scores = ask("evaluate", "--run", self.a, "--world", "reef:tuning")
        check_schema("evaluate", scores)
        self.assertEqual(scores, self.summary["scores"])
        self.assertEqual(set(scores["matchers"]), {"id", "hungarian", "incremental", "clear", "shoal"})
        self.assertEqual(set(ask("evaluate", "--run", self.a, "--world", "reef:tuning", "--matcher", "id")["matchers"]), {"id"})

    def test_run_and_recording_give_the_same_answers(self):
        log = os.path.join(self.a, "mission.lcmlog")
        of_run, of_log = ask("status", "--run", self.a), ask("status", "--log", log)
        check_schema("status", of_run)
        check_schema("status", of_log)
        self.assertEqual(of_run["digest"], of_log["digest"])
        self.assertEqual(of_run["cells"], of_log["cells"])
        labels = ask("labels", "--run", self.a)
        check_schema("labels", labels)
        for row in labels["labels"]:  # a run has files of its pictures
            for picture in row["pictures"]:
                self.assertTrue(read(os.path.join(self.a, picture.pop("file"))).startswith(b"\x89PNG"))
        self.assertEqual(labels, ask("labels", "--log", log))
        first = read(os.path.join(self.a, "global_map.csv")).decode().splitlines()[1].split(",")
        at = ask("at", first[0], first[1], "--run", self.a)
        check_schema("at", at)
        self.assertIn(int(first[3]), [cell["label"] for cell in at["cells"]])
        # A recording holds certainties in ninths, and so does the map: everything is equal.
        self.assertEqual(at["cells"], ask("at", first[0], first[1], "--log", log)["cells"])
        self.assertEqual(ask("at", "1e5", "1e5", "--run", self.a)["cells"], [])

    def test_events_and_score_of_a_finished_mission(self):
        events = ask("events", "--run", self.a)
        check_schema("events", events)
        self.assertEqual(events, ask("events", "--log", os.path.join(self.a, "mission.lcmlog")))
        landed = {e["node"] for e in events["events"] if e["kind"] == "landed"}
        self.assertEqual(landed, {"R00", "R01", "R02"})
        scored = ask("score", "--run", self.a, "--world", "reef:tuning")
        check_schema("score", scored)
        told = ask("evaluate", "--run", self.a, "--world", "reef:tuning", "--matcher", "shoal")
        self.assertAlmostEqual(scored["ami"], told["matchers"]["shoal"]["ami"], places=5)

    def test_the_map_is_scored_by_the_cells_that_a_person_named(self):
        path = os.path.join(self.top, "named.csv")
        draw = ["score", "--run", self.a, "--draw", "60", "--out", path]
        run(CONSOLE, *draw)
        self.assertIn("is there already", run(CONSOLE, *draw, expect=2).stderr)
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 60)
        label_at = {(c["x_m"], c["y_m"], c["z_m"]): c["label"] for c in csv.DictReader(
            read(os.path.join(self.a, "global_map.csv")).decode().splitlines())}
        for row in rows:  # somebody who sees exactly what the map shows
            row["name"] = "kind, " + label_at[row["x_m"], row["y_m"], row["z_m"]]
        with open(path, "w", encoding="utf-8", newline="") as file:
            table = csv.DictWriter(file, rows[0].keys())
            table.writeheader()
            table.writerows(rows)
        score = ask("score", "--run", self.a, "--named", path)
        check_schema("score_named", score)
        self.assertEqual((score["named"], score["ami"], score["high"]), (60, 1, 1))
        self.assertLess(score["low"], 1)
        self.assertEqual(score, ask("score", "--log", os.path.join(self.a, "mission.lcmlog"), "--named", path))

    def test_the_summary_page_says_what_happened_and_needs_nothing_else(self):
        page = read(os.path.join(self.a, "summary.html")).decode()
        for row in ask("labels", "--run", self.a)["labels"]:
            self.assertIn(row["name"] or f"label {row['label']}", page)
        self.assertNotRegex(page, r'(src|href)="(?!data:)')
        self.assertIn(base64.b64encode(read(os.path.join(self.a, "global_map.png"))).decode(), page)
        again = os.path.join(self.top, "again.html")
        run(CONSOLE, "summary", "--run", self.a, "--out", again)
        self.assertEqual(read(again).decode(), page)

    def test_area_why_node_and_diff_are_answered(self):
        log = os.path.join(self.a, "mission.lcmlog")
        label = max(ask("labels", "--run", self.a)["labels"], key=lambda row: row["cells"])
        for question in [("area", str(label["label"])), ("why", str(label["label"])), ("node", "R01")]:
            answer = ask(*question, "--run", self.a)
            check_schema(question[0], answer)
            heard = ask(*question, "--log", log)
            if question[0] == "node":  # how its clock and settings stood to others' is in what was said, not in the files
                self.assertEqual(heard["node"]["settings"], "same")
                self.assertGreater(heard["node"]["heard_share"], 0.9)  # the recorder is beside everybody
                for told in (answer, heard):
                    del told["node"]["clock_skew_s"], told["node"]["settings"], told["node"]["heard_share"]
            self.assertEqual(answer, heard, question)
        area = ask("area", str(label["label"]), "--run", self.a)
        self.assertAlmostEqual(area["area_m2"], label["area_m2"], places=2)
        self.assertEqual(sum(patch["cells"] for patch in area["patches"]), label["cells"])
        why = ask("why", str(label["label"]), "--run", self.a)
        self.assertEqual(sorted({member["robot"] for member in why["members"]}), label["robots"])
        diff = ask("diff", "0", "1000000000", "--run", self.a)
        check_schema("diff", diff)
        self.assertEqual((diff["cells_before"], diff["cells_after"]), (0, self.summary["cells"]))
        self.assertEqual(diff["total"]["appeared"], self.summary["cells"])

    def test_a_recording_exports_the_very_map(self):
        out = os.path.join(self.top, "from_log.csv")
        run(CONSOLE, "export", "--format", "csv", "--out", out, "--log", os.path.join(self.a, "mission.lcmlog"))
        self.assertEqual(read(out), read(os.path.join(self.a, "global_map.csv")))
        others = os.path.join(self.top, "from_reader.csv")
        reader = os.path.join(DOCS, "..", "common", "wire", "python", "shoal_reader.py")
        told = json.loads(run(sys.executable, "-B", reader, os.path.join(self.a, "mission.lcmlog"), "--csv", others, "--json").stdout)
        self.assertEqual(read(others), read(os.path.join(self.a, "global_map.csv")))
        self.assertEqual(told["state_digest"], self.summary["digest"]["state"])
        self.assertEqual({name: robot["whole"] for name, robot in told["robots"].items()}, {"R00": True, "R01": True, "R02": True})
        png = os.path.join(self.top, "map.png")
        run(CONSOLE, "export", "--format", "png", "--out", png, "--run", self.a)
        self.assertEqual(read(png)[:4], b"\x89PNG")

    def test_surprises_are_the_same_of_the_run_and_of_its_recording(self):
        of_run = ask("surprises", "--run", self.a, "--least", "1.5")
        check_schema("surprises", of_run)
        self.assertEqual(of_run, ask("surprises", "--log", os.path.join(self.a, "mission.lcmlog"), "--least", "1.5"))
        rows = list(csv.DictReader(read(os.path.join(self.a, "surprise.csv")).decode().splitlines()))
        self.assertEqual(of_run["cells"], len(rows))
        self.assertEqual(sum(place["cells"] for place in of_run["places"]), len(rows))
        if rows:
            self.assertEqual(of_run["places"][0]["surprise"], max(float(row["surprise"]) for row in rows))
        table = run(CONSOLE, "surprises", "--run", self.a, "--csv", "--least", "0").stdout.replace("\r", "")
        self.assertEqual(table.encode(), read(os.path.join(self.a, "surprise.csv")))

    def test_a_recording_alone_gives_the_same_bytes(self):
        out = os.path.join(self.top, "replayed")
        answer = ask("replay", os.path.join(self.a, "mission.lcmlog"), "--out", out)
        check_schema("replay", answer)
        self.assertEqual((answer["whole"], answer["lacking"]), (True, []))
        self.assertEqual(answer["digest"], self.summary["digest"])
        for path in ["global_map.csv", "labels.csv", "surprise.csv"]:
            self.assertEqual(read(os.path.join(out, path)), read(os.path.join(self.a, path)), path)
        for robot in self.summary["robots"]:  # certainties travel in ninths
            self.assertEqual(*(read(os.path.join(top, "robots", robot, "surprise.csv")) for top in (out, self.a)), robot)
            told, own = (list(csv.reader(read(os.path.join(top, "robots", robot, "map.csv")).decode().splitlines()))
                         for top in (out, self.a))
            self.assertEqual([row[:5] for row in told], [row[:5] for row in own])
            self.assertTrue(all(abs(float(t[5]) - float(o[5])) < 0.5 / 9 + 1e-4 for t, o in zip(told[1:], own[1:])))
        self.assertEqual(sorted(answer["files"]), sorted(os.path.relpath(os.path.join(folder, name), out)
                                                         for folder, _, names in os.walk(out) for name in names))

    def test_a_recording_proves_that_the_mission_was_in_order(self):
        answer = ask("verify", os.path.join(self.a, "mission.lcmlog"))
        check_schema("verify", answer)
        self.assertEqual((answer["good"], answer["wrong"]), (True, []))
        self.assertEqual([node["node"] for node in answer["nodes"]], ["OPERATOR", "R00", "R01", "R02"])
        self.assertGreaterEqual(answer["agreed_s"], answer["landed_s"])
        self.assertEqual(answer["digests"]["nodes"]["OPERATOR"], self.summary["digest"])
        worst = max(answer["nodes"], key=lambda node: node["worst_window"]["share"])
        self.assertEqual(worst["node"], self.summary["worst_window"]["robot"])
        self.assertIn("kept in every window", run(CONSOLE, "verify", os.path.join(self.a, "mission.lcmlog")).stdout)

    def test_half_a_recording_is_not_whole(self):
        data = read(os.path.join(self.a, "mission.lcmlog"))
        half = os.path.join(self.top, "half.lcmlog")
        with open(half, "wb") as file:
            file.write(data[: len(data) // 3])
        out = os.path.join(self.top, "half")
        answer = json.loads(run(CONSOLE, "replay", half, "--out", out, "--json", expect=1).stdout)
        check_schema("replay", answer)
        self.assertFalse(answer["whole"])
        self.assertTrue(all(re.match(r"R0[012]: ", line) for line in answer["lacking"]), answer["lacking"])
        self.assertTrue(os.path.exists(os.path.join(out, "global_map.csv")))
        answer = json.loads(run(CONSOLE, "verify", half, "--json", expect=1).stdout)
        check_schema("verify", answer)
        self.assertFalse(answer["good"])

    def test_a_damaged_recording_is_read_as_far_as_it_goes(self):
        broken = os.path.join(self.top, "broken.lcmlog")
        data = bytearray(read(os.path.join(self.a, "mission.lcmlog")))
        for offset in range(5000, len(data), 20011):
            data[offset] ^= 0x55
        with open(broken, "wb") as file:
            file.write(data[: len(data) - 7])
        check_schema("status", ask("status", "--log", broken))
        run(CONSOLE, "status", "--log", os.path.join(self.a, "summary.json"), expect=1)

    def test_what_is_wrong_is_said_in_one_line(self):
        cases = [
            (2, ["launch", "--world", "no/such/folder", "--out", self.top + "/x"]),
            (2, ["launch", "--world", "lcm:CAM", "--out", self.top + "/x"]),
            (2, ["launch", "--world", "reef:tuning", "--depth-holes", "2", "--out", self.top + "/x"]),
            (2, ["launch", "--world", "reef:tuning", "--camera", "no/camera.json", "--out", self.top + "/x"]),
            (2, ["launch", "--world", "reef:nowhere", "--out", self.top + "/x"]),
            (2, ["launch", "--world", "reef:tuning", "--out", self.a]),  # holds a finished mission
            (2, ["launch", "--world", "reef:tuning", "--matcher", "nearest", "--out", self.top + "/x"]),
            (2, ["launch", "--world", "reef:tuning", "--profile", "finest", "--out", self.top + "/x"]),
            (2, ["launch", "--world", "reef:tuning", "--link", "string", "--out", self.top + "/x"]),
            (1, ["evaluate", "--run", self.top, "--world", "reef:tuning"]),
            (1, ["status", "--run", self.top]),
            (1, ["status", "--node", self.top]),
            (2, ["status"]),
            (1, ["replay", self.top + "/no.lcmlog", "--out", self.top + "/x"]),
            (2, ["replay", os.path.join(self.a, "mission.lcmlog")]),
            (2, ["replay", os.path.join(self.a, "mission.lcmlog"), "--out", self.a]),  # a finished mission
            (1, ["verify", os.path.join(self.a, "summary.json")]),
        ]
        for code, arguments in cases:
            done = run(CONSOLE, *arguments, expect=code)
            self.assertEqual(done.stdout, "", arguments)
            self.assertTrue(done.stderr.strip(), arguments)
        for command in ("labels", "status", "evaluate"):
            more = ["--world", "reef:tuning"] if command == "evaluate" else []
            with open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run([CONSOLE, command, "--run", self.a, "--json", *more], stdout=full, stderr=subprocess.PIPE,
                                      text=True, timeout=60, check=False)
            self.assertEqual(done.returncode, 1, command)
            self.assertIn("cannot write all of the answer", done.stderr)
        world = os.path.join(self.top, "world")
        os.makedirs(world)
        with open(os.path.join(world, "world.json"), "w", encoding="utf-8") as file:
            file.write('{"name": "broken",')
        self.assertIn("world.json", run(CONSOLE, "launch", "--world", world, "--out", self.top + "/x", expect=2).stderr)
        agent = os.path.join(BIN, "robot_agent")
        self.assertIn("R99", run(agent, "--robot", "R99", "--source", "reef:tuning", "--robots", "3", expect=2).stderr)
        self.assertIn("banana", run(agent, "--robot", "banana", "--source", "reef:tuning", expect=2).stderr)

    @unittest.skipUnless("SHOAL_DATA" in os.environ, "the labelled worlds are elsewhere")
    def test_a_real_world_flies_too(self):
        out = os.path.join(self.top, "dubai")
        world = os.path.join(os.environ["SHOAL_DATA"], "dubai_tile5")
        launch(out, "--single", world=world)
        with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        check_schema("summary", summary)
        self.assertEqual(summary["cell_size_m"], 24)
        self.assertGreater(summary["scores"]["scored"], 1000)
        again = [os.path.abspath(CONSOLE), "evaluate", "--run", out, "--matcher", "id", "--world"]
        self.assertEqual(run(*again, ".", cwd=world).stderr, "")  # the same folder by another name
        self.assertIn("was flown over " + world, run(*again, os.path.join(os.environ["SHOAL_DATA"], "dubai_tile4")).stderr)


@unittest.skipUnless("SHOAL_DATA" in os.environ, "the recordings are elsewhere")
class Recordings(unittest.TestCase):
    """RGB-D recordings fly again."""

    def setUp(self):
        self.top = tempfile.mkdtemp(prefix="shoal_recordings_")
        self.addCleanup(shutil.rmtree, self.top)
        self.a = os.path.join(self.top, "out")

    def fly(self, name, *more):
        world = os.path.join(os.environ["SHOAL_DATA"], name)
        done = run(CONSOLE, "launch", "--world", world, "--out", self.a, *more)
        with open(os.path.join(self.a, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        check_schema("summary", summary)
        return world, summary, done

    def test_a_team_flies_and_is_scored_by_its_labelled_frames(self):
        world, summary, _ = self.fly("uav_dubai_tile5", "--observations", "8", "--single")
        self.assertEqual(summary["robots"], ["R00", "R01", "R02", "R03"])
        self.assertEqual(summary["observations"], 8)
        self.assertTrue(summary["converged"])
        self.assertGreater(summary["scores"]["scored"], 0.9 * summary["cells"])
        self.assertGreater(summary["coverage"], 0.8)
        scores = ask("evaluate", "--run", self.a, "--world", world)
        check_schema("evaluate", scores)
        self.assertEqual(scores, summary["scores"])
        self.assertEqual(len(read(os.path.join(self.a, "single", "poses.txt")).splitlines()), 32)

    def test_an_unlabelled_recording_flies_without_scores(self):
        world, summary, done = self.fly("rgbd_redkitchen", "--observations", "10", "--robots", "1")
        self.assertEqual(summary["scores"], {})
        self.assertRegex(done.stdout, r"\Amap: \S+/global_map\.png; all on a page: \S+/summary\.html\n\Z")
        heights = {line.split(",")[2] for line in read(os.path.join(self.a, "global_map.csv")).decode().splitlines()[1:]}
        self.assertGreater(len(heights), 3, "cells are in three dimensions")
        self.assertIn("no labels", run(CONSOLE, "evaluate", "--run", self.a, "--world", world).stdout)

    def test_more_robots_than_were_recorded_are_refused(self):
        world = os.path.join(os.environ["SHOAL_DATA"], "uav_dubai_tile5")
        done = run(CONSOLE, "launch", "--world", world, "--robots", "5", "--out", self.a, expect=2)
        self.assertIn("recording of 4 robots", done.stderr)


class ByHand(unittest.TestCase):
    """Agents and a fusion node started by hand, as on several machines."""

    def setUp(self):
        self.top = tempfile.mkdtemp(prefix="shoal_hand_")
        self.started = []

    def tearDown(self):
        for process in self.started:
            if process.poll() is None:
                process.kill()
            process.wait()
        shutil.rmtree(self.top)

    def start(self, program, *arguments):
        log = open(os.path.join(self.top, f"log{len(self.started)}"), "w", encoding="utf-8")
        process = subprocess.Popen([os.path.join(BIN, program), *arguments], stdout=log, stderr=log)
        log.close()
        self.started.append(process)
        return process

    def wait_for(self, what, limit=120, step=0.2):
        deadline = time.monotonic() + limit
        while time.monotonic() < deadline:
            if what():
                return
            time.sleep(step)
        self.fail("waited in vain: " + "".join(read(p).decode() for p in glob.glob(self.top + "/log*")))

    def test_robots_that_fuse_and_the_operator_hold_one_map(self):
        url = ["--lcm-url", "udpm://239.255.76.67:7811?ttl=0", "--mission", "hand", "--rate", "max"]
        state, out = os.path.join(self.top, "state"), os.path.join(self.top, "out")
        node = self.start("fusion_node", *url, "--state", state, "--out", out)
        robots = []
        for r in range(3):
            fuse = ["--fuse", "--linger"] if r < 2 else ["--linger"]
            robots.append(self.start("robot_agent", "--robot", f"R0{r}", "--source", "reef:tuning", *SIZE, *url, "--out", out, *fuse))

        def settled():
            try:
                status = ask("status", "--node", state)
            except AssertionError:
                return False
            check_schema("status", status)
            names = [n["name"] for n in status["nodes"] if n["heard_whole"] and n["phase"] == "landed"]
            return names == ["R00", "R01", "R02"]

        self.wait_for(settled)
        labels = ask("labels", "--node", state)
        check_schema("labels", labels)
        for question in [("area", str(labels["labels"][0]["label"])), ("why", str(labels["labels"][0]["label"])),
                         ("node", "R00"), ("at", "100", "-100")]:
            check_schema(question[0], ask(*question, "--node", state))
        label, other = (row["label"] for row in labels["labels"][:2])
        for edit in [("name", str(label), "brain coral"), ("exclude", "R02"), ("link", str(label), str(other)), ("undo",),
                     ("undo", "OPERATOR/2")]:
            check_schema("edit", ask(*edit, "--node", state))
        events = ask("events", "--node", state)
        check_schema("events", events)
        kinds = [(e["kind"], e["node"]) for e in events["events"]]
        for r in range(3):
            self.assertIn(("joined", f"R0{r}"), kinds)
            self.assertIn(("landed", f"R0{r}"), kinds)
        self.assertEqual(kinds.count(("edit", "OPERATOR")), 5)
        scored = ask("score", "--world", "reef:tuning", "--node", state)
        check_schema("score", scored)
        self.assertGreater(scored["scored"], 100)
        edits = ask("edits", "--node", state)
        check_schema("edits", edits)
        self.assertEqual([e["standing"] for e in edits["edits"]], ["in force", "undone", "undone", "in force", "in force"])
        self.assertEqual({row["label"]: row["name"] for row in ask("labels", "--node", state)["labels"]}[label], "brain coral")
        exported = os.path.join(self.top, "live.csv")
        run(CONSOLE, "export", "--format", "csv", "--out", exported, "--node", state)

        def agreed():  # the robots that fuse have heard the last of each other and what was decided
            agreement = {n["name"]: n["agreement"] for n in ask("status", "--node", state)["nodes"]}
            return [agreement[name] for name in ("R00", "R01")] == ["same", "same"]

        self.wait_for(agreed)
        for process in robots:
            process.send_signal(signal.SIGTERM)
        for process in robots:
            self.assertEqual(process.wait(timeout=60), 0)
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(timeout=60), 0)
        for folder in (out, os.path.join(out, "robots", "R00"), os.path.join(out, "robots", "R01")):
            self.assertIn(f"{label},brain coral,".encode(), read(os.path.join(folder, "labels.csv")))
        of_operator = read(os.path.join(out, "global_map.csv"))
        self.assertGreater(len(of_operator), 1000)
        self.assertEqual(read(exported), of_operator)
        for r in range(2):
            self.assertEqual(read(os.path.join(out, "robots", f"R0{r}", "global_map.csv")), of_operator, r)
            self.assertEqual(read(os.path.join(out, "robots", f"R0{r}", "labels.csv")), read(os.path.join(out, "labels.csv")))

    def test_a_sharper_picture_is_asked_for_after_its_price(self):
        import struct
        import zlib
        world, side, state, url = os.path.join(self.top, "world"), 300, os.path.join(self.top, "state"), "udpm://239.255.76.67:7816?ttl=0"
        os.mkdir(world)
        rows, noise = b"", 1
        for _ in range(side):  # rough: such pictures take more bytes than are sent unasked
            row = bytearray()
            for _ in range(side):
                noise = (noise * 1664525 + 1013904223) % 2**32
                row += bytes([80 + (noise >> 24) // 3] * 3)
            rows += b"\0" + bytes(row)
        chunks = [(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
        with open(os.path.join(world, "world.png"), "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n")
            for kind, data in chunks:
                file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))
        with open(os.path.join(world, "world.json"), "w", encoding="utf-8") as file:
            json.dump({"name": "rough", "metres_per_pixel": 0.1, "size_px": [side, side], "image": "world.png"}, file)
        link = ["--lcm-url", url, "--rate", "max", "--budget", "2000"]
        self.start("fusion_node", *link, "--state", state)
        self.start("robot_agent", "--robot", "R00", "--robots", "1", "--source", world, "--observations", "6", "--linger", *link,
                   "--out", os.path.join(self.top, "out"), "--checkpoint", self.top)

        def pictures():
            try:
                status = ask("status", "--node", state)["nodes"]
                if not [n for n in status if n["name"] == "R00" and n["phase"] == "landed" and n["heard_whole"]]:
                    return []
                return [p for row in ask("labels", "--node", state)["labels"] for p in row["pictures"]]
            except AssertionError:
                return []

        self.wait_for(pictures)
        example = ("ask", "R00", "example", str(pictures()[0]["topic"]), "--node", state)
        price = ask(*example, "--dry-run")
        check_schema("ask", price)
        self.assertEqual(price["state"], "not sharp")
        self.assertGreater(price["seconds"], 0)
        self.assertEqual(ask(*example, "--dry-run")["state"], "not sharp", "asking for the price asks for nothing else")
        picture = os.path.join(self.top, "sharp.png")
        sharp = ask(*example, "--wait", "60", "--out", picture)
        check_schema("ask", sharp)
        self.assertEqual((sharp["state"], sharp["picture"]["sharpened"]), ("sharp", True))
        layers = [sum(len(layer) // 2 for layer in answer["picture"]["layers"]) for answer in (price, sharp)]
        self.assertGreater(layers[1], layers[0])
        self.assertLess(layers[1], price["bytes"]["answer"])
        self.assertEqual(read(picture)[:8], b"\x89PNG\r\n\x1a\n")
        self.assertIn("nothing to pay", run(CONSOLE, *example, "--dry-run").stdout)
        self.assertIn("held are those of topics", run(CONSOLE, "ask", "R00", "example", "9876", "--node", state, expect=1).stderr)
        self.assertIn("ask R03 example 7", run(CONSOLE, "ask", "R00", "picture", "7", "--node", state, expect=2).stderr)
        self.started[1].kill()  # what it has said on request is in its checkpoint: it comes back whole
        self.started[1].wait()
        self.start("robot_agent", "--robot", "R00", "--robots", "1", "--source", world, "--observations", "6", *link, "--start-s", "60",
                   "--out", os.path.join(self.top, "out"), "--checkpoint", self.top)
        self.assertEqual(self.started[-1].wait(timeout=60), 0)

    def test_spy_and_doctor_see_the_mission(self):
        url = "udpm://239.255.76.67:7814?ttl=0"
        silent = subprocess.run([CONSOLE, "spy", "--once", "--seconds", "0.3", "--lcm-url", url], capture_output=True, text=True,
                                timeout=60)
        self.assertEqual(silent.returncode, 1)
        self.assertIn("nothing was heard", silent.stdout)
        self.start("fusion_node", "--lcm-url", url)
        heard = ask("spy", "--once", "--lcm-url", url)
        check_schema("spy", heard)
        self.assertEqual([(n["node"], n["budget"]) for n in heard["nodes"]], [("OPERATOR", 2000)])
        decoded = ask("spy", "--once", "--lcm-url", url, "--channel", ".*_HEARTBEAT")
        check_schema("spy", decoded)
        self.assertEqual(decoded["channels"][0]["last"]["phase"], "node")
        found = ask("doctor", "--lcm-url", url, "--out", self.top)
        check_schema("doctor", found)
        states = {c["check"]: c["state"] for c in found["checks"]}
        self.assertEqual((states["multicast route"], states["loopback"], states["group"]), ("good", "good", "warning"))
        alone = subprocess.run(["unshare", "-rn", CONSOLE, "doctor"], capture_output=True, text=True, timeout=60)
        self.assertEqual(alone.returncode, 1)
        self.assertIn("type: sudo ip route add 224.0.0.0/4 dev lo", alone.stdout)

    def test_a_robot_leaves_when_it_was_heard_and_a_killed_node_remembers_it(self):
        url = ["--lcm-url", "udpm://239.255.76.67:7812?ttl=0", "--rate", "max", "--mission", "77"]
        state = os.path.join(self.top, "state")
        node = self.start("fusion_node", *url, "--state", state)
        robot = self.start("robot_agent", "--robot", "R00", "--source", "reef:tuning", "--observations", "3", *url)
        self.assertEqual(robot.wait(timeout=120), 0)
        label = ask("labels", "--node", state)["labels"][0]["label"]
        run(CONSOLE, "name", str(label), "sand", "--node", state)
        before = {q: ask(q, "--node", state) for q in ("labels", "events", "edits")}
        difference = ask("diff", "0", "1000", "--node", state)
        check_schema("diff", difference)
        self.assertEqual(difference["total"]["appeared"], sum(row["cells"] for row in before["labels"]["labels"]))
        node.kill()
        node.wait()
        with_file = ask("labels", "--log", os.path.join(state, "mission-77.sqlite"))  # nobody runs
        self.assertEqual([row["name"] for row in with_file["labels"]], [row["name"] for row in before["labels"]["labels"]])
        self.start("fusion_node", *url, "--state", state)
        self.wait_for(lambda: subprocess.run([CONSOLE, "status", "--node", state], capture_output=True, timeout=60).returncode == 0)
        for question, said in before.items():
            self.assertEqual(ask(question, "--node", state), said, question)
        self.assertEqual(ask("diff", "0", "1000", "--node", state), difference)

    def test_a_robot_that_is_killed_again_and_again_loses_nothing_that_it_told(self):
        def fly(folder, port, kills):
            state, moment = os.path.join(folder, "state"), random.Random(20)
            url = ["--lcm-url", f"udpm://239.255.76.67:{port}?ttl=0", "--rate", "max", "--mission", "78"]

            def robot(name):
                return self.start("robot_agent", "--robot", name, "--robots", "2", "--source", "reef:tuning", "--observations",
                                  "30", *url, "--checkpoint", os.path.join(folder, "checkpoints"), "--linger")

            def await_work(process, seconds):  # of CPU, so that moments are alike on a busy machine
                until, worked = time.monotonic() + 3, 0.0
                while worked < seconds and time.monotonic() < until:
                    time.sleep(0.01)
                    fields = read(f"/proc/{process.pid}/stat").decode().rpartition(")")[2].split()
                    worked = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

            def status():
                done = subprocess.run([CONSOLE, "status", "--node", state, "--json"], capture_output=True, text=True, timeout=60)
                return json.loads(done.stdout) if done.returncode == 0 else {"nodes": []}

            def is_over():
                robots = [n for n in status()["nodes"] if n["phase"] == "landed" and n["heard_whole"]]
                return len(robots) == 2

            node, other, victim = self.start("fusion_node", *url, "--state", state), robot("R01"), robot("R00")
            checkpoint, started = os.path.join(folder, "checkpoints", "R00.checkpoint"), time.time()
            plan, late = ["start", "checkpoint"] * 5, ["checkpoint", "landed"] * 3
            moment.shuffle(plan)
            moment.shuffle(late)
            plan = ["start"] * 8 + plan + late
            for _ in range(kills):
                at, log = plan.pop(0), os.path.join(self.top, f"log{len(self.started) - 1}")
                if at == "start":
                    await_work(victim, 0.3 * moment.random())
                elif at == "checkpoint":  # of this life
                    self.wait_for(lambda: os.path.exists(checkpoint) and os.path.getmtime(checkpoint) > started, step=0.01)
                else:
                    self.wait_for(lambda: b"landed after 30 observations" in read(log), step=0.01)
                time.sleep(0.1 * moment.random())
                self.assertIsNone(victim.poll(), "it ended by itself")
                victim.kill()
                victim.wait()
                started = time.time()
                victim = robot("R00")
            self.wait_for(is_over)
            said = status()
            for process in (node, other, victim):
                process.send_signal(signal.SIGINT)
                self.assertEqual(process.wait(timeout=60), 0)
            return said

        calm = fly(os.path.join(self.top, "calm"), 7815, 0)
        before = len(self.started)
        shot = fly(os.path.join(self.top, "shot"), 7816, 24)
        self.assertEqual(shot["digest"], calm["digest"])
        self.assertEqual(shot["mixed"], [])
        self.assertEqual([(n["name"], n["conflicts"]) for n in shot["nodes"]], [(n["name"], 0) for n in calm["nodes"]])
        logs = [read(os.path.join(self.top, f"log{i}")).decode() for i in range(before, len(self.started))]
        lives = [re.findall(r"goes on from a checkpoint after (\d+) observations", log) for log in logs]
        self.assertGreater(sum(bool(life) for life in lives), 8)
        self.assertTrue({"25", "30"} & {life[0] for life in lives if life}, lives)
        self.assertFalse([log for log in logs if re.search(r"epoch \d+ begins", log)], "it began anew")

    def test_another_mission_on_the_url_is_refused(self):
        url = "udpm://239.255.76.67:7813?ttl=0"
        self.start("fusion_node", "--lcm-url", url, "--mission", "theirs", "--node", "OTHER", "--rate", "1")
        time.sleep(1)
        done = run(CONSOLE, "launch", "--world", "reef:tuning", *SIZE, "--lcm-url", url, "--out", self.top + "/x", expect=1)
        self.assertRegex(done.stderr, r"another mission \(\d+\) is heard")

    def test_only_who_has_the_key_is_listened_to(self):
        import socket
        keys = [os.path.join(self.top, name) for name in ("team.key", "other.key")]
        for key in keys:
            said = run(CONSOLE, "keygen", key).stdout
            self.assertNotIn(read(key).decode().split()[1], said)
            self.assertEqual(os.stat(key).st_mode & 0o777, 0o600)
        self.assertIn("never overwritten", run(CONSOLE, "keygen", keys[0], expect=2).stderr)
        url = ["--lcm-url", "udpm://239.255.76.67:7815?ttl=0", "--rate", "max", "--mission", "secret"]
        states = [os.path.join(self.top, name) for name in ("with", "without")]
        log = os.path.join(self.top, "sealed.lcmlog")
        ears = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        ears.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        ears.bind(("", 7815))
        ears.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton("239.255.76.67") + bytes(4))
        ears.setblocking(False)
        recorder = subprocess.Popen(["lcm-logger", "--lcm-url=" + url[1] + "&recv_buf_size=2097152", log],
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(recorder.kill)
        self.wait_for(lambda: os.path.exists(log))
        node = self.start("fusion_node", *url, "--state", states[0], "--key", keys[0])
        outsider = self.start("fusion_node", *url, "--state", states[1], "--node", "SHORE")
        self.wait_for(lambda: all(os.path.exists(state + "/node.sock") for state in states))
        flight = ["--source", "reef:tuning", "--robots", "3", "--observations", "3"]
        robots = [self.start("robot_agent", "--robot", f"R0{r}", *flight, *url, *more)
                  for r, more in enumerate([["--key", keys[0], "--linger"], ["--linger"], ["--key", keys[1], "--linger"]])]

        def heard(state):
            status = ask("status", "--node", state)
            check_schema("status", status)
            return ([n["name"] for n in status["nodes"] if n["phase"] == "landed" and n["heard_whole"]],
                    {s["name"]: s["has"] for s in status["strangers"]})

        self.wait_for(lambda: heard(states[0]) == (["R00"], {"R01": "no key", "R02": "other key", "SHORE": "no key"}))
        self.wait_for(lambda: heard(states[1]) == (["R01"], {"R00": "a key", "R02": "a key", "OPERATOR": "a key"}))
        self.assertRegex(run(CONSOLE, "status", "--node", states[0]).stdout, r"R01 +stranger has no key: \d+ messages")
        # All that was said, said again by somebody else, byte for byte.
        again = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        again.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        for _ in range(20):
            try:
                again.sendto(ears.recv(2000), ("239.255.76.67", 7815))
            except BlockingIOError:
                break
        time.sleep(0.5)
        for process in [*robots, node, outsider, recorder]:
            process.send_signal(signal.SIGINT)
            code = process.wait(timeout=60)
            self.assertTrue(code == 0 or process is recorder, code)
        self.assertRegex(read(os.path.join(self.top, "log0")).decode(), r"[1-9]\d* replayed")
        for path in glob.glob(self.top + "/log*"):
            for key in keys:
                self.assertNotIn(read(key).split()[1], read(path))
        checked = ask("verify", log, "--key", keys[0])
        check_schema("verify", checked)
        self.assertEqual((checked["seals"]["checked"], [n["node"] for n in checked["nodes"]]), (True, ["OPERATOR", "R00"]))
        self.assertGreater(checked["seals"]["refused"], 0)
        self.assertTrue(checked["budget_kept"], checked)
        unchecked = json.loads(subprocess.run([CONSOLE, "verify", log, "--json"], capture_output=True, text=True).stdout)
        self.assertEqual((unchecked["seals"]["checked"], unchecked["seals"]["refused"]), (False, 0))
        self.assertIn("R02", [n["node"] for n in unchecked["nodes"]])

    def test_rubbish_on_the_bus_is_counted_and_hurts_nobody(self):
        import socket
        url = ["--lcm-url", "udpm://239.255.76.67:7814?ttl=0", "--rate", "max"]
        state = os.path.join(self.top, "state")
        node = self.start("fusion_node", *url, "--state", state)
        self.wait_for(lambda: os.path.exists(state + "/node.sock"))
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        for i in range(200):
            body = bytes((i * 7 + k * 31) % 256 for k in range(i))
            packet = b"LC02" + i.to_bytes(4, "big") + b"SHOAL_R00_TOPICS\0" + body
            sock.sendto(packet, ("239.255.76.67", 7814))
        robot = self.start("robot_agent", "--robot", "R00", "--source", "reef:tuning", "--observations", "2", *url)
        self.assertEqual(robot.wait(timeout=120), 0)
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(timeout=30), 0)
        self.assertRegex(read(os.path.join(self.top, "log0")).decode(), r"refused \d+ messages: too short")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
