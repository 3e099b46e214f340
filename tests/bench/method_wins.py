#!/usr/bin/env python3
"""method_wins.py BATTEN METHOD [--corpus DIR] [--targets a,b,..] [--tolerance 0.01] [--jobs 1]
                  [--only TEXT] [--largest BYTES] [--runs]

What `--method best` would win if it tried METHOD as well: every program of the corpus beside the
checkout (or BATTEN_CORPUS) is smoothed by both. For each target: the runs that METHOD makes faster
by a percent or more than `best` does, the seconds of those runs by `best` and by METHOD, the seconds
of all runs by `best`, and processor time of both. Runs that one of them cuts elsewhere are compared
as parts of the program that both cut at the same blocks. `--runs`: a line for each run that is won.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "corpus"))
from programs import bytes_of, programs_in

CLEARLY = 0.99  # of the time of `best`: less is a win


def read_options():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    beside = os.environ.get("BATTEN_CORPUS", HERE.parent.parent / ".." / "shared" / "corpus")
    parser.add_argument("batten", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("method")
    parser.add_argument("--corpus", type=pathlib.Path, default=beside)
    parser.add_argument("--targets", type=lambda text: text.split(","),
                        default=["linuxcnc", "grbl", "fanuc", "siemens"])
    parser.add_argument("--tolerance", type=float, default=0.01)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--largest", type=int, default=1 << 30)
    parser.add_argument("--runs", action="store_true")
    return parser.parse_args()


def smooth(options, file, target, method):
    """Its runs, and processor seconds; no runs where it is refused."""
    with tempfile.TemporaryDirectory(prefix="batten-wins-") as folder:
        suffix = pathlib.Path(file.stem if file.suffix == ".gz" else file.name).suffix or ".nc"
        source = pathlib.Path(folder, "old" + suffix)
        source.write_bytes(bytes_of(file))
        report = pathlib.Path(folder, "report.json")
        with subprocess.Popen(
                [options.batten, "smooth", source, "--dry-run", "--target", target, "--tolerance",
                 str(options.tolerance), "--method", method, "--threads", "1", "--progress", "off",
                 "--json", report],
                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            _, _, used = os.wait4(process.pid, 0)
            process.returncode = 0
        if not report.exists():
            return [], 0.0
        return json.loads(report.read_text()).get("runs", []), used.ru_utime + used.ru_stime


def same_sections(best, other):
    """Pairs of lists of runs between blocks at which both have a cut, in order."""
    ends = {run["last_line"] for run in best} & {run["last_line"] for run in other}

    def groups(runs):
        found, open_group = {}, []
        for run in runs:
            open_group.append(run)
            if run["last_line"] in ends:
                found[run["last_line"]] = open_group
                open_group = []
        return found

    of_best, of_other = groups(best), groups(other)
    return [(of_best[end], of_other[end]) for end in sorted(ends)]


def seconds(runs):
    return sum(run["time_after_s"] for run in runs)


def main():
    options = read_options()
    files = [file for file in programs_in(options.corpus)
             if options.only in str(file) and len(bytes_of(file)) <= options.largest]
    asked = [(file, target, method) for target in options.targets for file in files
             for method in ("best", options.method)]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = dict(zip(asked, pool.map(lambda each: smooth(options, *each), asked)))
    print(f"{'target':10} {'runs':>6} {'won':>5} {'best, s':>9} {options.method + ', s':>12} "
          f"{'all by best, s':>14} {'cpu best, s':>11} {'cpu, s':>7}")
    for target in options.targets:
        runs, won, lines = 0, [], []
        total, cpu = 0.0, [0.0, 0.0]
        for file in files:
            best, used_best = results[file, target, "best"]
            other, used = results[file, target, options.method]
            cpu = [cpu[0] + used_best, cpu[1] + used]
            total += seconds(best)
            for mine, theirs in same_sections(best, other):
                runs += 1
                if seconds(theirs) >= CLEARLY * seconds(mine):
                    continue
                won.append((seconds(mine), seconds(theirs)))
                points = sum(run["points"] for run in mine)
                blocks = [sum(run["blocks_out"] for run in each) for each in (mine, theirs)]
                lines.append(f"  {file.name} {mine[0]['first_line']}-{mine[-1]['last_line']}: {points} points, "
                             f"{seconds(mine):.3f} s by {mine[0]['method'] or mine[0]['reason']} "
                             f"({blocks[0]} blocks), {seconds(theirs):.3f} s ({blocks[1]} blocks)")
        sums = [sum(each) for each in zip(*won)] if won else [0, 0]
        print(f"{target:10} {runs:6} {len(won):5} {sums[0]:9.2f} {sums[1]:12.2f} {total:14.1f} "
              f"{cpu[0]:11.1f} {cpu[1]:7.1f}")
        if options.runs:
            print("\n".join(lines))


if __name__ == "__main__":
    main()
