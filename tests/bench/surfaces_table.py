#!/usr/bin/env python3
"""surfaces_table.py BATTEN [--targets a,b,..] [--prefer a,b,..] [--chords a,b,..] [--shapes a,b,..] [--keep DIR] [--jobs 2]

Finishing rows over six surfaces that are known, 16 rows of 60 mm, 0.35 mm apart, at F3000, as lines: with
chords that leave the surface by 0.001, 0.002, 0.005 and 0.0125 mm, with steps of 0.35 mm, and with noise of
0.008 mm on chords of 0.005. `smooth` within 0.01 mm, the noise within 0.03. For each program, what it has
and what comes out, each as a ratio to the program's:

  rms    of the distance of the path from the surface, over the length of the path
  blocks
  time   as `smooth` predicts it for the target's machine
  rows   how far neighbouring rows differ in their offset from the surface (95 of 100 places)

and at the end the greatest and the mean of each column for each target, preference and kind of chords.
"""

import argparse
import bisect
import concurrent.futures
import itertools
import json
import math
import pathlib
import random
import re
import statistics
import subprocess
import tempfile

ROWS, LENGTH, STEP_OVER, FEED = 16, 60.0, 0.35, 3000
WORD = re.compile(r"([A-Z])\s*([-+]?[\d.]+)")

SHAPES = {  # z of x and y, mm
    "waves": lambda x, y: 3 * math.sin(2 * math.pi * x / 30) * math.cos(2 * math.pi * y / 40),
    "hill": lambda x, y: 4 * math.exp(-((x - 30) ** 2 + (y - 3) ** 2) / 60) + 0.5 * math.cos(x / 3),
    "ball": lambda x, y: 45 - math.sqrt(45**2 - (x - 30) ** 2 - (y - 3) ** 2),
    "ripples": lambda x, y: 1.2 * math.sin(x / 4 + 0.3 * y) + 0.8 * math.sin(x / 2.3),
    "fillet": lambda x, y: fillet(x - 30 - 0.2 * y),
    "saddle": lambda x, y: ((x - 30) ** 2 - 8 * (y - 3) ** 2) / 120 + 0.3 * math.sin(0.12 * x * (1 + 0.05 * y)),
}


def fillet(x):
    """A flat, a rounding of 8 mm that meets it with its tangent, and a slope of 45 degrees."""
    turn = 8 * math.sin(math.pi / 4)
    if x < 0:
        return 0.0
    return 8 - math.sqrt(64 - x * x) if x < turn else 8 - 8 * math.cos(math.pi / 4) + x - turn


def steps(surface, y, chord_error):
    """Where a row's vertices are, so that no chord leaves the surface by more, mm."""
    at = [0.0]
    while at[-1] < LENGTH:
        begin, low, high = at[-1], 0.0, min(5.0, LENGTH - at[-1])

        def fits(step):
            z0, z1 = surface(begin, y), surface(begin + step, y)
            slope = step / math.hypot(step, z1 - z0)
            return all(abs(surface(begin + step * k / 16, y) - z0 - (z1 - z0) * k / 16) * slope <= chord_error
                       for k in range(1, 16))

        if fits(high):
            low = high
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (middle, high) if fits(middle) else (low, middle)
        at.append(begin + low if LENGTH - begin - low > 1e-6 else LENGTH)
    return at


CHORDS = {  # error or step of the chords, mm: decimals, noise, tolerance
    "0.001": (4, 0, 0.01), "0.002": (4, 0, 0.01), "0.005": (3, 0, 0.01), "0.0125": (3, 0, 0.01),
    "step": (4, 0, 0.01), "noise": (4, 0.008, 0.03),
}


def program(name, chords):
    surface, (decimals, noise, _) = SHAPES[name], CHORDS[chords]
    error = {"noise": 0.005, "step": None}.get(chords, None) or (float(chords) if chords[0] == "0" else None)
    chance, lifts = random.Random(1), list(SHAPES).index(name) % 2 == 1
    lines = ["G21 G90 G17", "G0 X0 Y0 Z30"]
    for row in range(ROWS):
        y = STEP_OVER * row
        at = steps(surface, y, error) if error else [LENGTH * k / 171 for k in range(172)]
        at = at[::-1] if row % 2 else at
        if lifts and row:
            lines.append("G0 Z30")
        if lifts:
            lines.append(f"G0 X{at[0]:.{decimals}f} Y{y:.{decimals}f}")
        lines.append(f"G1 X{at[0]:.{decimals}f} Y{y:.{decimals}f} Z{surface(at[0], y):.{decimals}f} F{FEED}")
        lines += [f"X{x:.{decimals}f} Z{surface(x, y) + chance.uniform(-noise, noise):.{decimals}f}" for x in at[1:]]
    return "\n".join(lines + ["G0 Z30", "M2"]) + "\n"


