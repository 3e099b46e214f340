#!/usr/bin/env python3
"""corpus_speed.py BATTEN [--against OLD] [--corpus DIR] [--rounds 3] [--target linuxcnc]
                   [--tolerance 0.01] [--only TEXT] [--option WORD]... [--save FILE] [--saved FILE]

How fast `smooth` is on every program of the corpus beside the checkout (or BATTEN_CORPUS), on one
thread: lines/s by processor time, the least of so many rounds; the slowest ten; and all together.

--against another binary, run by turns on the same program: also its lines/s, and what the two make
of the programs: time, blocks, rms distance from the path that was meant and roughness of the new
one in parts of the old one's. The last lines are the sums, and each program in which one of the
four is more than 2 % worse. --save keeps what BATTEN did in a file, which --saved takes in place of
OLD. Where a program names no units, mm are taken.
"""

import argparse
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "corpus"))
from programs import bytes_of, programs_in

FIGURES = ["time", "blocks", "distance", "roughness"]
SLOWEST = 10
WORSE = 1.02   # in a program
NOTHING = {"time": 0.01, "blocks": 1, "distance": 1e-4, "roughness": 1e-3}  # s, -, mm, rad/sqrt(mm)


def read_options():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    beside = os.environ.get("BATTEN_CORPUS", HERE.parent.parent / ".." / "shared" / "corpus")
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("--against", type=pathlib.Path, metavar="OLD")
    parser.add_argument("--corpus", type=pathlib.Path, default=beside)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--target", default="linuxcnc")
    parser.add_argument("--tolerance", default="0.01")
    parser.add_argument("--only", default="")
    parser.add_argument("--option", action="append", default=[], metavar="WORD")
    parser.add_argument("--save", type=pathlib.Path)
    parser.add_argument("--saved", type=pathlib.Path)
    return parser.parse_args()


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def smooth(binary, program, options, folder):
    report = folder / "report.json"
    report.unlink(missing_ok=True)
    command = [binary, "smooth", program, "-o", folder / "out.nc", "--force", "--quiet",
               "--threads", "1", "--target", options.target, "--tolerance", options.tolerance,
               "--json", report, *options.option]
    before = processor_time()
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode == 2 and "--units" in done.stderr:
        command += ["--units", "mm"]
        before = processor_time()
        done = subprocess.run(command, capture_output=True, text=True)
    seconds = processor_time() - before
    if done.returncode != 0 or not report.exists():
        return {"seconds": seconds, "code": done.returncode}
    said = json.loads(report.read_text())
    path = said["path_after"]
    return {"seconds": seconds, "code": 0, "time": said["time_after_s"],
            "blocks": said["output"]["blocks"], "distance": path["distance_mm"],
            "roughness": path["roughness"], "length": path["length_mm"]}


def added(rows):
    """The figures of all programs: distances and roughness as the path of all would have them."""
    rows = [row for row in rows if row.get("code") == 0]
    length = sum(row["length"] for row in rows) or 1
    rms = lambda name: math.sqrt(sum(row[name] ** 2 * row["length"] for row in rows) / length)
    return {"time": sum(row["time"] for row in rows), "blocks": sum(row["blocks"] for row in rows),
            "distance": rms("distance"), "roughness": rms("roughness")}


def ratios(new, old):
    return {name: (new[name] + NOTHING[name]) / (old[name] + NOTHING[name]) for name in FIGURES}


def main():
    options = read_options()
    saved = json.loads(options.saved.read_text()) if options.saved else {}
    results = {}
    with tempfile.TemporaryDirectory(prefix="batten-speed-") as name:
        folder = pathlib.Path(name)
        for file in programs_in(pathlib.Path(options.corpus)):
            if options.only not in file.name:
                continue
            program = folder / file.name.removesuffix(".gz")
            program.write_bytes(bytes_of(file))
            binaries = {"new": options.batten.resolve()}
            if options.against:
                binaries["old"] = options.against.resolve()
            rows = {"lines": program.read_bytes().count(b"\n")}
            for _ in range(options.rounds):
                for which, binary in binaries.items():
                    row = smooth(binary, program, options, folder)
                    if which in rows:
                        row["seconds"] = min(row["seconds"], rows[which]["seconds"])
                    rows[which] = row
            if file.name in saved:
                rows["old"] = saved[file.name]["new"]
            results[file.name] = rows
            program.unlink()
    report(results)
    if options.save:
        options.save.write_text(json.dumps(results))


def report(results):
    speed = lambda row, lines: f"{lines / row['seconds']:>10,.0f}"
    compared = any("old" in rows for rows in results.values())
    print(f"{'lines':>7} {'lines/s':>10}" + (f" {'old':>10} " + " ".join(f"{f:>9}" for f in FIGURES)
                                            if compared else "") + "  program")
    by_speed = sorted(results, key=lambda name: results[name]["lines"] / results[name]["new"]["seconds"])
    worse = []
    for name in by_speed:
        rows = results[name]
        line = f"{rows['lines']:>7} {speed(rows['new'], rows['lines'])}"
        if "old" in rows:
            line += f" {speed(rows['old'], rows['lines'])} "
            if rows["new"]["code"] == 0 and rows["old"]["code"] == 0:
                parts = ratios(rows["new"], rows["old"])
                line += " ".join(f"{parts[f]:>9.4f}" for f in FIGURES)
                worse += [f"{f} of {name}: {rows['old'][f]:.6g} -> {rows['new'][f]:.6g}"
                          for f in FIGURES if parts[f] > WORSE]
            else:
                line += f"exit codes {rows['old']['code']} and {rows['new']['code']}"
        print(line + "  " + name)
    lines = sum(rows["lines"] for rows in results.values())
    large = [name for name in by_speed if results[name]["lines"] >= 500]
    print(f"\nslowest {SLOWEST} of 500 lines or more: " + ", ".join(large[:SLOWEST]))
    seconds = sum(rows["new"]["seconds"] for rows in results.values())
    print(f"all: {lines} lines in {seconds:.2f} s of processor time, {lines / seconds:,.0f} lines/s")
    both = [rows for rows in results.values() if "old" in rows
            and rows["old"]["code"] == 0 and rows["new"]["code"] == 0]
    if not both:
        return
    seconds = sum(rows["old"]["seconds"] for rows in results.values() if "old" in rows)
    print(f"old: {seconds:.2f} s, {lines / seconds:,.0f} lines/s")
    parts = ratios(added([rows["new"] for rows in both]), added([rows["old"] for rows in both]))
    print("in sum, of the old ones: " + ", ".join(f"{f} {parts[f]:.4f}" for f in FIGURES))
    for line in worse:
        print("more than 2 % worse: " + line)


if __name__ == "__main__":
    main()
