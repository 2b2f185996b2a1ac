# SPDX-License-Identifier: BSD-3-Clause
"""What the operator's map is worth at landing time, against the budget: docs/benchmarks.md.

    tests/support/in_namespace.sh python3 tests/system/budget_benchmark.py build/bin SCRATCH [WORLD ...]

SHOAL_BUDGETS="50 200" in the environment: only these.

Flies a small team over each world under each budget and records the link. The map at a time is that of all
messages up to then: scored as `operator_console score` does. Prints a table in Markdown."""
import json
import os
import shutil
import struct
import subprocess
import sys

BUDGETS = tuple(int(b) for b in os.environ.get("SHOAL_BUDGETS", "50 200 1000 5000 0").split())
ROBOTS, OBSERVATIONS, SEED = 6, 40, 1
EVENT = struct.Struct(">IqqII")


def cut(log, until_us, out):
    """Copies the messages that were sent up to a mission time."""
    with open(log, "rb") as file, open(out, "wb") as kept:
        while len(front := file.read(EVENT.size)) == EVENT.size:
            _, _, _, channel_bytes, data_bytes = EVENT.unpack(front)
            channel, data = file.read(channel_bytes), file.read(data_bytes)
            if channel.startswith(b"SHOAL_") and struct.unpack(">q", data[8:16])[0] <= until_us:
                kept.write(front + channel + data)


def ask(console, *words):
    done = subprocess.run([console, *words, "--json"], capture_output=True, text=True, check=False)
    if done.returncode > 1 or not done.stdout:
        raise RuntimeError(f"{words}: {done.stderr}")
    return json.loads(done.stdout)


def fly(console, scratch, world, budget):
    out = os.path.join(scratch, f"{world.split(':')[-1]}-{budget}")
    shutil.rmtree(out, ignore_errors=True)
    flown = subprocess.run(
        [console, "launch", "--world", world, "--robots", str(ROBOTS), "--observations", str(OBSERVATIONS),
         "--budget", str(budget), "--seed", str(SEED), "--record", "--out", out],
        capture_output=True, text=True, check=False)
    if flown.returncode != 0:
        print(flown.stdout + flown.stderr, file=sys.stderr)
    return os.path.join(out, "mission.lcmlog")


def row(console, scratch, world, budget):
    log = fly(console, scratch, world, budget)
    told = ask(console, "verify", log)

    def ami(until_s):
        part = os.path.join(scratch, "part.lcmlog")
        cut(log, round(until_s * 1e6), part)
        return ask(console, "score", "--world", world, "--log", part, "--seed", str(SEED), "--robots",
                   str(ROBOTS), "--observations", str(OBSERVATIONS))

    landed, agreed = float(OBSERVATIONS), told["agreed_s"]
    scores = [ami(landed * share) for share in (0.5, 1, 2, 4)] + [ami(1e9)]
    sent = sum(node["bytes"] for node in told["nodes"] if node["node"].startswith("R"))
    after = "never" if agreed is None else f"{agreed - landed:.0f}"
    return [world, str(budget) if budget else "unlimited", *(f"{s['ami']:.3f}" for s in scores),
            f"{100 * scores[1]['scored'] / max(scores[4]['scored'], 1):.0f}", after, f"{sent / ROBOTS / 1000:.1f}",
            "yes" if told["budget_kept"] else "NO"]


def main():
    console, scratch = os.path.join(sys.argv[1], "operator_console"), sys.argv[2]
    os.makedirs(scratch, exist_ok=True)
    print("| world | budget B/s | AMI at 20 s | at 40 s, landing | at 80 s | at 160 s | in the end | cells at landing % "
          "| complete after s | kB a robot | kept |")
    print("|" + "---|" * 11)
    for world in sys.argv[3:] or ["reef:sparse", "reef:varied"]:
        for budget in BUDGETS:
            print("| " + " | ".join(row(console, scratch, world, budget)) + " |", flush=True)


if __name__ == "__main__":
    main()
