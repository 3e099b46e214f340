"""Paths as chains of points in mm, and whether two can be travelled together.

Arcs and curves are cut into chords that leave them by CHORD_ERROR at most. No code of Batten."""

import math

CHORD_ERROR = 0.0003  # mm


def arc_points(start, end, centre, axes, turn, turns=1):
    """Points behind `start`, the last one `end`. Angle, radius and height change evenly."""
    i, j, k = axes
    ax, ay = start[i] - centre[0], start[j] - centre[1]
    bx, by = end[i] - centre[0], end[j] - centre[1]
    radius, growth = math.hypot(ax, ay), math.hypot(bx, by) - math.hypot(ax, ay)
    first = math.atan2(ay, ax)
    sweep = turn * (math.atan2(by, bx) - first) % (2 * math.pi)
    if math.hypot(ax - bx, ay - by) < 1e-7:
        sweep = 2 * math.pi
    sweep += 2 * math.pi * (turns - 1)
    count = min(4000, max(2, int(sweep * math.sqrt(max(radius, 1e-9) / 8 / CHORD_ERROR)) + 1))
    points = []
    for n in range(1, count):
        part = n / count
        about, at = first + turn * sweep * part, radius + growth * part
        point = [0.0, 0.0, 0.0]
        point[i] = centre[0] + at * math.cos(about)
        point[j] = centre[1] + at * math.sin(about)
        point[k] = start[k] + (end[k] - start[k]) * part
        points.append(tuple(point))
    return points + [tuple(end)]


def centre_by_radius(start, end, radius, axes, turn):
    """None where the radius does not reach. A negative radius is the longer arc."""
    i, j, _ = axes
    dx, dy = end[i] - start[i], end[j] - start[j]
    chord = math.hypot(dx, dy)
    if chord == 0 or chord > 2 * abs(radius) + 0.01:
        return None
    height = math.sqrt(max(0.0, radius * radius - chord * chord / 4)) / chord
    side = turn if radius > 0 else -turn
    return (start[i] + dx / 2 - side * dy * height, start[j] + dy / 2 + side * dx * height)


def cubic_points(b0, b1, b2, b3):
    """Of a Bezier curve, behind b0."""
    bend = max(math.dist([2 * q for q in b], [p + r for p, r in zip(a, c)])
               for a, b, c in ((b0, b1, b2), (b1, b2, b3)))
    count = max(1, int(math.sqrt(0.75 * bend / CHORD_ERROR)) + 1)
    points = []
    for n in range(1, count + 1):
        t, s = n / count, 1 - n / count
        points.append(tuple(s * s * s * a + 3 * s * s * t * b + 3 * s * t * t * c + t * t * t * d
                            for a, b, c, d in zip(b0, b1, b2, b3)))
    return points


def off_chord(p, a, b):
    """The distance of p from the line between a and b."""
    along = [y - x for x, y in zip(a, b)]
    square = math.fsum(v * v for v in along)
    t = math.fsum(v * (z - x) for v, z, x in zip(along, p, a)) / square if square > 0 else 0.0
    t = min(1.0, max(0.0, t))
    return math.dist(p, [x + t * v for x, v in zip(a, along)])


def chords(at, low, high):
    """Points of the curve at(u), u from low to high, behind the first one: chords are halved until the
    curve is near enough at three places of each."""
    points = []

    def add(u, p, v, q, depth):
        inner = [at(u + (v - u) * n / 4) for n in (1, 2, 3)]
        if depth < 12 and max(off_chord(x, p, q) for x in inner) > CHORD_ERROR / 2:
            middle = u + (v - u) / 2
            add(u, p, middle, inner[1], depth + 1)
            add(middle, inner[1], v, q, depth + 1)
        else:
            points.append(q)

    places = [low + (high - low) * n / 4 for n in range(5)]
    for u, v in zip(places, places[1:]):
        add(u, at(u), v, at(v), 0)
    return points


