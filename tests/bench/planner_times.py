#!/usr/bin/env python3
"""planner_times.py BATTEN [--corpus DIR] [--machine high-speed] [--feeds 1,4] [--only TEXT]
                    [--within PERCENT] [--saved FILE]

What `batten time` estimates for every program of the corpus beside the checkout (or BATTEN_CORPUS) on
a machine with limits on jerk, beside the time of the plan (`--planner jerk`), at the programmed feeds
and at so many times these: seconds of moves, the difference in per cent of the plan, processor time
of both; the ten that differ most, and how far all of them do. With --within the command fails where
one differs by more. --saved keeps the plans' times in a file and takes those that are there already.
"""

import argparse
import hashlib
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "corpus"))
from programs import bytes_of, programs_in

WORST = 10
NOTHING = 0.001  # s: programs that move for less are left out

# A feed, or a comment, in which nothing is one.
FEED = re.compile(rb"\([^)\n]*\)|;[^\n]*|(?<![A-Za-z_<#])[Ff] ?(\d+\.?\d*|\.\d+)")


def read_options():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    beside = os.environ.get("BATTEN_CORPUS", HERE.parent.parent / ".." / "shared" / "corpus")
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("--corpus", type=pathlib.Path, default=beside)
    parser.add_argument("--machine", default="high-speed")
    parser.add_argument("--feeds", type=lambda text: [float(f) for f in text.split(",")], default=[1, 4])
    parser.add_argument("--only", default="")
    parser.add_argument("--within", type=float, metavar="PERCENT")
    parser.add_argument("--saved", type=pathlib.Path)
    return parser.parse_args()


def faster(text, times):
    def scaled(match):
        return match[0] if match[1] is None else b"F%.6f" % (times * float(match[1]))
    return text if times == 1 else FEED.sub(scaled, text)


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


# Seconds of the moves and of the processor; nothing where the program has no time.
def timed(options, program, planner):
    begin = processor_time()
    run = subprocess.run([options.batten, "time", program, "--machine", options.machine, "--planner", planner,
                          "--units", "mm", "--quiet", "--json", "-"], capture_output=True)
    if run.returncode != 0:
        return None
    report = json.loads(run.stdout)
    return report["cutting_s"] + report["rapid_s"], processor_time() - begin


def planned(options, program, text, saved):
    key = hashlib.sha256(text).hexdigest() + " " + options.machine
    if key not in saved:
        saved[key] = timed(options, program, "jerk")
        if options.saved:
            options.saved.write_text(json.dumps(saved))
    return saved[key]


def main():
    options = read_options()
    saved = json.loads(options.saved.read_text()) if options.saved and options.saved.exists() else {}
    rows = []
    with tempfile.TemporaryDirectory(prefix="batten-planner-") as folder:
        for file in programs_in(options.corpus):
            if options.only not in file.name:
                continue
            for times in options.feeds:
                text = faster(bytes_of(file), times)
                program = pathlib.Path(folder) / file.name.removesuffix(".gz")
                program.write_bytes(text)
                estimate = timed(options, program, "control")
                plan = planned(options, program, text, saved) if estimate else None
                if plan and plan[0] > NOTHING:
                    rows.append((100 * (estimate[0] / plan[0] - 1), f"{file.name} x{times:g}", estimate, plan))
                    print("%+7.2f %%  %9.3f  %9.3f s   %7.2f %7.2f s  %s" % (
                        rows[-1][0], estimate[0], plan[0], estimate[1], plan[1], rows[-1][1]), flush=True)
    if not rows:
        sys.exit("no program of the corpus has a time")
    rows.sort(key=lambda row: -abs(row[0]))
    print(f"\nfarthest from the plan (%, {options.machine}):")
    for row in rows[:WORST]:
        print("%+7.2f  %s" % (row[0], row[1]))
    off = [abs(row[0]) for row in rows]
    print("%d times: %d within 1 %%, %d within 2 %%, mean %.2f %%; processor time %.1f s, of the plans %.1f s" % (
        len(rows), sum(o <= 1 for o in off), sum(o <= 2 for o in off), sum(off) / len(off),
        sum(row[2][1] for row in rows), sum(row[3][1] for row in rows)))
    if options.within is not None and off[0] > options.within:
        sys.exit(f"{rows[0][1]} differs by {off[0]:.2f} %, allowed are {options.within:g} %")


if __name__ == "__main__":
    main()
