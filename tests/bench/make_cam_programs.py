#!/usr/bin/env python3
"""make_cam_programs.py DIR [--programs 1000] [--seed 1]

Random programs as CAM systems write them, for LinuxCNC and its like, in the styles below by turns: what
the speed and the choice are judged by that nobody has tuned for. The same seed gives the same bytes.
`corpus_speed.py BATTEN --corpus DIR` says how fast they are smoothed.

  raster      rows over a surface, chords of some tolerance or of even steps
  waterlines  levels of a grid: staircases with rounded steps
  adaptive    curls of an adaptive pocket, each between lines
  letters     engraved strokes, a few short moves each
  gear        teeth, around and around
  spiral      outwards, with noise as of scanned parts
  short       runs of four to twelve moves between plunges
  sharp       zigzags that turn back at every point
  relief      an image: even pixels, heights in steps
  contours    closed flowing outlines with lines and arcs, one in the other
"""
import argparse
import math
import pathlib
import random


class Program:
    """Lines of one program. Coordinates in mm, printed in its units."""

    def __init__(self, rng):
        self.inch = rng.random() < 0.2
        self.decimals = rng.choice([4, 5]) if self.inch else rng.choice([3, 3, 4])
        self.lines = [("G20" if self.inch else "G21") + " G17 G90 G94", "M3 S12000", "G64 P0.01" if not self.inch else "G64 P0.0004"]
        self.feed = rng.choice([600, 1000, 1800, 3000])
        self.fresh = True  # the next move says G1 and the feed

    def number(self, value):
        text = f"{value / 25.4 if self.inch else value:.{self.decimals}f}".rstrip("0").rstrip(".")
        return "0" if text in ("-0", "") else text

    def words(self, x, y, z=None):
        words = f"X{self.number(x)} Y{self.number(y)}"
        return words if z is None else f"{words} Z{self.number(z)}"

    def rapid(self, x, y, z):
        self.lines += [f"G0 Z{self.number(5)}", f"G0 {self.words(x, y)}",
                       f"G1 Z{self.number(z)} F{self.number(self.feed / 3)}"]
        self.fresh = True

    def move(self, x, y, z=None):
        head = f"G1 F{self.number(self.feed)} " if self.fresh else ""
        self.lines.append(head + self.words(x, y, z))
        self.fresh = False

    def arc(self, code, x, y, i, j):
        self.lines.append(f"{code} {self.words(x, y)} I{self.number(i)} J{self.number(j)} F{self.number(self.feed)}")
        self.fresh = True

    def path(self, points):
        self.rapid(*points[0][:2], points[0][2] if len(points[0]) > 2 else -1)
        for point in points[1:]:
            self.move(*point)

    def text(self):
        return "\n".join(self.lines + [f"G0 Z{self.number(10)}", "M5", "M30", ""])


