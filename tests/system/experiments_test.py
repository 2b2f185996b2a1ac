#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The experiments of the console: reproduce, tune, evaluate --explain.

Usage: experiments_test.py BIN_DIR DOCS_DIR [unittest arguments], inside a network namespace of its own.
"""
import csv
import json
import os
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
TEAM = ["--robots", "3", "--observations", "6"]


def run(*arguments, expect=0, timeout=240):
    done = subprocess.run([CONSOLE, *arguments], capture_output=True, text=True, timeout=timeout)
    if done.returncode != expect:
        raise AssertionError(f"{' '.join(arguments)}: exit {done.returncode}, not {expect}\n{done.stdout}\n{done.stderr}")
    return done


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def check_schema(name, value):
    jsonschema.validate(value, load(os.path.join(DOCS, "schemas", name + ".schema.json")))


class Experiments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.top = tempfile.mkdtemp(prefix="shoal_experiments_")
        cls.out = os.path.join(cls.top, "reproduction")
        cls.command = ["reproduce", "--world", "reef:tuning", *TEAM, "--repeats", "3", "--shares", "2,3", "--share-repeats",
                       "2", "--exchange-every", "3", "--seed", "7", "--out", cls.out, "--json"]
        cls.summary = json.loads(run(*cls.command).stdout)
        cls.flown = os.path.join(cls.top, "flown")
        run("launch", "--world", "reef:tuning", *TEAM, "--seed", "7", "--single", "--rate", "max", "--profile", "paper",
            "--out", cls.flown)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.top)

    def test_the_first_repeat_scores_as_the_launched_mission_does(self):
        flown = load(os.path.join(self.flown, "summary.json"))["scores"]
        first = load(os.path.join(self.out, "repeats", "reef_tuning-000.json"))["repeat"]
        with open(os.path.join(self.out, "table.csv"), encoding="utf-8") as file:
            names = [row["matcher"] for row in csv.DictReader(file)]
        scores = dict(zip(names, first["newest"]))
        for name, matcher in (("ID", "id"), ("Hungarian, l2", "hungarian"), ("CLEAR, cosine 0.75", "clear"), ("Shoal 0.25", "shoal")):
            self.assertAlmostEqual(scores[name]["ami"], flown["matchers"][matcher]["ami"], 6, name)
            self.assertEqual(scores[name]["labels"], flown["matchers"][matcher]["labels"], name)
        both = dict(zip(names, first["concatenated"]))
        self.assertAlmostEqual(both["CLEAR, cosine 0.75"]["ami"], flown["matchers"]["clear"]["ami_concatenated"], 6)
        self.assertAlmostEqual(first["single"]["ami"], flown["single"]["ami"], 6)
        self.assertEqual(first["newest"][0]["cells"], flown["cells"])

    def test_the_summary_and_the_tables_hold_what_the_repeats_found(self):
        check_schema("reproduce", self.summary)
        self.assertEqual(self.summary, load(os.path.join(self.out, "summary.json")))
        repeats = [load(os.path.join(self.out, "repeats", f"reef_tuning-00{r}.json"))["repeat"] for r in range(3)]
        row = next(r for r in self.summary["worlds"][0]["rows"] if r["matcher"] == "CLEAR, cosine 0.75")
        clear = [r["matcher"] for r in self.summary["worlds"][0]["rows"]].index("CLEAR, cosine 0.75")
        ami = [r["newest"][clear]["ami"] for r in repeats]
        mean = sum(ami) / 3
        self.assertAlmostEqual(row["ami"]["mean"], mean, 5)
        self.assertAlmostEqual(row["ami"]["deviation"], (sum((a - mean) ** 2 for a in ami) / 2) ** 0.5, 5)
        self.assertAlmostEqual(row["ari"]["mean"], sum(r["matches"][clear]["ari"] for r in repeats) / 3, 5)
        self.assertAlmostEqual(row["f1"]["mean"], sum(r["matches"][clear]["f1"] for r in repeats) / 3, 5)
        for name, columns in (("by_robots", "robots"), ("by_images", "images"), ("by_shares", "shares")):
            with open(os.path.join(self.out, name + ".csv"), encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            self.assertGreater(len(rows), 5, name)
            self.assertIn(columns, rows[0])
        with open(os.path.join(self.out, "report.html"), encoding="utf-8") as file:
            page = file.read()
        self.assertEqual(page.count("<svg"), 3)
        self.assertGreaterEqual(page.count("data:image/png;base64,"), 3)
        self.assertNotRegex(page, r"(src|href)=\"https?:")  # opens without a network

    def test_what_is_finished_is_not_done_again(self):
        kept = os.path.join(self.out, "repeats", "reef_tuning-001.json")
        marked = load(kept)
        marked["repeat"]["seconds"] = 12345.5
        with open(kept, "w", encoding="utf-8") as file:
            json.dump(marked, file)
        os.remove(os.path.join(self.out, "repeats", "reef_tuning-002.json"))
        again = json.loads(run(*self.command).stdout)
        self.assertEqual(load(kept)["repeat"]["seconds"], 12345.5)
        for world in (again["worlds"][0], self.summary["worlds"][0]):
            world.pop("seconds", None)
        self.assertEqual(again["worlds"], self.summary["worlds"])

    def test_an_interrupted_run_goes_on(self):
        out = os.path.join(self.top, "interrupted")
        command = [CONSOLE, "reproduce", "--world", "reef:tuning", *TEAM, "--repeats", "40", "--share-repeats", "0", "--out", out]
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        deadline = time.time() + 60
        while time.time() < deadline and not os.path.exists(os.path.join(out, "repeats", "reef_tuning-001.json")):
            time.sleep(0.05)
        child.send_signal(signal.SIGINT)
        _, errors = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 1, errors)
        self.assertIn("goes on from there", errors)
        self.assertGreater(len(os.listdir(os.path.join(out, "repeats"))), 0)

    def test_tune_finds_a_setting_and_goes_on_from_what_was_tried(self):
        out = os.path.join(self.top, "tuned")
        command = ["tune", "--robots", "2", "--observations", "6", "--seeds", "2", "--random", "4", "--out", out, "--json"]
        first = json.loads(run(*command, "--trials", "5").stdout)
        trials = load(os.path.join(out, "trials.json"))["trials"]
        self.assertEqual(len(trials), 5)
        self.assertIn(first["ami"], [t["ami"] for t in trials])
        for t in trials:
            self.assertAlmostEqual(t["ami"], sum(t["by_seed"]) / 2, 12)
        more = json.loads(run(*command, "--trials", "7").stdout)
        after = load(os.path.join(out, "trials.json"))["trials"]
        self.assertEqual(after[:5], trials)
        self.assertEqual(more["trials"], 7)
        self.assertRegex(run("tune", "--knobs", "delta", "--out", out, expect=2).stderr, "known are alpha, beta")

    def test_evaluate_explains(self):
        command = ["evaluate", "--run", self.flown, "--world", "reef:tuning", "--explain"]
        scores = json.loads(run(*command, "--json").stdout)
        check_schema("evaluate", scores)
        e = scores["explanation"]
        self.assertEqual(len(e["robots"]), 3)
        self.assertEqual(sum(r["cells"] for r in e["robots"]), scores["cells"])
        self.assertEqual(sum(label["cells"] for label in e["labels"]), scores["cells"])
        # Every scored cell is right by its label's majority, or in one of the confusions.
        wrong = sum(c["cells"] for c in e["confusions"])
        self.assertAlmostEqual(e["label_purity"], 1 - wrong / scores["scored"], 5)
        self.assertGreaterEqual(e["topic_purity"] + 1e-9, e["label_purity"])
        text = run(*command).stdout
        self.assertRegex(text, r"oracle.*AMI \d\.\d{3}")
        self.assertTrue(all(len(line) <= 100 for line in text.splitlines()), text)

    def test_what_is_wrong_is_said_in_one_line(self):
        for arguments, message in (
            (["reproduce", "--world", "reef:tuning"], "--out is missing"),
            (["reproduce", "--world", "reef:nowhere", "--out", self.top + "/x"], "reef:sparse"),
            (["reproduce", "--repeats", "0", "--out", self.top + "/x"], "--repeats must lie in 1"),
            (["tune"], "--out is missing"),
        ):
            errors = run(*arguments, expect=2).stderr
            self.assertIn(message, errors)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[3:]])
