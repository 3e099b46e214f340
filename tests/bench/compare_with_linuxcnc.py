#!/usr/bin/env python3
"""compare_with_linuxcnc.py BENCH --driver PATH [--measure] [--feeds 6000,15000]
                            [--vmax 400] [--amax 4000] [FILE...]

Predicted against measured cutting times, as a Markdown table: seconds predicted / measured
and the difference in per cent, one row per program and feed.

BENCH is the folder of the LinuxCNC bench: results.tsv, samples/, lcnc_time.sh. Without
--measure, the measured times are those of results.tsv for BENCH/samples (400 mm/s,
4000 mm/s2). With --measure, every FILE runs on LinuxCNC now, two at a time.
--driver is the program built from tests/bench/cycle_time_of.cpp.

Exit status 1 when a difference is above --limit per cent (default 5); 77 when the bench or
LinuxCNC is not there, so that a test can skip."""
import argparse
import csv
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

MODES = ["G61", "G64", "G64 P0.01 Q0", "G64 P0.01", "G64 P0.05"]
SKIP = 77


def predicted(args, file, feed):
    """Seconds by mode; nothing for programs that the driver does not understand."""
    r = subprocess.run([args.driver, file, "--feed", feed, "--vmax", str(args.vmax),
                        "--amax", str(args.amax)], capture_output=True, text=True)
    if r.returncode:
        return {}
    return {m: float(t) for m, t in (line.split("\t") for line in r.stdout.splitlines())}


def measured_now(args, file, feed, mode):
    text = open(file).read()
    text = re.sub(r"(?m)^G64.*$", mode, text, count=1)
    text = re.sub(r"(?m)^F[0-9.]+$", "F" + feed, text, count=1)
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "program.ngc")
        with open(program, "w") as f:
            f.write(text)
        r = subprocess.run([os.path.join(args.bench, "lcnc_time.sh"), program, "--json",
                            "--vmax", str(args.vmax), "--amax", str(args.amax)],
                           capture_output=True, text=True)
    answer = json.loads(r.stdout)
    if answer.get("errors"):
        sys.exit("%s %s: %s" % (file, mode, answer["errors"]))
    return answer["feed_s"]


def measured_before(args):
    with open(os.path.join(args.bench, "results.tsv")) as f:
        return {(r["name"], r["feed"], r["mode"]): float(r["feed_s"])
                for r in csv.DictReader(f, delimiter="\t")}


def main():
    p = argparse.ArgumentParser(description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("bench")
    p.add_argument("files", nargs="*")
    p.add_argument("--driver", required=True)
    p.add_argument("--measure", action="store_true")
    p.add_argument("--feeds", default="6000,15000")
    p.add_argument("--vmax", type=float, default=400)
    p.add_argument("--amax", type=float, default=4000)
    p.add_argument("--limit", type=float, default=5)
    args = p.parse_intermixed_args()
    if not os.path.isfile(os.path.join(args.bench, "results.tsv")):
        print("no bench at", args.bench, file=sys.stderr)
        return SKIP
    if args.measure and not shutil.which("linuxcncsvr"):
        print("LinuxCNC is not installed", file=sys.stderr)
        return SKIP

    files = args.files or sorted(glob.glob(os.path.join(args.bench, "samples", "*.ngc")))
    rows = [(file, feed) for file in files for feed in args.feeds.split(",")]
    rows = [(file, feed, predicted(args, file, feed)) for file, feed in rows]
    left_out = sorted({os.path.basename(file) for file, _, times in rows if not times})
    rows = [row for row in rows if row[2]]
    if args.measure:
        jobs = [(file, feed, mode) for file, feed, _ in rows for mode in MODES]
        with ThreadPoolExecutor(2) as pool:
            seconds = list(pool.map(lambda job: measured_now(args, *job), jobs))
        measured = dict(zip(jobs, seconds))
    else:
        known = measured_before(args)
        measured = {(file, feed, mode): known.get((os.path.basename(file)[:-4], feed, mode))
                    for file, feed, _ in rows for mode in MODES}

    print("| program | F | " + " | ".join(MODES) + " |")
    print("|---" * (2 + len(MODES)) + "|")
    differences = []
    for file, feed, times in rows:
        cells = []
        for mode in MODES:
            real = measured[file, feed, mode]
            if real is None:
                cells.append("-")
                continue
            difference = 100 * (times[mode] / real - 1)
            differences.append(abs(difference))
            cells.append("%.3f / %.3f %+.1f" % (times[mode], real, difference))
        print("| %s | %s | %s |" % (os.path.basename(file)[:-4], feed, " | ".join(cells)))
    if not differences:
        print("nothing to compare", file=sys.stderr)
        return SKIP
    differences.sort()
    print("\n%d times: greatest difference %.1f %%, median %.2f %%, above %g %%: %d" % (
        len(differences), differences[-1], differences[len(differences) // 2], args.limit,
        sum(d > args.limit for d in differences)))
    if left_out:
        print("Left out (splines):", ", ".join(left_out))
    return 1 if differences[-1] > args.limit else 0


if __name__ == "__main__":
    sys.exit(main())
