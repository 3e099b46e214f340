#!/usr/bin/env python3
"""Writes the sample programs, the same bytes each time.

    samples/generate.py            writes samples/*/program.ngc
    samples/generate.py --check    exit 1 when a file differs from what would be written

Needs nothing but Python 3. Each sample is a function of this file; its folder also holds the
command that smooths it, what must come out (expected.json), and a README.
"""

import math
import pathlib
import random
import sys

FOLDER = pathlib.Path(__file__).resolve().parent


def number(value, decimals):
    """Shortest decimal of `value` at so many places; never -0."""
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


class Program:
    """Lines of a program; coordinates that do not change are left out, as CAM systems do."""

    def __init__(self, *head, decimals=3):
        self.lines = list(head)
        self.decimals = decimals
        self.at = {}
        self.motion = None
        self.feed = None

    def line(self, text):
        self.lines.append(text)

    def move(self, word, feed=None, comment=None, **axes):
        words = []
        if word != self.motion:
            words.append(word)
            self.motion = word
        moved = False
        for axis in ("x", "y", "z"):
            if axis not in axes:
                continue
            text = number(axes[axis], self.decimals)
            if self.at.get(axis) != text:
                words.append(axis.upper() + text)
                self.at[axis] = text
                moved = True
        if not moved:
            return
        if feed is not None and feed != self.feed:
            words.append("F" + number(feed, 1))
            self.feed = feed
        if comment:
            words.append(f"({comment})")
        self.lines.append(" ".join(words))

    def rapid(self, **axes):
        self.move("G0", **axes)

    def cut(self, feed=None, comment=None, **axes):
        self.move("G1", feed=feed, comment=comment, **axes)

    def path(self, points, feed=None):
        for point in points:
            self.cut(feed=feed, **dict(zip("xyz", point)))

    def text(self):
        return "\n".join(self.lines) + "\n"


def head(title, *more):
    return [f"({title})", "G21 G90 G17 G94", "G64 P0.01", *more]


def arc_points(cx, cy, radius, start_deg, end_deg, chord):
    """Points on an arc, without the first, in chords of about this length."""
    sweep = math.radians(end_deg - start_deg)
    count = max(1, math.ceil(abs(sweep) * radius / chord))
    angles = [math.radians(start_deg) + sweep * i / count for i in range(1, count + 1)]
    return [(cx + radius * math.cos(a), cy + radius * math.sin(a)) for a in angles]


def even_points(curve, step, fine=200000, span=(0.0, 1.0)):
    """Points of curve(t), `step` mm apart along it, with both ends."""
    t0, t1 = span
    last = curve(t0)
    points, walked = [last], 0.0
    for i in range(1, fine + 1):
        here = curve(t0 + (t1 - t0) * i / fine)
        walked += math.dist(last, here)
        last = here
        if walked >= step:
            points.append(here)
            walked -= step
    if math.dist(points[-1], last) > 0.3 * step:
        points.append(last)
    else:
        points[-1] = last
    return points


def butterfly():
    """The butterfly curve of T. Fay (1989), 58 mm wide, points 0.2 mm apart with 0.005 mm noise."""
    noise = random.Random(1)

    def curve(t):
        r = math.exp(math.sin(t)) - 2 * math.cos(4 * t) + math.sin((2 * t - math.pi) / 24) ** 5
        return (10 * r * math.cos(t), 10 * r * math.sin(t))

    clean = even_points(curve, 0.2, span=(0.0, 2 * math.pi))
    points = [
        (x + noise.uniform(-0.005, 0.005), y + noise.uniform(-0.005, 0.005)) for x, y in clean
    ]
    points[-1] = points[0]
    program = Program(*head("butterfly contour, digitised"), "S12000 M3")
    program.rapid(z=5)
    program.rapid(x=points[0][0], y=points[0][1])
    program.cut(z=-1, feed=600)
    program.path(points[1:], feed=6000)
    program.rapid(z=5)
    program.line("M5")
    program.line("M2")
    return program.text()


