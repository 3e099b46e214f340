#!/usr/bin/env python3
"""How much the new path turns where a long run was cut, and how much about these places.

    tests/bench/joint_turns.py BATTEN FILE

Smooths FILE (plain G0 and G1 lines in millimetres, one motion a line) for linuxcnc at 0.01 mm with
--method fair, finds the ends of its rewritten runs in the new text, and prints the angles between the
tangents there and at the 80 joints about each. Arcs are those of the XY plane.
"""
import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ABOUT = 40  # joints on either side


def moves(lines):
    """Line number, end, and the directions at start and end of each motion."""
    place, mode = {"X": 0.0, "Y": 0.0, "Z": 0.0}, 1
    for number, line in enumerate(lines, 1):
        words = {}
        for letter, value in re.findall(r"([A-Z])(-?[\d.]+)", re.sub(r"\(.*?\)", "", line)):
            if letter == "G" and float(value) in (0, 1, 2, 3):
                mode = int(float(value))
            words[letter] = float(value)
        if not any(axis in words for axis in "XYZ"):
            continue
        start = tuple(place.values())
        place.update({axis: words[axis] for axis in "XYZ" if axis in words})
        end = tuple(place.values())
        yield (number, end, *directions(start, end, mode, words))


def directions(start, end, mode, words):
    if mode < 2:
        chord = tuple(b - a for a, b in zip(start, end))
        return chord, chord
    centre = (start[0] + words.get("I", 0.0), start[1] + words.get("J", 0.0))
    sign = 1 if mode == 3 else -1
    return tuple((-sign * (p[1] - centre[1]), sign * (p[0] - centre[0]), 0.0) for p in (start, end))


def degrees_between(a, b):
    lengths = math.hypot(*a) * math.hypot(*b)
    if lengths == 0:
        return 0.0
    return math.degrees(math.acos(max(-1.0, min(1.0, sum(u * v for u, v in zip(a, b)) / lengths))))


def smoothed(batten, program):
    with tempfile.TemporaryDirectory() as folder:
        new, report = Path(folder, "new.ngc"), Path(folder, "report.json")
        subprocess.run([batten, "smooth", program, "-o", new, "--json", report, "--quiet",
                        "--target", "linuxcnc", "--machine", "linuxcnc-fast", "--tolerance", "0.01",
                        "--method", "fair"],
                       check=True)
        return new.read_text().splitlines(), json.loads(report.read_text())["runs"]


def main():
    batten, program = sys.argv[1:]
    new, runs = smoothed(batten, program)
    lasts = sorted(run["last_line"] for run in runs if run["status"] == "rewritten")[:-1]
    cuts = {end for line, end, *_ in moves(Path(program).read_text().splitlines()) if line in lasts}
    path = list(moves(new))
    turns = [degrees_between(a[3], b[2]) for a, b in zip(path, path[1:])]
    at_cuts = [i for i, move in enumerate(path[:-1]) if move[1] in cuts]
    about = [max(turns[max(0, i - ABOUT):i] + turns[i + 1:i + 1 + ABOUT]) for i in at_cuts]
    here = sorted(turns[i] for i in at_cuts)
    print(f"{len(here)} places: turns of {here[0]:.2f} to {here[-1]:.2f} degrees, "
          f"{here[len(here) // 2]:.2f} in the middle")
    print(f"greatest of the {2 * ABOUT} about each: {min(about):.2f} to {max(about):.2f} degrees")


if __name__ == "__main__":
    main()
