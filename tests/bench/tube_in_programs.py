#!/usr/bin/env python3
"""tube_in_programs.py BATTEN [--tolerances 0.125,0.25]

Naseath's curves (tests/cases/naseath.json) as programs of lines that leave them by 0.001 mm, at
24,000 mm/min on his machine (400 mm/s, 4000 mm/s2, 20000 mm/s3), and the star and the butterfly of
docs/algorithms/polylines.json at 1500 mm/min on that of Ozcan 2018, written as curves for siemens by
`batten smooth --method fair` and `--method tube`, and by `best` in whatever form: a Markdown table of
the seconds that `batten time --planner jerk` takes for the feed moves of what was written, and the least
that any path in the band takes (`batten time --bound`)."""

import argparse
import json
import pathlib
import subprocess
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
CASES = HERE.parent / "cases" / "naseath.json"
POLYLINES = HERE.parent.parent / "docs" / "algorithms" / "polylines.json"
CHORD = 0.001  # mm


def machine(velocity, acceleration, jerk):
    return ('based-on = "high-speed"\nname = "of-the-paper"\nmax-velocity = %g\npath-feed = %g\n'
            % (velocity, velocity)
            + "".join("[axis.%s]\nacceleration = %g\njerk = %g\n" % (axis, limit, jerk)
                      for axis, limit in zip("xyz", acceleration)))


NASEATH = machine(400, [4000] * 3, 20000)
OZCAN = machine(25, [2500, 3000, 3000], 5000)


def point_at(knots, points, u):
    """De Boor's algorithm, cubic."""
    span = 3
    while span + 1 < len(points) and knots[span + 1] <= u:
        span += 1
    d = [list(points[span - 3 + j]) for j in range(4)]
    for r in range(1, 4):
        for j in range(3, r - 1, -1):
            i = span - 3 + j
            a = (u - knots[i]) / (knots[i + 4 - r] - knots[i])
            d[j] = [(1 - a) * p + a * q for p, q in zip(d[j - 1], d[j])]
    return d[3]


def distance(p, q):
    return sum((a - b) ** 2 for a, b in zip(p, q)) ** 0.5


def chords(knots, points):
    def add(u0, p0, u1, p1):
        middle = 0.5 * (u0 + u1)
        place = point_at(knots, points, middle)
        if distance(place, [(a + b) / 2 for a, b in zip(p0, p1)]) > CHORD:
            add(u0, p0, middle, place)
            add(middle, place, u1, p1)
        else:
            found.append(p1)
    breaks = sorted(set(knots))
    found = [point_at(knots, points, breaks[0])]
    for u0, u1 in zip(breaks, breaks[1:]):
        add(u0, found[-1], u1, point_at(knots, points, u1))
    return found


def program(places, feed=24000):
    xyz = [(p + [0, 0])[:3] if len(p) < 3 else p for p in places]
    lines = ["G71 G90 G64", "G0 X%.6f Y%.6f Z%.6f" % tuple(xyz[0]), "G1 F%g" % feed]
    return "\n".join(lines + ["G1 X%.6f Y%.6f Z%.6f" % tuple(p) for p in xyz[1:]] + ["M30", ""])


def feed_moves(batten, file, folder, *more):
    out = folder / "time.json"
    out.unlink(missing_ok=True)
    subprocess.run([batten, "time", file, "-t", "siemens", "--machine", folder / "machine.toml",
                    "--json", out, "--quiet", *more], check=True, capture_output=True)
    return json.loads(out.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("--tolerances", default="0.125,0.25")
    args = parser.parse_args()
    tolerances = args.tolerances.split(",")
    cases = []  # name, text, machine, tolerances
    for name, case in json.loads(CASES.read_text()).items():
        if not name.startswith("tc"):
            continue
        breaks = case["distinct_knots"]
        knots = [breaks[0]] * 3 + breaks + [breaks[-1]] * 3
        cases.append((name, program(chords(knots, case["control_points"])), NASEATH, tolerances))
    polylines = json.loads(POLYLINES.read_text())["cases"]
    for name in ("star, ten corners", "Guo's butterfly"):
        cases.append((name, program(polylines[name]["points"], 1500), OZCAN, ["0.05"]))
    print("| curve, tolerance in mm | fair | tube | best | least in the band |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for name, text, limits, wanted in cases:
            (folder / "machine.toml").write_text(limits)
            source = folder / "in.mpf"
            source.write_text(text)
            for tolerance in wanted:
                cells = []
                for options in (["--method", "fair", "--output", "curves"],
                                ["--method", "tube", "--output", "curves"], []):
                    subprocess.run([args.batten, "smooth", source, "-t", "siemens", "--machine",
                                    folder / "machine.toml", "--tolerance", tolerance, "-o",
                                    folder / "out.mpf", "--force", "--quiet", *options], check=True)
                    took = feed_moves(args.batten, folder / "out.mpf", folder, "--planner", "jerk")
                    cells.append(took["cutting_s"])
                bound = feed_moves(args.batten, source, folder, "--bound", "--tolerance", tolerance)
                cells.append(bound["bounds"]["least_within_s"])
                print("| %s, %s | %s |" % (name, tolerance, " | ".join("%.3f" % c for c in cells)),
                      flush=True)


if __name__ == "__main__":
    main()
