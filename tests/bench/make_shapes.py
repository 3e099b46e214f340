#!/usr/bin/env python3
"""make_shapes.py DIR: small programs that each try one rule of a control's planner: sharp
corners, corners between lines and arcs, tangent slots, helices, reversals, random chains."""
import math
import os
import random
import sys

HEAD = "G21 G17 G40 G49 G80 G90 G94\nG64 P0.01\nF9000\nG0 X0 Y0\nG1 Z0\n"
TAIL = "G0 Z10\nM2\n"  # the rapid lets the last move brake with its full acceleration


def square():
    return "G1 X10 Y0\nX10 Y10\nX0 Y10\nX0 Y0\n" * 5


def zigzag():
    return "".join("G1 X%g Y%g\n" % (0.5 * i, 0.25 * (i % 2)) for i in range(1, 200))


def slots():
    return "".join("G1 X20 Y%g\nG3 X20 Y%g J2\nG1 X0 Y%g\nG2 X0 Y%g J2\n"
                   % (8 * k, 8 * k + 4, 8 * k + 4, 8 * k + 8) for k in range(6))


def lines_and_arcs():
    return "".join("G1 X%g Y0\nG2 X%g Y0 I3 J0\nG1 X%g Y2\nX%g Y0\n"
                   % (10 * k + 2, 10 * k + 8, 10 * k + 9, 10 * k + 10) for k in range(6))


def scallops():
    return "".join("G3 X%g Y0 I2 J1\n" % (4 * (k + 1)) for k in range(8))


def helix():
    return "G3 X0 Y0 Z-2 I5 J0\nG3 X0 Y0 Z-4 I5 J0\nG3 X0 Y0 Z-6 I5 J0\nG1 X3 Z-6\n"


def star():
    return "".join("G1 X%.4f Y%.4f\nX0 Y0\n" % (6 * math.cos(0.7 * i), 6 * math.sin(0.7 * i))
                   for i in range(20))


def random_lines():
    r = random.Random(3)
    text, x, y, z, heading = "", 0.0, 0.0, 0.0, 0.0
    for _ in range(400):
        heading += r.gauss(0, 0.35)
        length = r.choice([0.05, 0.2, 0.8, 2.5])
        x += length * math.cos(heading)
        y += length * math.sin(heading)
        z += length * r.gauss(0, 0.03)
        text += "G1 X%.4f Y%.4f Z%.4f\n" % (x, y, z)
    return text


def kinked_arcs():
    """Lines and arcs that meet at small angles, about 9 degrees."""
    r = random.Random(3)
    text, x, y, heading = "", 0.0, 0.0, 0.0
    for k in range(200):
        heading += r.gauss(0, 0.15)
        if k % 4 == 3:
            length = r.uniform(0.5, 4)
            x += length * math.cos(heading)
            y += length * math.sin(heading)
            text += "G1 X%.4f Y%.4f\n" % (x, y)
            continue
        radius, sweep, side = r.uniform(1, 8), r.uniform(0.2, 1.5), r.choice([1, -1])
        cx, cy = x - side * radius * math.sin(heading), y + side * radius * math.cos(heading)
        i, j = cx - x, cy - y
        heading += side * sweep
        x = round(cx + side * radius * math.sin(heading), 5)
        y = round(cy - side * radius * math.cos(heading), 5)
        text += "G%d X%.5f Y%.5f I%.5f J%.5f\n" % (3 if side > 0 else 2, x, y, i, j)
    return text


SHAPES = [square, zigzag, slots, lines_and_arcs, scallops, helix, star, random_lines, kinked_arcs]

if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    os.makedirs(sys.argv[1], exist_ok=True)
    for shape in SHAPES:
        with open(os.path.join(sys.argv[1], shape.__name__ + ".ngc"), "w") as f:
            f.write(HEAD + shape() + TAIL)
