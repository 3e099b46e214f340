#!/usr/bin/env python3
"""What it costs that a new path may not cross itself where the old one does not: made paths that are nearer to
themselves than twice the tolerance, and those of a corpus.

    crossing_table.py BATTEN [--corpus FOLDER]

A row for each kind of path, target and tolerance: runs of four blocks or more, how many of them are rewritten, the
blocks of those that are kept as crosses-itself, and the part of the cutting time that is in these. No more than that
part can be won by a path that keeps apart.
"""

import argparse
import json
import math
import random
import subprocess
import tempfile
from pathlib import Path

TOLERANCES = (0.02, 0.1)
TARGETS = ("linuxcnc", "grbl", "fanuc")
SEEDS = 12


def noisy(points, amplitude, seed):
    """All but the ends are moved."""
    chance = random.Random(seed)
    moved = [(x + chance.uniform(-amplitude, amplitude), y + chance.uniform(-amplitude, amplitude)) for x, y in points[1:-1]]
    return [points[0], *moved, points[-1]]


def thin_wall(t):
    """Out, and back 1.5 tolerances beside that."""
    out = [(0.4 * i, 3 * math.sin(0.4 * i / 6)) for i in range(100)]
    return out + [(x, y + 1.5 * t) for x, y in reversed(out)], 0.35 * t


def spiral(t):
    """Its passes are 1.5 tolerances apart."""
    return [((3 + 1.5 * t * a / (2 * math.pi)) * math.cos(a), (3 + 1.5 * t * a / (2 * math.pi)) * math.sin(a))
            for a in (0.06 * i for i in range(700))], 0.35 * t


def cusp(t):
    return [(4 - u * u, u ** 3) for u in (-2 + 0.02 * i for i in range(201))], 0.18 * t


def slot(t):
    """Three times around, 1.2 tolerances wide."""
    half = 0.6 * t
    angles = [math.pi * i / 8 for i in range(1, 8)]
    once = ([(0.5 * i, -half) for i in range(41)] + [(20 + half * math.sin(a), -half * math.cos(a)) for a in angles]
            + [(20 - 0.5 * i, half) for i in range(41)] + [(-half * math.sin(a), half * math.cos(a)) for a in angles])
    return 3 * once, 0.1 * t


def zigzag(t):
    """Twelve rows 1.6 tolerances apart."""
    points = []
    for row in range(12):
        xs = [0.5 * i for i in range(41)]
        points += [(x, 1.6 * t * row + 0.3 * t * math.sin(x)) for x in (xs if row % 2 == 0 else reversed(xs))]
    return points, 0.35 * t


def program_of(points):
    lines = ["G21 G90 G17", "G0 X{:.4f} Y{:.4f}".format(*points[0]), "G0 Z0", "F6000"]
    lines += ["G1 X{:.4f} Y{:.4f}".format(*p) for p in points[1:]]
    return "\n".join([*lines, "G0 Z5", "M2", ""])


class Row:
    def __init__(self):
        self.runs = self.rewritten = self.kept_blocks = 0
        self.kept_s = self.before_s = self.after_s = 0.0

    def add(self, report):
        runs = [r for r in report["runs"] if r["blocks_in"] > 3]
        crossing = [r for r in report["runs"] if r["reason"] == "crosses-itself"]
        self.runs += len(runs)
        self.rewritten += sum(r["status"] == "rewritten" for r in runs)
        self.kept_blocks += sum(r["blocks_in"] for r in crossing)
        self.kept_s += sum(r["time_before_s"] for r in crossing)
        self.before_s += report["cutting_before_s"]
        self.after_s += report["cutting_after_s"]

    def __str__(self):
        share = 100 * self.kept_s / self.after_s if self.after_s else 0
        return f"{self.runs} | {self.rewritten} | {self.kept_blocks} | {share:.2f} | {self.before_s:.1f} | {self.after_s:.1f}"


def smoothed(batten, program, target, tolerance, folder):
    figures = folder / "report.json"
    subprocess.run([batten, "smooth", program, "--target", target, "--tolerance", str(tolerance), "--dry-run", "--force",
                    "--quiet", "--json", figures], capture_output=True, check=False)
    report = json.loads(figures.read_text())
    figures.unlink()
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten")
    parser.add_argument("--corpus", type=Path)
    given = parser.parse_args()
    print("| path | target | tolerance, mm | runs | rewritten | blocks kept | % of time in them | s before | s after |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = folder / "made.nc"
        for shape in (thin_wall, spiral, cusp, slot, zigzag):
            for tolerance in TOLERANCES:
                points, amplitude = shape(tolerance)
                for target in TARGETS:
                    row = Row()
                    for seed in range(SEEDS):
                        program.write_text(program_of(noisy(points, amplitude, seed)))
                        row.add(smoothed(given.batten, program, target, tolerance, folder))
                    print(f"| {shape.__name__} | {target} | {tolerance} | {row} |", flush=True)
        for file in sorted(given.corpus.iterdir()) if given.corpus else []:
            for tolerance in TOLERANCES:
                row = Row()
                try:
                    row.add(smoothed(given.batten, file, "grbl", tolerance, folder))
                except (FileNotFoundError, json.JSONDecodeError):
                    continue  # not for this target, or not a program
                if row.kept_blocks:
                    print(f"| {file.name} | grbl | {tolerance} | {row} |", flush=True)


if __name__ == "__main__":
    main()