def noisy_line_arc():
    """A 100 mm line and a half circle of radius 20, both with a zig-zag of 0.03 mm."""
    program = Program(*head("a line and a half circle with noise"), "S12000 M3")
    program.rapid(z=5)
    program.rapid(x=0, y=0)
    program.cut(z=-1, feed=600)
    zigzag = [(0.5 * i, 0.03 * (-1) ** i if 0 < i < 200 else 0.0) for i in range(1, 201)]
    program.path(zigzag, feed=3000)
    program.rapid(z=5)
    program.rapid(x=20, y=30)
    program.cut(z=-1, feed=600)
    steps = 400
    for i in range(1, steps + 1):
        radius = 20 + (0.03 * (-1) ** i if i < steps else 0.0)
        angle = math.pi * i / steps
        program.cut(x=radius * math.cos(angle), y=30 + radius * math.sin(angle), feed=3000)
    program.rapid(z=5)
    program.line("M5")
    program.line("M2")
    return program.text()


def chords(height, x_from, x_to, tolerance):
    """Greedy chords as CAM systems place them: as long as they stay within `tolerance`."""
    step = 0.02 if x_to > x_from else -0.02
    count = round((x_to - x_from) / step)
    xs = [x_from + step * i for i in range(count + 1)]
    zs = [height(x) for x in xs]
    kept, start = [], 0
    for end in range(2, count + 1):
        length = math.hypot(xs[end] - xs[start], zs[end] - zs[start])
        worst = max(
            abs((xs[end] - xs[start]) * (zs[i] - zs[start]) - (xs[i] - xs[start]) * (zs[end] - zs[start]))
            for i in range(start + 1, end)
        ) / length
        if worst > tolerance:
            start = end - 1
            kept.append((xs[start], zs[start]))
    kept.append((xs[-1], zs[-1]))
    return kept


def ballnose_finish():
    """Rows of a ball-nose finish over a wavy surface, back and forth, chord tolerance 0.005."""

    def height(x, y):
        return 3 * math.sin(x / 6) * math.cos(y / 9) + 0.8 * math.sin(x / 2.3 + y / 5)

    program = Program(*head("ball-nose finish of a wavy surface"), "T1 M6", "S18000 M3")
    program.rapid(z=15)
    program.rapid(x=0, y=0)
    program.cut(z=height(0, 0), feed=1000)
    for row in range(21):
        y = 0.8 * row
        ends = (0, 40) if row % 2 == 0 else (40, 0)
        program.cut(x=ends[0], y=y, z=height(ends[0], y), feed=6000)
        for x, z in chords(lambda x, y=y: height(x, y), *ends, 0.005):
            program.cut(x=x, z=z, feed=6000)
    program.rapid(z=15)
    program.line("M5")
    program.line("M2")
    return program.text()


def spiral_pocket():
    """A round pocket cut along a spiral in two depths, with a finishing circle."""
    program = Program(*head("spiral pocket"), "S10000 M3")
    for depth in (-1.5, -3):
        program.rapid(z=5)
        program.rapid(x=0, y=0)
        program.cut(z=depth, feed=300)
        turns, pitch, x, y = 9, 2.0, 0.0, 0.0
        angle = 0.0
        while angle < 2 * math.pi * turns:
            radius = pitch * angle / (2 * math.pi)
            angle = min(angle + 0.35 / max(radius, 0.5), 2 * math.pi * turns)
            radius = pitch * angle / (2 * math.pi)
            x, y = radius * math.cos(angle), radius * math.sin(angle)
            program.cut(x=x, y=y, feed=2400)
        program.path(arc_points(0, 0, turns * pitch, 0, 360, 0.35), feed=1800)
    program.rapid(z=5)
    program.line("M5")
    program.line("M2")
    return program.text()