def simplified(points, off):
    """Of a dense path: the farthest points whose chords leave it by no more than `off` (mm)."""
    kept = [points[0]]
    first = 0
    while first < len(points) - 1:
        last = first + 1
        while last + 1 < len(points) and all(
                distance(points[k], points[first], points[last + 1]) <= off
                for k in range(first + 1, last + 1, max(1, (last - first) // 8))):
            last += 1
        kept.append(points[last])
        first = last
    return kept


def distance(point, a, b):
    along = [q - p for p, q in zip(a, b)]
    square = sum(v * v for v in along) or 1e-30
    part = min(1, max(0, sum((x - p) * v for x, p, v in zip(point, a, along)) / square))
    return math.sqrt(sum((x - p - part * v) ** 2 for x, p, v in zip(point, a, along)))


def waves(rng, terms, longest, shortest):
    """A smooth function of (x, y): a sum of waves of random direction."""
    parts = []
    for _ in range(terms):
        length = rng.uniform(shortest, longest)
        angle = rng.uniform(0, 2 * math.pi)
        parts.append((2 * math.pi / length * math.cos(angle), 2 * math.pi / length * math.sin(angle),
                      rng.uniform(0, 2 * math.pi), 0.02 * length))
    return lambda x, y: sum(a * math.sin(p * x + q * y + c) for p, q, c, a in parts)


def outline(rng, radius, terms, count):
    """A closed flowing curve about the origin, as (x, y)."""
    parts = [(k, rng.uniform(-0.5, 0.5) / k ** 1.5, rng.uniform(0, 2 * math.pi)) for k in range(2, 2 + terms)]
    points = []
    for i in range(count + 1):
        t = 2 * math.pi * (i % count) / count
        r = radius * (1 + 0.4 * sum(a * math.cos(k * t + c) for k, a, c in parts))
        points.append((r * math.cos(t), r * math.sin(t)))
    return points


def raster(rng, program):
    height = waves(rng, 4, 40, 8)
    width = rng.uniform(15, 40)
    off = rng.choice([0, 0.001, 0.003, 0.005, 0.01])
    step = rng.uniform(0.2, 0.6)
    for row in range(rng.randrange(6, 20)):
        y = 0.4 * row
        count = round(width / (step if off == 0 else 0.05))
        points = [(width * i / count, y, height(width * i / count, y) - 3) for i in range(count + 1)]
        points = simplified(points, off) if off else points
        program.path(points if row % 2 == 0 else points[::-1])


def waterlines(rng, program):
    grid = rng.uniform(0.2, 0.5)
    for level in range(rng.randrange(3, 9)):
        shape = outline(rng, 8 + 1.5 * level, 4, 400)
        corners = []
        for x, y in shape:
            corner = (grid * round(x / grid), grid * round(y / grid), -1.0 - level)
            if not corners or corner != corners[-1]:
                corners.append(corner)
        program.path(corners)


def adaptive(rng, program):
    x = y = 0.0
    radius = rng.uniform(2, 5)
    step = rng.uniform(0.3, 0.9)
    for curl in range(rng.randrange(8, 30)):
        turns = rng.uniform(0.5, 0.9) * 2 * math.pi
        points = [(x + radius * math.cos(t), y + radius * math.sin(t), -2)
                  for t in (turns * i / 90 for i in range(91))]
        program.path(simplified(points, rng.choice([0.002, 0.01])))
        x += step
        y += 0.2 * math.sin(0.4 * curl)


def letters(rng, program):
    for stroke in range(rng.randrange(40, 120)):
        x, y = 6 * (stroke % 12), 9 * (stroke // 12)
        size = rng.uniform(1, 4)
        points = [(x + rng.uniform(0, size), y + rng.uniform(0, size), -0.2)]
        for _ in range(rng.randrange(1, 4)):
            (x0, y0, _), (cx, cy), (x1, y1) = (points[-1], (x + rng.uniform(0, size), y + rng.uniform(0, size)),
                                               (x + rng.uniform(0, size), y + rng.uniform(0, size)))
            count = rng.choice([1, 6, 10])
            for i in range(1, count + 1):
                t = i / count
                points.append(((1 - t) ** 2 * x0 + 2 * t * (1 - t) * cx + t * t * x1,
                               (1 - t) ** 2 * y0 + 2 * t * (1 - t) * cy + t * t * y1, -0.2))
        program.path(points)


def gear(rng, program):
    teeth = rng.randrange(9, 30)
    module = rng.uniform(1, 3)
    flank = rng.randrange(4, 12)
    for depth in range(rng.randrange(1, 4)):
        points = []
        for tooth in range(teeth):
            for side in (-1, 1):
                for i in range(flank + 1):
                    part = i / flank if side < 0 else 1 - i / flank
                    r = module * (teeth / 2 - 1.2 + 2.2 * part)
                    angle = 2 * math.pi / teeth * (tooth + side * (0.25 - 0.13 * part ** 1.5))
                    points.append((r * math.cos(angle), r * math.sin(angle), -1.0 - depth))
        program.path(points + points[:1])


def spiral(rng, program):
    noise = rng.choice([0, 0.002, 0.005, 0.01])
    turns = rng.uniform(5, 15)
    count = rng.randrange(600, 3000)
    points = []
    for i in range(count + 1):
        t = 2 * math.pi * turns * math.sqrt(i / count)
        points.append((0.25 * t * math.cos(t) + rng.gauss(0, noise), 0.25 * t * math.sin(t) + rng.gauss(0, noise),
                       -1 - 0.01 * t))
    program.path(points)


def short(rng, program):
    for run in range(rng.randrange(60, 200)):
        x, y = 5 * (run % 15), 5 * (run // 15)
        angle = rng.uniform(0, 2 * math.pi)
        points = [(x, y, -1)]
        bend = rng.uniform(-0.5, 0.5)
        for _ in range(rng.randrange(4, 13)):
            length = rng.uniform(0.1, 0.6)
            angle += bend + rng.gauss(0, 0.05)
            points.append((points[-1][0] + length * math.cos(angle), points[-1][1] + length * math.sin(angle), -1))
        program.path(points)


def sharp(rng, program):
    for run in range(rng.randrange(2, 6)):
        x = 0.0
        points = [(0, 10.0 * run, -1)]
        for i in range(rng.randrange(100, 400)):
            x += rng.uniform(0.02, 0.3)
            points.append((x, 10.0 * run + (1 if i % 2 == 0 else -1) * rng.uniform(0.2, 3), -1))
        program.path(points)


def relief(rng, program):
    height = waves(rng, 6, 20, 2)
    pixel = rng.choice([0.1, 0.2, 0.25])
    grey = rng.choice([0.02, 0.05, 0.1])
    for row in range(rng.randrange(4, 12)):
        y = pixel * row
        points = [(pixel * i, y, grey * round(height(pixel * i, y) / grey) - 2) for i in range(rng.randrange(150, 400))]
        kept = [p for i, p in enumerate(points) if i in (0, len(points) - 1) or not points[i - 1][2] == p[2] == points[i + 1][2]]
        program.path(kept)


def contours(rng, program):
    for part in range(rng.randrange(3, 10)):
        cx, cy = 60 * (part % 3), 60 * (part // 3)
        shape = outline(rng, rng.uniform(5, 25), rng.randrange(2, 8), 900)
        points = simplified([(cx + x, cy + y, -2.0) for x, y in shape], rng.choice([0.001, 0.005, 0.02]))
        program.path(points)
        program.rapid(cx, cy, -2)
        program.move(cx + 2, cy)
        for _ in range(2):
            program.arc("G3", cx - 2, cy, -2, 0)
            program.arc("G3", cx + 2, cy, 2, 0)


STYLES = [raster, waterlines, adaptive, letters, gear, spiral, short, sharp, relief, contours]


def text_of(number, seed):
    """The program of this number, and its style."""
    style = STYLES[number % len(STYLES)]
    rng = random.Random(f"{seed} {number}")
    program = Program(rng)
    style(rng, program)
    return program.text(), style.__name__


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--programs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for number in range(options.programs):
        text, style = text_of(number, options.seed)
        (options.folder / f"{number:04}_{style}.nc").write_text(text)


if __name__ == "__main__":
    main()
