#!/usr/bin/env python3
"""Draws an old and a new program over each other.

    samples/plot.py OLD NEW OUT.png [--magnify 200] [--around X Y SIZE]

Left: the old path in grey with its vertices, the new one in colour with its distance from the old
path magnified, in the plane in which the paths are largest. Right, over the length of the cut: the
distance, and the curvature before and after (circle through three neighbouring vertices of lines,
1/radius of arcs). --around shows a window of the left picture only.

Reads what the samples use: G0-G3 with I J K, G17-G19, G20/G21, G90/G91. It is no proof; that is
`batten verify`. Needs matplotlib (Debian: apt-get install python3-matplotlib).
"""

import argparse
import math
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

WORD = re.compile(r"([A-Z])\s*([-+]?[0-9]*\.?[0-9]+)")
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
ARC_STEP = math.radians(2)  # between points of an arc, at the most
ARC_SAGITTA = 1e-4  # mm by which an arc's drawn chords leave it: far below what is to be seen
STEP = 0.05  # mm between the places at which the new path is looked at


class Piece:
    """One cutting move: its points (both ends), and the curvature of an arc."""

    def __init__(self, points, curvature=None):
        self.points = points
        self.curvature = curvature


def arc_points(start, end, centre, clockwise, plane):
    a, b, c = PLANES[plane]
    radius0 = math.hypot(start[a] - centre[a], start[b] - centre[b])
    radius1 = math.hypot(end[a] - centre[a], end[b] - centre[b])
    angle0 = math.atan2(start[b] - centre[b], start[a] - centre[a])
    sweep = math.atan2(end[b] - centre[b], end[a] - centre[a]) - angle0
    if clockwise:
        sweep = -(-sweep % (2 * math.pi) or 2 * math.pi)
    else:
        sweep = sweep % (2 * math.pi) or 2 * math.pi
    chord = 2 * math.sqrt(2 * ARC_SAGITTA / max(radius0, 1e-3))
    count = max(2, math.ceil(abs(sweep) / min(ARC_STEP, chord)))
    points = []
    for i in range(count + 1):
        part = i / count
        point = np.zeros(3)
        radius = radius0 + (radius1 - radius0) * part
        point[a] = centre[a] + radius * math.cos(angle0 + sweep * part)
        point[b] = centre[b] + radius * math.sin(angle0 + sweep * part)
        point[c] = start[c] + (end[c] - start[c]) * part
        points.append(point)
    return points, 1 / max(radius0, 1e-9)


def chains_of(file):
    """Chains of cutting moves between rapids, each a list of pieces, in mm."""
    place, unit, plane, motion, absolute = np.zeros(3), 1.0, 17, 0, True
    chains, chain = [], []
    with open(file, encoding="latin-1") as lines:
        for line in lines:
            text = re.sub(r"\([^)]*\)|;.*", "", line).upper()
            axes, offset = {}, np.zeros(3)
            for letter, digits in WORD.findall(text):
                value = float(digits)
                if letter == "G":
                    if value in (0, 1, 2, 3):
                        motion = int(value)
                    elif value in (17, 18, 19):
                        plane = int(value)
                    elif value in (20, 21):
                        unit = 25.4 if value == 20 else 1.0
                    elif value in (90, 91):
                        absolute = value == 90
                elif letter in "XYZ":
                    axes["XYZ".index(letter)] = value * unit
                elif letter in "IJK":
                    offset["IJK".index(letter)] = value * unit
            if not axes:
                continue
            end = place.copy()
            for axis, value in axes.items():
                end[axis] = value if absolute else place[axis] + value
            if motion == 0:
                if chain:
                    chains.append(chain)
                chain = []
            elif motion == 1:
                if not np.array_equal(place, end):
                    chain.append(Piece([place, end]))
            else:
                points, curvature = arc_points(place, end, place + offset, motion == 2, plane)
                chain.append(Piece(points, curvature))
            place = end
    return chains + ([chain] if chain else [])


def points_of(chain):
    return np.array([chain[0].points[0]] + [p for piece in chain for p in piece.points[1:]])


def curvature_steps(chain):
    """Lengths along the chain and curvatures there."""
    along, at, value = 0.0, [], []
    for i, piece in enumerate(chain):
        points = np.array(piece.points)
        length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        if piece.curvature is not None:
            at += [along, along + length]
            value += [piece.curvature] * 2
        elif i > 0 and chain[i - 1].curvature is None:
            a, b, c = chain[i - 1].points[0], piece.points[0], piece.points[-1]
            sides = [np.linalg.norm(b - a), np.linalg.norm(c - b), np.linalg.norm(c - a)]
            area = np.linalg.norm(np.cross(b - a, c - a))
            product = sides[0] * sides[1] * sides[2]
            at.append(along)
            value.append(2 * area / product if product > 0 else 0)
        along += length
    return np.array(at), np.array(value)