def gear():
    """A gear of 17 teeth, module 3: involute flanks as chords, corners at tips and roots."""
    teeth, module, pressure = 17, 3.0, math.radians(20)
    pitch_radius = teeth * module / 2
    base, tip, root = pitch_radius * math.cos(pressure), pitch_radius + module, pitch_radius - 3.3

    def involute(radius):
        a = math.acos(base / radius)
        return math.tan(a) - a

    half_tooth = math.pi / (2 * teeth) + involute(pitch_radius)
    flank = [base + (tip - base) * (i / 30) ** 1.5 for i in range(31)]

    def place(radius, angle):
        return (radius * math.cos(angle), radius * math.sin(angle))

    points = []
    for tooth in range(teeth):
        middle = 2 * math.pi * tooth / teeth
        up = [(r, middle - half_tooth + involute(r)) for r in flank]
        down = [(r, middle + half_tooth - involute(r)) for r in reversed(flank)]
        outline = [(root, up[0][1])] + up
        land = down[0][1] - up[-1][1]
        outline += [(tip, up[-1][1] + land * i / 8) for i in range(1, 8)]
        outline += down + [(root, down[-1][1])]
        next_root = middle + 2 * math.pi / teeth - half_tooth
        gap = next_root - outline[-1][1]
        outline += [(root, outline[-1][1] + gap * i / 10) for i in range(1, 10)]
        points += [place(*p) for p in outline]
    points.append(points[0])
    program = Program(*head("gear of 17 teeth, module 3"), "S10000 M3")
    program.rapid(z=5)
    program.rapid(x=points[0][0], y=points[0][1])
    program.cut(z=-2, feed=300)
    program.path(points[1:], feed=1500)
    program.rapid(z=5)
    program.line("M5")
    program.line("M2")
    return program.text()


# Strokes in a box 6 wide and 10 high: points, and arcs ("arc", cx, cy, radius, from, to) that
# start where the stroke is.
STROKES = {
    "B": [
        [(0, 0), (0, 10), (3, 10), ("arc", 3, 7.5, 2.5, 90, -90), (0, 5)],
        [(3, 5), ("arc", 3, 2.5, 2.5, 90, -90), (0, 0)],
    ],
    "A": [[(0, 0), (3, 10), (6, 0)], [(1.2, 4), (4.8, 4)]],
    "T": [[(0, 10), (6, 10)], [(3, 10), (3, 0)]],
    "E": [[(6, 10), (0, 10), (0, 0), (6, 0)], [(0, 5), (4.5, 5)]],
    "N": [[(0, 0), (0, 10), (6, 0), (6, 10)]],
    "C": [[(6, 7), ("arc", 3, 7, 3, 0, 180), (0, 3), ("arc", 3, 3, 3, 180, 360)]],
    "U": [[(0, 10), (0, 3), ("arc", 3, 3, 3, 180, 360), (6, 10)]],
    "R": [[(0, 0), (0, 10), (3, 10), ("arc", 3, 7.5, 2.5, 90, -90), (0, 5)], [(3, 5), (6, 0)]],
    "V": [[(0, 10), (3, 0), (6, 10)]],
    "S": [[(5.5, 7.5), ("arc", 3, 7.5, 2.5, 0, 270), ("arc", 3, 2.5, 2.5, 90, -180)]],
}


def stroke_points(stroke, left, bottom):
    points = []
    for item in stroke:
        if item[0] == "arc":
            _, cx, cy, radius, start, end = item
            points += arc_points(left + cx, bottom + cy, radius, start, end, 0.15)
        else:
            points.append((left + item[0], bottom + item[1]))
    return points


def engraved_text():
    """BATTEN CURVES in a stroke font, engraved 0.2 mm deep."""
    program = Program("(engraved text)", "G21 G90 G17 G94", "S24000 M3")  # grbl has no G64
    program.rapid(z=2)
    for row, word in enumerate(("BATTEN", "CURVES")):
        for column, letter in enumerate(word):
            for stroke in STROKES[letter]:
                points = stroke_points(stroke, 8 * column, -14 * row)
                program.rapid(x=points[0][0], y=points[0][1])
                program.cut(z=-0.2, feed=200)
                program.path(points[1:], feed=800)
                program.rapid(z=2)
    program.line("M5")
    program.line("M2")
    return program.text()


def inch_ellipse():
    """An inch program with comments on lines of their own and on motion blocks."""
    program = Program(
        "%", "(ELLIPSE 3 X 2 INCH, CLIMB)", "(STOCK TOP IS Z0)", "G20 G90 G17 G94", "G64 P0.0005",
        "T3 M6 (1/4 END MILL)", "S9000 M3", decimals=4,
    )
    count = 480
    program.rapid(z=0.5)
    program.rapid(x=1.5, y=0)
    program.cut(z=-0.125, feed=10)
    for i in range(1, count + 1):
        angle = 2 * math.pi * i / count
        quarter = {1: "QUARTER 1", 120: "QUARTER 2", 240: "QUARTER 3", 360: "QUARTER 4"}.get(i)
        if i == 200:
            program.line("(WATCH THE CLAMP)")
        program.cut(x=1.5 * math.cos(angle), y=math.sin(angle), feed=60, comment=quarter)
    program.rapid(z=0.5)
    program.line("M5 (SPINDLE OFF)")
    program.line("M2")
    program.line("%")
    return program.text()


