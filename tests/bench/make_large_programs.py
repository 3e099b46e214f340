#!/usr/bin/env python3
"""make_large_programs.py FOLDER [KIND...] [--blocks N]

Writes programs of N blocks (default 1,000,000) with steps of about 0.1 mm, for measurements of speed:

  spiral    one run: a planar spiral whose radius waves
  circle    one circle as chords, one closed run
  circles   concentric circles as chords, a rapid between two of them
  raster3d  a zigzag in XZ planes over a wavy surface, one run
  relief    the same surface in rows of 200 blocks, a retract and a rapid between two of them

Coordinates have four decimals (mm), as a CAM system writes them. Same bytes every time."""
import argparse
import math
import os

STEP = 0.1  # mm
HEAD = "%\nG21 G90 G17 G94\nM3 S12000\nG0 Z5\n"
TAIL = "G0 Z5\nM5\nM30\n%\n"


def spiral(blocks):
    """Radius grows 0.5 mm a turn and waves by 0.3 mm, seven times a turn."""
    angle = 0.0
    yield "G0 X10 Y0\nG1 Z-1 F1500\n"
    for _ in range(blocks):
        mean = 10 + 0.5 * angle / (2 * math.pi)
        angle += STEP / mean
        radius = mean + 0.3 * math.sin(7 * angle)
        yield f"X{radius * math.cos(angle):.4f} Y{radius * math.sin(angle):.4f}\n"


def circle(blocks):
    """As wide as its chords ask for."""
    radius = STEP * blocks / (2 * math.pi)
    yield f"G0 X{radius:.4f} Y0\nG1 Z-1 F1500\n"
    for i in range(1, blocks + 1):
        angle = 2 * math.pi * i / blocks
        yield f"X{radius * math.cos(angle):.4f} Y{radius * math.sin(angle):.4f}\n"


def circles(blocks):
    """Radii from 5 mm on in steps of 0.5 mm."""
    left, radius = blocks, 5.0
    while left > 0:
        chords = min(left, math.ceil(2 * math.pi * radius / STEP))
        yield f"G0 Z1\nG0 X{radius:.4f} Y0\nG1 Z-1 F1500\n"
        for i in range(1, chords + 1):
            angle = 2 * math.pi * i / math.ceil(2 * math.pi * radius / STEP)
            yield f"X{radius * math.cos(angle):.4f} Y{radius * math.sin(angle):.4f}\n"
        left, radius = left - chords, radius + 0.5


def height(x, y):
    """A wavy surface."""
    return 2 * math.sin(0.15 * x) * math.cos(0.1 * y) + 0.5 * math.sin(0.7 * x + 0.3 * y)


def raster3d(blocks):
    """Rows of 1000 blocks along X, 0.2 mm apart, there and back."""
    row_blocks = 1000
    yield f"G0 X0 Y0\nG1 Z{height(0, 0):.4f} F3000\n"
    written, row = 0, 0
    while written < blocks:
        y = 0.2 * row
        for i in range(min(row_blocks, blocks - written)):
            x = STEP * (i if row % 2 == 0 else row_blocks - 1 - i)
            yield f"X{x:.4f} Y{y:.4f} Z{height(x, y):.4f}\n"
        written, row = written + row_blocks, row + 1


def relief(blocks):
    """Rows of 200 blocks with all that belongs to them, 0.2 mm apart, all in one direction."""
    row_blocks = 200
    for row in range(blocks // row_blocks):
        y = 0.2 * (row % 1000)
        rows = [f"G0 X0.0000 Y{y:.4f}\nG1 Z{height(0, y):.4f} F1500\n"]
        for i in range(1, row_blocks - 2):
            x = STEP * i
            rows.append(f"X{x:.4f} Y{y:.4f} Z{height(x, y):.4f}\n")
        rows.append("G0 Z5\n")
        yield "".join(rows)


KINDS = {"spiral": spiral, "circle": circle, "circles": circles, "raster3d": raster3d,
         "relief": relief}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--blocks", type=int, default=1_000_000)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(KINDS))
    args = parser.parse_args()
    os.makedirs(args.folder, exist_ok=True)
    for kind in args.kinds or KINDS:
        path = os.path.join(args.folder, f"{kind}_{args.blocks}.ngc")
        with open(path, "w", encoding="ascii") as file:
            file.write(HEAD)
            file.writelines(KINDS[kind](args.blocks))
            file.write(TAIL)
        print(path)


main()
