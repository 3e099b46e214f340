#!/usr/bin/env python3
"""choice_table.py BATTEN [--corpus DIR] [--targets a,b,..] [--tolerance 0.01] [--jobs 2]
                   [--half first|second] [--only TEXT] [--option WORD]... [--runs]

What `smooth` makes of every program of the corpus beside the checkout (or BATTEN_CORPUS), for each
target and each of the three preferences: time, blocks, bytes, rms distance from the path that was
meant and roughness, each in per cent of what the program has. A mark where a preference is worse than
another one in its own figure, and where a result is worse than it may be (docs/algorithms/choice.md):

  slower   than the program, by more than a control's period in each run
  larger   in blocks or bytes without being a percent faster or half as far off
  t, n, s  time is slower, accuracy farther, size larger than another preference

At the end the sums of each target, and how many of the blocks in runs of chords that are finer than the
tolerance (at all but a tenth of the vertices) are in runs where a figure is clearly better (time -1 %,
blocks -10 %, distance or roughness -50 %) and none is worse, the time by more than a control's period
and a thousandth; what remains by reason. `--half`: programs whose names hash to an even or an odd
number, so that one half stays apart.
"""

import argparse
import collections
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "corpus"))
from programs import bytes_of, programs_in

PREFERENCES = ["time", "accuracy", "size"]
COARSE = 0.1  # of its vertices, of a run that is not of fine chords any more
SAME = 1.002  # times and sizes below this ratio are the same
NEAR = 0.03   # of the tolerance: distances below it are the same