def nurbs_points(order, control, weights, knots):
    """Of a clamped NURBS, behind its first point: de Boor in homogeneous coordinates."""
    points = []
    homogeneous = [tuple(w * x for x in p) + (w,) for p, w in zip(control, weights)]

    def at(u):
        d = homogeneous[span - order + 1:span + 1]
        for r in range(1, order):
            for j in range(order - 1, r - 1, -1):
                a, b = knots[span - order + 1 + j], knots[span + 1 + j - r]
                t = (u - a) / (b - a) if b > a else 0.0
                d[j] = tuple((1 - t) * p + t * q for p, q in zip(d[j - 1], d[j]))
        return tuple(x / d[-1][3] for x in d[-1][:3])

    for span in range(order - 1, len(control)):
        if knots[span] < knots[span + 1]:
            points += chords(at, knots[span], knots[span + 1])
    return points


def polynomial_points(axes, denominator):
    """Of sums a0 + a1 t + a2 t^2 .. over another, t from 0 to 1, behind t = 0; None where the denominator
    is not above zero everywhere."""
    value = lambda a, t: math.fsum(x * t ** k for k, x in enumerate(a))  # noqa: E731
    if min(value(denominator, n / 1000) for n in range(1001)) <= 0:
        return None
    return chords(lambda t: tuple(value(a, t) / value(denominator, t) for a in axes), 0.0, 1.0)


def extent(points):
    """Not less than the greatest distance from the first point."""
    return max(math.dist(points[0], p) for p in points)


def free(a, b, p, reach):
    """The parameters of the line from a to b that are within `reach` of p, or None."""
    x, y, z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    u, v, w = a[0] - p[0], a[1] - p[1], a[2] - p[2]
    square = x * x + y * y + z * z
    rest = u * u + v * v + w * w - reach * reach
    if square < 1e-24:
        return (0.0, 1.0) if rest <= 0 else None
    half = x * u + y * v + z * w
    root = half * half - square * rest
    if root < 0:
        return None
    root = math.sqrt(root)
    low, high = max(0.0, (-half - root) / square), min(1.0, (-half + root) / square)
    return (low, high) if low <= high else None


def together(p, q, reach):
    """Whether both chains can be travelled from start to end, neither turning back, never further
    than `reach` apart: what can be reached in the free space of both, cell by cell [Alt and Godau 1995]."""
    if math.dist(p[0], q[0]) > reach or math.dist(p[-1], q[-1]) > reach:
        return False
    p, q = (chain * 2 if len(chain) == 1 else chain for chain in (p, q))
    left = {}  # cell of q: what can be reached of its left side
    for j in range(len(q) - 1):
        side = free(q[j], q[j + 1], p[0], reach)
        if side is None or side[0] > 0:
            break
        left[j] = side
        if side[1] < 1:
            break
    below = (0.0, 0.0)
    for i in range(len(p) - 1):
        right, low = {}, None
        side = free(p[i], p[i + 1], q[0], reach)
        # The bottom row is reached only along itself.
        if below is not None and side is not None and side[0] <= 0:
            low = side
        below = low if low is not None and low[1] >= 1 else None
        j = 0 if low is not None else min(left, default=len(q))
        while j < len(q) - 1:
            entry = left.get(j)
            if entry is None and low is None:
                later = [n for n in left if n > j]
                if not later:
                    break
                j = min(later)
                continue
            exit_side, top = free(q[j], q[j + 1], p[i + 1], reach), free(p[i], p[i + 1], q[j + 1], reach)
            if exit_side is not None:
                begin = exit_side[0] if low is not None else max(exit_side[0], entry[0])
                if begin <= exit_side[1]:
                    right[j] = (begin, exit_side[1])
            if top is not None:
                begin = top[0] if entry is not None else max(top[0], low[0])
                top = (begin, top[1]) if begin <= top[1] else None
            low = top
            j += 1
        left = right
        if not left and below is None:
            return False
    last = left.get(len(q) - 2)
    return last is not None and last[1] >= 1 - 1e-12
