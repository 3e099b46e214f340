#!/usr/bin/env python3
"""memory_table.py BATTEN [--blocks N...] [--kinds KIND...] [--method fair] [--folder DIR]

Smooths programs of make_large_programs.py for linuxcnc within 0.01 mm and prints how much memory
that took at most (resident, as the system tells it of the ended process), and how long it took:

  relief     rows of 200 blocks between rapids: smoothed window by window
  raster3d   one run: a window that is the whole program

Each from a file to a file and, with --stdin, from standard input to standard output."""
import argparse
import os
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))


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


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten")
    parser.add_argument("--blocks", type=int, nargs="+", default=[100_000, 1_000_000])
    parser.add_argument("--kinds", nargs="+", default=["relief"])
    parser.add_argument("--method", default="fair")
    parser.add_argument("--folder", default="large_programs")
    parser.add_argument("--stdin", action="store_true")
    args = parser.parse_args()
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


main()