def read_options():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    beside = os.environ.get("BATTEN_CORPUS", HERE.parent.parent / ".." / "shared" / "corpus")
    parser.add_argument("batten", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--corpus", type=pathlib.Path, default=beside)
    parser.add_argument("--targets", type=lambda text: text.split(","), default=["linuxcnc", "grbl", "fanuc", "siemens"])
    parser.add_argument("--tolerance", type=float, default=0.01)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--half", choices=["first", "second"])
    parser.add_argument("--only", default="")
    parser.add_argument("--option", action="append", default=[], metavar="WORD")
    parser.add_argument("--runs", action="store_true", help="of each program, too, why its blocks of fine chords are not clearly better")
    return parser.parse_args()


def half_of(name):
    return "first" if hashlib.sha256(name.encode()).digest()[0] % 2 == 0 else "second"


def smooth(options, file, target, prefer):
    with tempfile.TemporaryDirectory(prefix="batten-choice-") as folder:
        suffix = pathlib.Path(file.stem if file.suffix == ".gz" else file.name).suffix or ".nc"
        source = pathlib.Path(folder, "old" + suffix)
        source.write_bytes(bytes_of(file))
        report = pathlib.Path(folder, "report.json")
        subprocess.run(
            [options.batten, "smooth", source, "-o", source.with_name("new.nc"), "--target", target,
             "--tolerance", str(options.tolerance), "--prefer", prefer, "--threads", "1",
             "--progress", "off", "--json", report, *options.option],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return json.loads(report.read_text()) if report.exists() else None


def seconds_of_runs(report, when):
    return sum(run[f"time_{when}_s"] for run in report["runs"])


def figures(report):
    """Before and after, of what is cut in runs; bytes and blocks of the program."""
    before = {"time": seconds_of_runs(report, "before"), "blocks": report["input"]["blocks"],
              "bytes": report["input"]["bytes"], "distance": report["path_before"]["distance_mm"],
              "roughness": report["path_before"]["roughness"]}
    after = {"time": seconds_of_runs(report, "after"), "blocks": report["output"]["blocks"],
             "bytes": report["output"]["bytes"], "distance": report["path_after"]["distance_mm"],
             "roughness": report["path_after"]["roughness"]}
    return before, after


@functools.lru_cache
def period_of(batten, machine):
    """Seconds that nobody measures on a machine: the longer one of the two periods of its control."""
    shown = subprocess.run([batten, "machines", "--show", machine], check=True, capture_output=True, text=True).stdout
    return max(float(period) for period in re.findall(r"^(?:block|servo)-period = ([0-9.]+)", shown, re.MULTILINE))


def is_fine(run):
    return run["path_before"]["length_mm"] > 0 and run["coarse_part"] < COARSE


def what_is_worse(run, near, period):
    """The figures of a rewritten run that are worse, or what else keeps it from being clearly better."""
    before, after = run["path_before"], run["path_after"]
    time = run["time_after_s"] / run["time_before_s"] if run["time_before_s"] > 0 else 1
    blocks = run["blocks_out"] / run["blocks_in"]
    distance = max(after["distance_mm"], near) / max(before["distance_mm"], near)
    roughness = max(after["roughness"], 1e-3) / max(before["roughness"], 1e-3)
    longer = run["time_after_s"] - run["time_before_s"] > max(period, 0.001 * run["time_before_s"])
    worse = [name for name, is_worse in [("slower", longer), ("more blocks", blocks > 1),
                                         ("farther", distance > 1), ("rougher", roughness > 1.05)] if is_worse]
    better = time <= 0.99 or blocks <= 0.9 or distance <= 0.5 or roughness <= 0.5
    return worse or ([] if better else ["better in nothing"])


def marks_of(prefer, of, near, runs, period):
    before, after = of[prefer]
    marks = []
    if after["time"] > before["time"] + max(period * runs, 5e-4 * before["time"]):
        marks.append("slower")
    larger = after["blocks"] > before["blocks"] or after["bytes"] > before["bytes"] + 120
    faster = after["time"] <= 0.99 * before["time"]
    if larger and not faster and after["distance"] > max(0.5 * before["distance"], near):
        marks.append("larger")
    for name, key, floor in [("time", "time", 0), ("accuracy", "distance", near), ("size", "blocks", 0)]:
        least = min(max(result[1][key], floor) for result in of.values())
        if prefer == name and max(after[key], floor) > SAME * least:
            marks.append({"time": "t", "accuracy": "n", "size": "s"}[name])
    return marks


def percent(after, before):
    return f"{100 * after / before:6.1f}" if before > 0 else "     -"


def main():
    options = read_options()
    near = NEAR * options.tolerance
    files = [file for file in programs_in(options.corpus)
             if options.only in str(file) and (not options.half or half_of(file.name) == options.half)]
    asked = [(file, target, prefer) for target in options.targets for file in files for prefer in PREFERENCES]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        reports = dict(zip(asked, pool.map(lambda each: smooth(options, *each), asked)))
    print(f"{'program':44} {'for':8} {'prefers':8} {'time':>6} {'blocks':>6} {'bytes':>6} {'dist.':>6} {'rough':>6}")
    for target in options.targets:
        sums = collections.defaultdict(lambda: [0.0, 0.0])
        squares = collections.defaultdict(lambda: [0.0, 0.0, 0.0])
        shares = collections.Counter()
        kept = {prefer: collections.Counter() for prefer in PREFERENCES}
        for file in files:
            of = {}
            for prefer in PREFERENCES:
                report = reports[file, target, prefer]
                if report and report["runs"]:
                    of[prefer] = figures(report)
            if not of:
                print(f"{file.name[:44]:44} {target:8} nothing")
                continue
            for prefer, (before, after) in of.items():
                report = reports[file, target, prefer]
                period = period_of(options.batten, report["machine"]["name"])
                marks = marks_of(prefer, of, near, len(report["runs"]), period)
                print(f"{file.name[:44]:44} {target:8} {prefer:8}",
                      *(percent(after[key], before[key]) for key in before), *marks)
                for key in before:
                    sums[prefer, key][0] += before[key]
                    sums[prefer, key][1] += after[key]
                length = report["path_before"]["length_mm"]
                for i, each in enumerate((before, after)):
                    squares[prefer][i] += each["distance"] ** 2 * length
                squares[prefer][2] += length
                not_better = collections.Counter()
                for run in report["runs"]:
                    if not is_fine(run):
                        continue
                    shares[prefer, "all"] += run["blocks_in"]
                    rewritten = run["status"] == "rewritten"
                    against = what_is_worse(run, near, period) if rewritten else ["kept, " + run["reason"]]
                    if against:
                        not_better[" and ".join(against)] += run["blocks_in"]
                    else:
                        shares[prefer, "better"] += run["blocks_in"]
                kept[prefer] += not_better
                if options.runs:
                    for reason, count in not_better.most_common():
                        print(f"{'':44} {'':8} {prefer:8} {count:7} blocks of fine chords: {reason}")
        for prefer in PREFERENCES:
            print(f"{'all':44} {target:8} {prefer:8}",
                  *(percent(sums[prefer, key][1], sums[prefer, key][0]) for key in ["time", "blocks", "bytes"]),
                  percent(squares[prefer][1] ** 0.5, squares[prefer][0] ** 0.5),
                  f" clearly better: {100 * shares[prefer, 'better'] / max(1, shares[prefer, 'all']):.0f} % of "
                  f"{shares[prefer, 'all']} blocks of fine chords;",
                  ", ".join(f"{reason} {count}" for reason, count in kept[prefer].most_common(6)))


if __name__ == "__main__":
    main()
