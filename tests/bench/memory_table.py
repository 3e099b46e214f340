#!/usr/bin/env python3
"""memory_table.py BATTEN [--blocks N...] [--kinds KIND...] [--method fair] [--folder DIR]
memory_table.py BATTEN --corpus DIR [--target linuxcnc] [--threads 1]

With a corpus: smooths each of its programs within 0.01 mm, and prints those that took more than 20 MB
and 150 bytes for each line, and the one that took most. Needs GNU time (Debian: time).

Else smooths programs of make_large_programs.py for linuxcnc within 0.01 mm and prints how much memory
that took at most (resident, as the system tells it of the ended process), and how long it took:

  relief     rows of 200 blocks between rapids: smoothed window by window
  raster3d   one run, cut where its rows end

Each from a file to a file and, with --stdin, from standard input to standard output."""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "corpus"))
from programs import bytes_of, programs_in


def smooth(arguments, stdin=None, stdout=None):
    """Seconds and MB of one call."""
    start = time.monotonic()
    process = subprocess.Popen(arguments, stdin=stdin, stdout=stdout, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(arguments)}: exit code {process.returncode}")
    return time.monotonic() - start, usage.ru_maxrss / 1024


def line(cells):
    print("| " + " | ".join(cells) + " |", flush=True)


def above(options):
    """Programs of a corpus that take more than they may."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "part.nc")
        for file in programs_in(pathlib.Path(options.corpus)):
            text = bytes_of(file)
            lines = text.count(b"\n")
            with open(program, "wb") as part:
                part.write(text)
            words = [options.batten, "smooth", program, "-o", os.path.join(folder, "new.nc"), "--force",
                     "--target", options.target, "--tolerance", "0.01", "--threads", options.threads]
            # A process that is started by this one begins with its memory: not so of GNU time.
            done = subprocess.run(["/usr/bin/time", "--format=%M"] + words, capture_output=True, text=True)
            if done.returncode == 0:
                taken = int(done.stderr.split()[-1]) * 1024 / 1e6
                rows.append((taken - 20 - 150e-6 * lines, taken, lines, file.name))
    rows.sort(reverse=True)
    line(["program", "lines", "MB of memory at most", "more than 20 MB and 150 B a line"])
    line(["---"] * 4)
    for more, taken, lines, file in rows:
        if more > 0:
            line([file, f"{lines:,}", f"{taken:.1f}", f"{more:.1f}"])
    _, taken, lines, file = max(rows, key=lambda row: row[1])
    print(f"{sum(row[0] > 0 for row in rows)} of {len(rows)} programs; most: {taken:.1f} MB, {file} of {lines:,} lines")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten")
    parser.add_argument("--blocks", type=int, nargs="+", default=[100_000, 1_000_000])
    parser.add_argument("--kinds", nargs="+", default=["relief"])
    parser.add_argument("--method", default="fair")
    parser.add_argument("--folder", default="large_programs")
    parser.add_argument("--stdin", action="store_true")
    parser.add_argument("--corpus")
    parser.add_argument("--target", default="linuxcnc")
    parser.add_argument("--threads", default="1")
    args = parser.parse_args()
    if args.corpus:
        return above(args)
    line(["program", "blocks", "MB of file", "MB of memory at most", "s", "blocks/s"])
    line(["---"] * 6)
    for kind in args.kinds:
        for blocks in args.blocks:
            program = os.path.join(args.folder, f"{kind}_{blocks}.ngc")
            if not os.path.exists(program):
                subprocess.run([sys.executable, os.path.join(HERE, "make_large_programs.py"),
                                args.folder, kind, "--blocks", str(blocks)],
                               check=True, stdout=subprocess.DEVNULL)
            size = os.path.getsize(program) / 1e6
            options = ["--target", "linuxcnc", "--machine", "linuxcnc-fast", "--tolerance", "0.01",
                       "--method", args.method, "--progress", "off"]
            result = program + ".smooth"
            if args.stdin:
                with open(program, "rb") as old, open(result, "wb") as new:
                    seconds, memory = smooth([args.batten, "smooth", "-"] + options, old, new)
            else:
                seconds, memory = smooth(
                    [args.batten, "smooth", program, "-o", result, "--force"] + options)
            os.remove(result)
            line([kind, f"{blocks:,}", f"{size:.0f}", f"{memory:.0f}", f"{seconds:.1f}",
                  f"{blocks / seconds:,.0f}"])


if __name__ == "__main__":
    main()
