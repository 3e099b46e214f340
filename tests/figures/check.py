#!/usr/bin/env python3
"""check.py BATTEN [--write]: are the figures of smoothed paths those of figures.json?

Those are of the thresholds that were chosen (the structs `*Tuning`), and what a change of one moves is
seen here. The paths have what programs have: bends, corners, long lines, noise, steps, in the plane and
rising. For each method and form there are four figures of each rewritten run: blocks, time, deviation
and greatest curvature.

Ends with 1 at the first figure that differs by more than a ten-thousandth. --write writes them anew."""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

KNOWN = pathlib.Path(__file__).with_name("figures.json")
SETTINGS = {  # programs and options; the stairs are left out where they become what they are under "right"
    "chords": ("walks stairs", "--target grbl --machine router-unrounded --output lines --method fair"),
    "near chords": ("walks stairs", "--target grbl --machine router-unrounded --output lines --prefer accuracy"),
    "links": ("walks stairs", "--target grbl --machine router-unrounded --output lines --linearize minlink --method fair"),
    "few links": ("walks", "--target grbl --machine router-unrounded --output lines --prefer size --tolerance 0.03"),
    "arcs": ("walks stairs", "--target linuxcnc --machine linuxcnc-fast --output arcs --method fair"),
    "near arcs": ("walks stairs", "--target grbl --machine router-unrounded --output arcs --prefer accuracy --tolerance 0.02"),
    "few arcs": ("walks", "--target grbl --machine router-unrounded --output arcs --prefer size"),
    "curves": ("walks stairs", "--target linuxcnc --machine linuxcnc-fast --output curves --method fair"),
    "kept corners": ("stairs", "--target linuxcnc --machine linuxcnc-fast --output curves --method fair --keep-corners 30"),
    "left": ("walks stairs", "--target grbl --machine router-unrounded --side left --tolerance 0.05"),
    "right": ("walks stairs", "--target grbl --machine router-unrounded --side right --tolerance 0.03"),
    "fine": ("walks stairs", "--target grbl --machine router-unrounded --output lines --method fair --tolerance 0.003"),
    "noise": ("noise", "--target grbl --machine router-unrounded --output lines --method fair --tolerance 0.02"),
    "near noise": ("noise", "--target grbl --machine router-unrounded --output lines --prefer accuracy --tolerance 0.005"),
    "arcs and noise": ("noise", "--target linuxcnc --machine linuxcnc-fast --output arcs --prefer accuracy"),
    "shapes": ("shapes", "--target linuxcnc --machine linuxcnc-fast --output arcs --prefer size"),
    "racing": ("corners", "--target grbl --machine router-unrounded --output lines --method racing"),
    "ozcan": ("corners", "--target grbl --machine router-unrounded --output lines --method ozcan"),
    "naseath": ("corners", "--target grbl --machine router-unrounded --output lines --method naseath"),
    "tight racing": ("corners", "--target grbl --machine router-unrounded --output lines --method racing --tolerance 0.05"),
    "wide racing": ("corners", "--target linuxcnc --machine linuxcnc-fast --output curves --method racing --tolerance 0.1"),
    "wide naseath": ("corners", "--target linuxcnc --machine linuxcnc-fast --output curves --method naseath --tolerance 0.05"),
}
FIGURES = ("blocks_out", "time_after_s", "deviation_mm", "max_curvature_after")


def walk(seed, rise, noise, step=0.2, count=250):
    """A walk of bends with corners and long lines; its vertices are up to `noise` off."""
    rng = random.Random(seed)
    place, heading, bend = (0.0, 0.0, 0.0), 0.0, 0.0
    points = [place]
    for i in range(1, count):
        bend = 0.9 * bend + 0.03 * rng.uniform(-1, 1)
        heading += bend + (rng.uniform(-1.2, 1.2) if i % 40 == 20 else 0)
        length = 6 if i % 90 == 60 else step * rng.uniform(0.7, 1.3)
        way = (math.cos(heading), math.sin(heading), rise)
        place = tuple(p + length * w for p, w in zip(place, way))
        points.append(tuple(p + noise * rng.uniform(-1, 1) * (w != 0) for p, w in zip(place, way)))
    return points


def ring(chords, noise):
    """Closed: waves about a circle."""
    rng = random.Random(chords)
    angles = [2 * math.pi * i / chords for i in range(chords)]
    radii = [8 + math.cos(3 * a) + noise * rng.uniform(-1, 1) for a in angles]
    points = [(r * math.cos(a), r * math.sin(a), 0) for r, a in zip(radii, angles)]
    return points + points[:1]


