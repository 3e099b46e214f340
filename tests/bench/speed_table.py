#!/usr/bin/env python3
"""speed_table.py [--batten PATH] [--blocks N] [--threads N] [--rounds N] [KIND...]

How fast whole programs are read, copied, smoothed and verified, as a Markdown table: blocks per
second, peak memory in bytes per block over the file, and the time as a multiple of LinuxCNC's own
interpreter reading the same file (rs274 -g; left out where it is not installed).

The programs are those of make_large_programs.py. All commands of a program run one after the other
in each round, so that what else the machine does meets all of them; the fastest round counts.

  --batten   the program; default: the environment's BATTEN, or the newest in build/*/batten
  --blocks   blocks of each program; default 1,000,000
  --threads  of smooth; default 2
  --rounds   default 3"""
import argparse
import glob
import os
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
KINDS = ["spiral", "circles", "raster3d"]


def newest_build():
    found = glob.glob(os.path.join(ROOT, "build", "*", "batten"))
    return max(found, key=os.path.getmtime) if found else None


def run(command):
    """Wall seconds and peak resident bytes of a command, or its message when it fails."""
    start = time.monotonic()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.monotonic() - start
        code = os.waitstatus_to_exitcode(status)
        if code not in (0, 2):
            errors.seek(0)
            sys.exit(f"{' '.join(command)}: exit status {code}\n{errors.read().decode()[-500:]}")
    return seconds, usage.ru_maxrss * 1024


def commands(batten, rs274, file, new, threads):
    smooth = [batten, "smooth", file, "--force", "--quiet", "--target", "linuxcnc", "--machine",
              "linuxcnc-fast", "--tolerance", "0.01", "--threads", str(threads)]
    rows = {"cat": ["cat", file]}
    if rs274:
        rows["rs274 -g"] = [rs274, "-g", file, "/dev/null"]
    rows["batten inspect"] = [batten, "inspect", file]
    rows["batten smooth --method none"] = smooth + ["--method", "none", "-o", new + ".none"]
    rows["batten smooth --method fair"] = smooth + ["--method", "fair", "-o", new + ".fair"]
    rows["batten smooth --method best"] = smooth + ["--method", "best", "-o", new]
    rows["batten verify"] = [batten, "verify", file, new, "--tolerance", "0.01"]
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--batten", default=os.environ.get("BATTEN") or newest_build())
    parser.add_argument("--blocks", type=int, default=1_000_000)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(KINDS))
    args = parser.parse_args()
    if not args.batten:
        sys.exit("no batten given and none built")
    rs274 = shutil.which("rs274")

    print("| program | command | blocks/s | times rs274 | bytes a block over the file |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        made = subprocess.run([sys.executable, os.path.join(HERE, "make_large_programs.py"),
                               scratch, *(args.kinds or KINDS), "--blocks", str(args.blocks)],
                              check=True, capture_output=True, text=True).stdout.split()
        for file in made:
            rows = commands(args.batten, rs274, file, file + ".new", args.threads)
            best = {}
            for _ in range(args.rounds):
                for name, command in rows.items():
                    seconds, memory = run(command)
                    before = best.get(name, (seconds, memory))
                    best[name] = min(before[0], seconds), max(before[1], memory)
            size = os.path.getsize(file)
            for name, (seconds, memory) in best.items():
                ratio = f"{seconds / best['rs274 -g'][0]:.2f}" if rs274 else ""
                over = (memory - size) / args.blocks
                kind = os.path.basename(file).split("_")[0]
                print(f"| {kind} | {name} | {args.blocks / seconds:,.0f} | {ratio} | {over:.0f} |",
                      flush=True)


main()