def densified(points):
    dense = []
    for a, b in zip(points[:-1], points[1:]):
        count = max(1, math.ceil(np.linalg.norm(b - a) / STEP))
        dense += [a + (b - a) * i / count for i in range(count)]
    return np.array(dense + [points[-1]])


def nearest_on(old, places):
    """For each place the nearest point of the chain `old`, going forward along it."""
    starts, steps = old[:-1], np.diff(old, axis=0)
    squares = np.maximum((steps**2).sum(axis=1), 1e-18)
    ends = np.concatenate(([0], np.cumsum(np.sqrt(squares))))
    found, at = [], 0
    for place in places:
        # Not farther ahead than 10 mm: elsewhere the path may come by again.
        first, last = max(0, at - 2), np.searchsorted(ends, ends[at + 1] + 10.0) + 1
        s, d, q = starts[first:last], steps[first:last], squares[first:last]
        t = np.clip(((place - s) * d).sum(axis=1) / q, 0, 1)
        candidates = s + t[:, None] * d
        best = int(np.argmin(((candidates - place) ** 2).sum(axis=1)))
        found.append(candidates[best])
        at = max(at, first + best)
    return np.array(found)


def widest_plane(points):
    spans = np.ptp(points, axis=0)
    axes = sorted(np.argsort(spans)[1:])
    return axes[0], axes[1]


def draw(args):
    old_chains, new_chains = chains_of(args.old), chains_of(args.new)
    if len(old_chains) != len(new_chains):
        raise SystemExit(f"{len(old_chains)} chains of cuts, and {len(new_chains)} in the new program")
    figure = plt.figure(figsize=(16, 8))
    left = figure.add_subplot(1, 2, 1)
    distance_axes = figure.add_subplot(2, 2, 2)
    curvature_axes = figure.add_subplot(2, 2, 4, sharex=distance_axes)

    a, b = widest_plane(np.vstack([points_of(chain) for chain in old_chains]))
    before, worst = 0.0, 0.0
    for i, (old_chain, new_chain) in enumerate(zip(old_chains, new_chains)):
        old, new = points_of(old_chain), densified(points_of(new_chain))
        nearest = nearest_on(old, new)
        shown = nearest + (new - nearest) * args.magnify
        distance = np.linalg.norm(new - nearest, axis=1)
        worst = max(worst, distance.max())
        label = lambda text: text if i == 0 else None  # noqa: E731
        left.plot(old[:, a], old[:, b], ".-", color="0.6", lw=0.8, ms=2, label=label("old"))
        left.plot(shown[:, a], shown[:, b], color="C0", lw=0.9,
                  label=label(f"new, distance {args.magnify:g} times"))
        along = np.concatenate(([0], np.cumsum(np.linalg.norm(np.diff(new, axis=0), axis=1))))
        distance_axes.plot(before + along, distance * 1000, color="C0", lw=0.7)
        for chain, color, name in ((old_chain, "0.6", "old"), (new_chain, "C0", "new")):
            at, value = curvature_steps(chain)
            curvature_axes.plot(before + at, value, color=color, lw=0.7, label=label(name))
        before += along[-1]
    left.set_aspect("equal")
    left.set_xlabel("XYZ"[a] + " mm")
    left.set_ylabel("XYZ"[b] + " mm")
    left.legend(loc="upper right")
    if args.around:
        x, y, size = args.around
        left.set_xlim(x - size / 2, x + size / 2)
        left.set_ylim(y - size / 2, y + size / 2)
    distance_axes.set_ylabel("distance from the old path, µm")
    distance_axes.set_title(f"greatest distance {worst * 1000:.1f} µm (by samples)")
    curvature_axes.set_yscale("symlog", linthresh=0.01)
    curvature_axes.set_ylim(bottom=0)
    curvature_axes.set_ylabel("curvature, 1/mm")
    curvature_axes.set_xlabel("length of the cut, mm")
    curvature_axes.legend(loc="upper right")
    figure.tight_layout()
    figure.savefig(args.out, dpi=100)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("out")
    parser.add_argument("--magnify", type=float, default=200)
    parser.add_argument("--around", type=float, nargs=3, metavar=("X", "Y", "SIZE"))
    draw(parser.parse_args())


if __name__ == "__main__":
    main()