def polygon(sides, degrees, noise):
    """Sides of 4 mm in steps of 0.2 mm."""
    rng = random.Random(sides)
    points, x, y = [(0, 0, 0)], 0, 0
    for i in range(20 * sides):
        heading = math.radians(degrees) * (i // 20)
        x, y = x + 0.2 * math.cos(heading), y + 0.2 * math.sin(heading)
        points.append((x + noise * rng.uniform(-1, 1), y + noise * rng.uniform(-1, 1), 0))
    return points


def slot(radius, length, chords):
    """Closed: two half circles and two lines, or a circle."""
    points = [(0, -radius, 0)]
    for side in (1, -1):
        for i in range(chords + 1):
            a = math.pi * (i / chords - 0.5)
            points.append((side * (length / 2 + radius * math.cos(a)), side * radius * math.sin(a), 0))
    return points + points[:1]


def stairs(corners, step):
    return [(step * ((i + 1) // 2), step * (i // 2), 0) for i in range(corners + 2)]


PROGRAMS = {
    "walks": [walk(1, 0, 0), walk(2, 0, 0.003), walk(3, 0.1, 0.01), walk(4, 0.2, 0.001), walk(5, 0, 0.012),
              walk(6, 0.1, 0, 0.05), ring(120, 0), ring(400, 0.004), ring(1500, 0)],
    "stairs": [stairs(30, 0.3)],
    "noise": [walk(8, 0.05, 0.03, 0.4), walk(9, 0, 0.006, 0.5), walk(10, 0.3, 0.02, 0.1), polygon(20, 1.5, 0),
              polygon(20, 3, 0), polygon(12, 30, 0.02), polygon(9, 40, 0.008)],
    "shapes": [slot(5, 0, 50), slot(4, 10, 30), slot(0.3, 0, 12), polygon(6, 60, 0), walk(11, 0, 0.008, 0.3, 60)],
    "corners": [walk(1, 0, 0, 0.5, 30), walk(7, 0.1, 0.003, 0.5, 45), stairs(4, 3), stairs(6, 0.2)],
}


def text_of(paths):
    lines = ["G21 G90 G17 G94", "F2000"]
    for path in paths:
        lines += ["G0 Z90", "G0 X%.3f Y%.3f" % path[0][:2], "G1 Z%.3f" % path[0][2]]
        lines += ["G1 X%.3f Y%.3f Z%.3f" % point for point in path[1:]]
    return "\n".join(lines + ["G0 Z90", "M2", ""])


def figures_of(batten, folder, programs, options):
    """Of each run: its figures where it is rewritten, else the reason why it is kept."""
    (folder / "part.nc").write_text(text_of([path for name in programs.split() for path in PROGRAMS[name]]))
    words = [batten, "smooth", "part.nc", "--out", "new.nc", "--force", "--json", "report.json", "--threads", "1"]
    subprocess.run(words + options.split(), cwd=folder, check=True, capture_output=True)
    runs = json.loads((folder / "report.json").read_text())["runs"]
    return [[run[key] for key in FIGURES] if run["status"] == "rewritten" else run["reason"]
            for run in runs if run["points"] > 2]


def same(found, known):
    if isinstance(found, str) or isinstance(known, str):
        return found == known
    return all(math.isclose(a, b, rel_tol=1e-4, abs_tol=1e-7) for a, b in zip(found, known))


def main():
    batten, known = pathlib.Path(sys.argv[1]).resolve(), {}
    if sys.argv[2:] != ["--write"]:
        known = json.loads(KNOWN.read_text())
    with tempfile.TemporaryDirectory() as folder:
        for name, (programs, options) in SETTINGS.items():
            found = figures_of(batten, pathlib.Path(folder), programs, options)
            expected = known.setdefault(name, found)
            for i, (a, b) in enumerate(zip(found, expected)):
                if not same(a, b):
                    sys.exit(f"Figures: {name}, run {i + 1}: {a}, expected {b}")
            if len(found) != len(expected):
                sys.exit(f"Figures: {name}: {len(found)} runs, expected {len(expected)}")
    if sys.argv[2:] == ["--write"]:
        rows = ",\n".join(f"{json.dumps(name)}: {json.dumps(rows)}" for name, rows in known.items())
        KNOWN.write_text("{\n" + rows.replace("], ", "],\n ") + "\n}\n")


if __name__ == "__main__":
    main()