def tool_changes():
    """Waves cut with two tools: M, S and F words between and within the chains of moves."""
    program = Program(*head("waves with two tools"))
    for tool, speed, depth in ((1, 12000, -0.5), (2, 18000, -0.6)):
        program.line(f"T{tool} M6")
        program.line(f"S{speed} M3")
        program.rapid(z=5)
        program.rapid(x=0, y=0)
        program.cut(z=depth, feed=300)
        for i in range(1, 601):
            x = 0.15 * i
            if i == 150:
                program.line("M8")
            if i == 300:
                program.line(f"S{speed - 2000}")
            if i == 450:
                program.line("M9")
            # The feed falls for the middle of the second stretch; the path goes on.
            feed = 1200 if 200 <= i < 250 else 2000
            program.cut(x=x, y=4 * math.sin(x / 4), feed=feed)
        program.rapid(z=20)
        program.line("M5")
    program.line("M2")
    return program.text()


def helix_ramp():
    """A ramp down a helix of radius 12, three turns, and a floor circle, all as short lines."""
    program = Program(*head("helix ramp"), "S10000 M3")
    program.rapid(z=5)
    program.rapid(x=12, y=0)
    program.cut(z=0, feed=300)
    steps = 3 * 180
    for i in range(1, steps + 1):
        angle = 6 * math.pi * i / steps
        program.cut(x=12 * math.cos(angle), y=12 * math.sin(angle), z=-6 * i / steps, feed=1200)
    program.path(arc_points(0, 0, 12, 0, 360, 0.4), feed=1200)
    program.rapid(z=5)
    program.line("M5")
    program.line("M2")
    return program.text()


def kept_by_rule():
    """The same wave four times, each in a state in which nothing may be rewritten."""
    program = Program(*head("waves that must stay as they are"), "T1 M6", "S12000 M3")
    wave = [(0.2 * i, math.sin(0.1 * i)) for i in range(1, 101)]
    states = (
        ("G41.1 D0.1", "G40", "cutter compensation"),
        ("G61.1", "G64 P0.01", "exact stop"),
        ("G93", "G94", "inverse time"),
        ("G91", "G90", "incremental"),
    )
    for begin, end, title in states:
        program.rapid(z=5)
        program.rapid(x=0, y=0)
        program.line(f"({title})")
        program.line(begin)
        program.motion = None
        before = (0.0, 0.0)
        for x, y in wave:
            if begin == "G93":
                program.line(f"G1 X{number(x, 3)} Y{number(y, 3)} F4000")
            elif begin == "G91":
                step = (round(x, 3) - before[0], round(y, 3) - before[1])
                before = (round(x, 3), round(y, 3))
                program.line(f"G1 X{number(step[0], 3)} Y{number(step[1], 3)} F1000")
            else:
                program.line(f"G1 X{number(x, 3)} Y{number(y, 3)} F1000")
        program.line(end)
        program.at = {}
        program.motion = None
    program.rapid(z=5)
    program.line("M5")
    program.line("M2")
    return program.text()


SAMPLES = (
    butterfly, noisy_line_arc, ballnose_finish, spiral_pocket, gear, engraved_text, inch_ellipse,
    tool_changes, helix_ramp, kept_by_rule,
)


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    different = 0
    for sample in SAMPLES:
        file = FOLDER / sample.__name__ / "program.ngc"
        text = sample()
        if check:
            if not file.is_file() or file.read_text(encoding="ascii") != text:
                print(f"{file}: differs from what the generator writes", file=sys.stderr)
                different = 1
        else:
            file.parent.mkdir(exist_ok=True)
            file.write_text(text, encoding="ascii", newline="\n")
    sys.exit(different)


if __name__ == "__main__":
    main()