def nurbs_points(control, knots, order):
    def blend(i, k, u):
        if k == 1:
            return 1.0 if knots[i] <= u < knots[i + 1] else 0.0
        left = right = 0.0
        if knots[i + k - 1] > knots[i]:
            left = (u - knots[i]) / (knots[i + k - 1] - knots[i]) * blend(i, k - 1, u)
        if knots[i + k] > knots[i + 1]:
            right = (knots[i + k] - u) / (knots[i + k] - knots[i + 1]) * blend(i + 1, k - 1, u)
        return left + right

    points = []
    for a, b in itertools.pairwise(knots[order - 1:len(control) + 1]):
        for k in range(8 if b > a else 0):
            u = a + (b - a) * k / 8
            weights = [blend(i, order, u) for i in range(len(control))]
            points.append([sum(w * p[axis] for w, p in zip(weights, control)) for axis in range(3)])
    return points + [control[-1]]


def path_points(text):
    """Polylines of the cutting moves, finely cut: lists of points in mm."""
    place, mode, plane, paths, curve = [0.0] * 3, 0, 17, [[]], None

    def go(points):
        if not paths[-1]:
            paths[-1].append(list(place))
        paths[-1].extend(points)

    def flush():
        nonlocal curve
        if curve:
            go(nurbs_points(curve[0], curve[1], curve[2])[1:])
            place[:] = curve[0][-1]
        curve = None

    for line in text.splitlines():
        words = WORD.findall(re.sub(r"\(.*?\)|;.*", "", line))
        to, offsets, moves, knot = list(place), {}, False, None
        if curve:
            to = list(curve[0][-1]) if curve[0] else list(place)
        for letter, number in words:
            value = float(number)
            if letter == "G" and value in (0, 1, 2, 3, 6.2):
                if value != 6.2:
                    flush()
                    to = list(place)
                elif curve is None:
                    curve = ([], [], 4)
                mode = value
            elif letter == "G" and value in (17, 18, 19):
                plane = int(value)
            elif letter in "XYZ":
                to["XYZ".index(letter)], moves = value, True
            elif letter in "IJKR":
                offsets[letter] = value
            elif letter == "P" and curve is not None:
                curve = (curve[0], curve[1], int(value))
        if curve is not None:
            if "K" in offsets:
                curve[1].append(offsets["K"])
            if moves or not curve[0]:
                curve[0].append(to)
            continue
        if not moves:
            continue
        if mode == 0:
            paths.append([])
        elif mode == 1:
            parts = max(1, int(math.dist(place, to) / 0.05))
            go([[a + (b - a) * k / parts for a, b in zip(place, to)] for k in range(1, parts + 1)])
        else:
            go(arc_points(place, to, plane, mode == 3, offsets))
        place = to
    flush()
    return [path for path in paths if path]


def arc_points(place, to, plane, left, offsets):
    a, b, c = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[plane]
    if "R" in offsets:
        radius, dx, dy = offsets["R"], to[a] - place[a], to[b] - place[b]
        chord = math.hypot(dx, dy)
        height = math.sqrt(max(0, radius**2 - chord**2 / 4)) * (1 if left == (radius > 0) else -1)
        center = (place[a] + dx / 2 - height * dy / chord, place[b] + dy / 2 + height * dx / chord)
    else:
        center = (place[a] + offsets.get("IJK"[a], 0), place[b] + offsets.get("IJK"[b], 0))
    begin = math.atan2(place[b] - center[1], place[a] - center[0])
    sweep = (math.atan2(to[b] - center[1], to[a] - center[0]) - begin) % (2 * math.pi)
    sweep = (sweep or 2 * math.pi) if left else (sweep or 2 * math.pi) - 2 * math.pi
    r0 = math.hypot(place[a] - center[0], place[b] - center[1])
    r1 = math.hypot(to[a] - center[0], to[b] - center[1])
    parts, points = max(4, int(abs(sweep) * r0 / 0.05)), []
    for k in range(1, parts + 1):
        at, radius, point = begin + sweep * k / parts, r0 + (r1 - r0) * k / parts, [0.0] * 3
        point[a], point[b] = center[0] + radius * math.cos(at), center[1] + radius * math.sin(at)
        point[c] = place[c] + (to[c] - place[c]) * k / parts
        points.append(point)
    return points


def figures(text, surface):
    """rms distance from the surface, mm, and how far neighbouring rows differ, mm."""
    total = length = 0.0
    rows = [[] for _ in range(ROWS)]
    for path in path_points(text):
        for p, q in itertools.pairwise(path):
            x, y, z = ((a + b) / 2 for a, b in zip(p, q))
            if abs(p[2] - q[2]) > 2 * math.dist(p[:2], q[:2]):
                continue
            row = round(y / STEP_OVER)
            if not (0 <= row < ROWS and abs(y - row * STEP_OVER) < 1e-3 and abs(z - surface(x, y)) < 0.2):
                continue
            dx = (surface(x + 1e-4, y) - surface(x - 1e-4, y)) / 2e-4
            dy = (surface(x, y + 1e-4) - surface(x, y - 1e-4)) / 2e-4
            off, long = (z - surface(x, y)) / math.sqrt(1 + dx * dx + dy * dy), math.dist(p, q)
            total += off * off * long
            length += long
            rows[row].append((x, off))
    for row in rows:
        row.sort()

    def offset(row, x):
        k = min(max(bisect.bisect(row, (x,)), 1), len(row) - 1)
        (x0, o0), (x1, o1) = row[k - 1], row[k]
        return o0 + (o1 - o0) * ((x - x0) / (x1 - x0) if x1 > x0 else 0)

    differ = sorted(abs(offset(a, x) - offset(b, x)) for a, b in itertools.pairwise(rows)
                    for x in (0.05 + 0.1 * k for k in range(int(LENGTH * 10))))
    return math.sqrt(total / length), differ[int(0.95 * len(differ))]


def measure(options, shape, chords, target, prefer):
    with tempfile.TemporaryDirectory(prefix="batten-surfaces-") as folder:
        at = pathlib.Path(folder)
        source, out = at / "in.ngc", at / "out.ngc"
        source.write_text(program(shape, chords))
        subprocess.run([options.batten, "smooth", source, "-o", out, "--target", target, "--prefer", prefer,
                        "--tolerance", str(CHORDS[chords][2]), "--quiet", "--progress", "off",
                        "--json", at / "report.json", *options.option], check=True)
        report = json.loads((at / "report.json").read_text())
        before = figures(source.read_text(), SHAPES[shape])
        after = figures(out.read_text(), SHAPES[shape])
        if options.keep:
            options.keep.mkdir(parents=True, exist_ok=True)
            (options.keep / f"{shape}_{chords}_{target}_{prefer}.ngc").write_text(out.read_text())
        runs = [run for run in report["runs"] if run["points"] > 2]
        kept = sum(run["status"] == "kept" for run in runs)
        return {"was": before[0] * 1000, "rows was": before[1] * 1000, "rms": after[0] / before[0], "blocks": report["output"]["blocks"] / report["input"]["blocks"],
                "time": sum(run["time_after_s"] for run in report["runs"]) / sum(run["time_before_s"] for run in report["runs"]), "rows": after[1] / before[1],
                "kept": f"{kept}/{len(runs)}"}


def main():
    def words(text):
        return text.split(",")

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--targets", type=words, default=["linuxcnc", "grbl", "fanuc"])
    parser.add_argument("--prefer", type=words, default=["time", "accuracy", "size"])
    parser.add_argument("--chords", type=words, default=list(CHORDS))
    parser.add_argument("--shapes", type=words, default=list(SHAPES))
    parser.add_argument("--keep", type=pathlib.Path, help="where the smoothed programs go")
    parser.add_argument("--option", action="append", default=[], metavar="WORD")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    columns = ["rms", "blocks", "time", "rows"]
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        for target, prefer, chords in itertools.product(options.targets, options.prefer, options.chords):
            made = list(pool.map(measure, *zip(*((options, shape, chords, target, prefer) for shape in options.shapes))))
            print(f"\n{target} {prefer}, chords {chords}\n{'':10}{'µm before':>10}{'rows':>7}" + "".join(f"{c:>9}" for c in columns) + "   kept runs")
            for shape, of in zip(options.shapes, made):
                print(f"{shape:10}{of['was']:10.2f}{of['rows was']:7.2f}" + "".join(f"{of[c]:9.3f}" for c in columns) + f"   {of['kept']}")
            for name, of in (("greatest", max), ("mean", statistics.mean)):
                print(f"{name:10}{'':17}" + "".join(f"{of(m[c] for m in made):9.3f}" for c in columns), flush=True)


if __name__ == "__main__":
    main()
