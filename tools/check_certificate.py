#!/usr/bin/env python3
"""check_certificate.py OLD NEW CERTIFICATE --control NAME --tolerance MM
                        [--units mm|inch] [--added-line TEXT ..] [--quiet]

Does the program NEW follow the path of the program OLD within the tolerance, in order and both
ways, and do everything else that OLD does? CERTIFICATE names the lines that differ and how their
two paths are passed together; nothing of it is believed. Needs Python 3.9 alone: no Batten.

--control     how the programs are read: linuxcnc, grbl, fanuc, siemens, heidenhain
--tolerance   in mm; the paths may be as far apart as this and no further
--units       of programs that do not say them
--added-line  a line that NEW may have besides, as a shop's profile adds them (repeat for others)

Exit code 0: certified. 1: not certified, with the line and the reason. 2: wrong call, no such file.

All lengths are whole numbers of a step of 1e-9 mm or less, so that every printed number is exact.
docs/certificates.md says what is proved, and under which reading of the control."""

import argparse
import ast
import copy
import hashlib
import itertools
import math
import operator
import re
import sys
import types
from fractions import Fraction

PLACES = 1 << 30  # a place on a chord is a whole number of these parts of it
KNOWN_OFF = ("cutter compensation", "scaling", "mirroring", "rotation", "polar coordinates",
             "diameter mode", "modal macro", "tool centre point control", "cylinder interpolation")
OPERATIONS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
              ast.UAdd: operator.add, ast.USub: operator.sub}
CHORD_SHARES = (Fraction(1, 300), Fraction(1, 5000), Fraction(1, 50000))  # of the tolerance: errors of chords

class Refused(Exception):
    """Why there is no certification; the line is added by those who know it."""
def refuse_if(wrong, why):
    if wrong:
        raise Refused(why)

# --- numbers -------------------------------------------------------------------------------------
class Scale:
    """Printed numbers as whole steps: 10^digits of them are a millimetre."""
    def __init__(self, texts):
        longest = max((len(m) for text in texts for m in re.findall(r"\.(\d+)", text)), default=0)
        self.digits = max(9, (longest + 1) * (2 if "[" in texts[0] else 1))
        self.per_mm = 10 ** self.digits

    def length(self, text, inch):
        whole, _, part = text.partition(".")
        number = int(whole + part) if whole.strip("+-") + part else 0
        return number * (254 * 10 ** (self.digits - len(part) - 1) if inch else 10 ** (self.digits - len(part)))

def decimal_of(expression):
    """The text of its value, exactly; nothing where it is none of + - * / or has too many digits."""
    def value_of(node):
        if isinstance(node, ast.UnaryOp):
            return OPERATIONS[type(node.op)](0, value_of(node.operand))
        if isinstance(node, ast.BinOp):
            return OPERATIONS[type(node.op)](value_of(node.left), value_of(node.right))
        return Fraction(repr(node.value))
    try:
        value = value_of(ast.parse(re.sub(r"(?<![\d.])0+(?=\d)", "", expression), mode="eval").body)
    except (SyntaxError, AttributeError, KeyError, ValueError, ZeroDivisionError):
        return None
    digits = next((n for n in range(9) if 10 ** n % value.denominator == 0), None)
    return None if digits is None else f"{'-' * (value < 0)}{abs(value) // 1}." + str(
        int(abs(value) % 1 * 10 ** digits)).rjust(digits, "0")

def root_up(square):
    """The least whole number that is not below the root."""
    return math.isqrt(square - 1) + 1 if square > 0 else 0

def round_up(number):
    return -((-number) // 1)

# --- paths: pieces to chords ---------------------------------------------------------------------
# A piece is a tuple: ("line", start, end); ("arc", start, end, centre, axes, turn, slack) with the axes (i, j, k) of
# its plane, turn 1 for counter-clockwise and the slack of a rounded centre; ("cubic", b0, b1, b2, b3). Points are
# lists of three whole numbers or, of cubics, fractions.

def arc_chords(piece, most_error):
    """Points from start to end, near the arc, and for each chord how far the arc may be from it.

    The arc is the curve whose angle, radius and height all change evenly from start to end. Angles
    are bounded by t - t^3/3 + t^5/5 - t^7/7 <= atan t <= t - t^3/3 + t^5/5, exactly."""
    _, start, end, centre, (i, j, k), turn, slack = piece
    ax, ay = start[i] - centre[0], start[j] - centre[1]
    bx, by = end[i] - centre[0], end[j] - centre[1]
    r0, r1 = math.isqrt(ax * ax + ay * ay), math.isqrt(bx * bx + by * by)
    refuse_if(min(r0, r1) < 1000, "an arc without a radius")
    cross, dot = turn * (ax * by - ay * bx), ax * bx + ay * by
    full = start[i] == end[i] and start[j] == end[j]
    angle = 2 * math.pi if full else math.atan2(cross, dot) % (2 * math.pi)
    if not 1e-6 < angle < 2 * math.pi - 1e-6 and not full:
        raise Refused("an arc so short that it may be taken for a full circle, or the other way round")
    radius, growth, rise = max(r0, r1), abs(r1 - r0) + 2, end[k] - start[k]
    step = min(0.3, math.sqrt(8 * float(most_error) / radius))
    count = max(1, math.ceil(angle / step))
    first, points = math.atan2(ay, ax), [start]
    for n in range(1, count):
        part = n / count
        about, at = first + turn * angle * part, r0 + (r1 - r0) * part
        point = [0, 0, 0]
        point[i] = centre[0] + round(at * math.cos(about))
        point[j] = centre[1] + round(at * math.sin(about))
        points.append(point)
    points.append(end)
    # Rigorous from here on: the points are where they are, however they were found.
    fine = 1 << 50
    angles, sum_of_tangents, greatest = [], 0, 0
    ux, uy = ax, ay
    for point in points[1:]:
        vx, vy = point[i] - centre[0], point[j] - centre[1]
        cross_n, dot_n = turn * (ux * vy - uy * vx), ux * vx + uy * vy
        refuse_if(cross_n <= 0 or dot_n <= 2 * cross_n, "an arc that is too small to be cut into chords")
        t = cross_n * fine // dot_n
        t3 = t * t // fine * t // fine
        t5 = t3 * t // fine * t // fine
        angles.append(t - t3 // 3 + t5 // 5)
        sum_of_tangents += t + 1
        greatest = max(greatest, t + 1)
        ux, uy = vx, vy
    # No turn too many: the tangents bound the angle from above.
    most = 2 * math.pi if cross > 0 and not full else 9
    refuse_if(sum_of_tangents > most * fine * 0.999, "an arc whose angle is not certain")
    whole = sum(angles)
    unsure = 2 * Fraction(greatest, fine) ** 6 / 7 + Fraction(8 * count, whole)
    radial = round_up(growth * unsure) + 4 + slack
    upright = round_up(abs(rise) * unsure) + 2
    offs, passed = [slack], 0
    for n in range(1, count):
        passed += angles[n - 1]
        point = points[n]
        point[k] = start[k] + rise * passed // whole
        vx, vy = point[i] - centre[0], point[j] - centre[1]
        expected = r0 + (r1 - r0) * passed // whole
        offs.append(abs(math.isqrt(vx * vx + vy * vy) - expected) + radial + upright)
    offs.append(slack)
    # |second derivative by the angle| <= r + 2 |dr/dangle|; a chord is off by angle^2 / 8 of it.
    bend = radius + 2 + round_up(Fraction(2 * growth * fine, whole) * Fraction(101, 100))
    errors = [round_up(Fraction((a + 4) * (a + 4) * 102 * bend, 800 * fine * fine)) + 1 +
              max(offs[n], offs[n + 1]) for n, a in enumerate(angles)]
    return points, errors

def cubic_chords(piece, most_error):
    """A chord in equal steps of the parameter is off by at most 3/4 of the greatest second
    difference of the control points, over the number of steps squared."""
    control = piece[1:]
    square = max(sum((control[n][k] - 2 * control[n + 1][k] + control[n + 2][k]) ** 2 for k in range(3))
                 for n in (0, 1))
    bend = root_up(round_up(Fraction(square)))
    count = max(1, root_up(round_up(Fraction(3 * bend, 4) / most_error)))
    points = []
    for n in range(count + 1):
        t, s = n, count - n
        points.append([round((s * s * s * control[0][k] + 3 * s * s * t * control[1][k] +
                              3 * s * t * t * control[2][k] + t * t * t * control[3][k]) /
                             Fraction(count ** 3)) for k in range(3)])
    error = round_up(Fraction(3 * bend, 4 * count * count)) + 2
    return points, [error] * count

class Chords:
    """A chain of pieces as points, an error for each chord, and the first chord of each piece."""
    def __init__(self, pieces, start, most_error):
        self.points, self.errors, self.first = [start], [], []
        for piece in pieces:
            self.first.append(len(self.errors))
            chords = {"arc": arc_chords, "cubic": cubic_chords}.get(piece[0])
            points, errors = chords(piece, most_error) if chords else (piece[1:], [0])
            self.points += points[1:]
            self.errors += errors
        if not self.errors:
            self.points.append(start)
            self.errors.append(0)
        self.first.append(len(self.errors))

    def place(self, piece, part):
        """(chord, parts of PLACES) of a fraction of a piece, the end of the chord before if 0."""
        refuse_if(piece >= len(self.first), "a pair of the certificate is beyond the end of the path")
        if piece == len(self.first) - 1 or part == 0:
            return (self.first[piece] - 1, PLACES) if self.first[piece] > 0 else (0, 0)
        count = self.first[piece + 1] - self.first[piece]
        chord = int(part * count)
        return self.first[piece] + chord, int((part * count - chord) * PLACES)

    def end(self):
        return len(self.errors) - 1, PLACES

# --- passing two paths together ------------------------------------------------------------------
def pass_together(a, b, pairs, tolerance):
    """From pair to pair: each time the nearer of two steps is taken, to the next corner of one chain and to what is
    nearest to it on the chord of the other. Between two stops both run evenly along one chord, so the distance is
    greatest at a stop; chords stand for their arcs by their errors. Returns the greatest bound; refuses where it is
    above the tolerance."""
    pa, pb, ea, eb = a.points, b.points, a.errors, b.errors
    here_a, here_b, na, nb, greatest = 0, 0, 0, 0, 0  # chord, parts

    def at(points, chord, n):
        (px, py, pz), (qx, qy, qz) = points[chord], points[chord + 1]
        return px * PLACES + n * (qx - px), py * PLACES + n * (qy - py), pz * PLACES + n * (qz - pz)

    def nearest(points, chord, to, low, high):
        (px, py, pz), (qx, qy, qz) = points[chord], points[chord + 1]
        x, y, z = qx - px, qy - py, qz - pz
        square = x * x + y * y + z * z
        if square == 0:
            return high
        n = ((to[0] - px * PLACES) * x + (to[1] - py * PLACES) * y + (to[2] - pz * PLACES) * z) // square
        return low if n < low else high if n > high else n

    def square_of(p, q):
        x, y, z = p[0] - q[0], p[1] - q[1], p[2] - q[2]
        return x * x + y * y + z * z

    apart = square_of(at(pa, 0, 0), at(pb, 0, 0))
    for (last_a, end_a), (last_b, end_b) in pairs + [(a.end(), b.end())]:
        if (last_a, end_a) < (here_a, na) or (last_b, end_b) < (here_b, nb):
            raise Refused("the pairs of the certificate go back")
        while True:
            if na == PLACES and here_a < last_a:
                here_a, na = here_a + 1, 0
            if nb == PLACES and here_b < last_b:
                here_b, nb = here_b + 1, 0
            stop_a, stop_b = end_a if here_a == last_a else PLACES, end_b if here_b == last_b else PLACES
            a_waits, b_waits = here_a == last_a and na >= stop_a, here_b == last_b and nb >= stop_b
            if a_waits and b_waits:
                break
            next_a, next_b = at(pa, here_a, stop_a), at(pb, here_b, stop_b)
            if not a_waits:
                to_b = nearest(pb, here_b, next_a, nb, stop_b)
                step_a = square_of(next_a, at(pb, here_b, to_b))
            if not b_waits:
                to_a = nearest(pa, here_a, next_b, na, stop_a)
                step_b = square_of(next_b, at(pa, here_a, to_a))
            error = ea[here_a] + eb[here_b]
            allowed = ((tolerance - error) * PLACES) ** 2 if error <= tolerance else -1
            if b_waits or (not a_waits and step_a <= step_b):
                na, nb, now = stop_a, to_b, step_a
            else:
                na, nb, now = to_a, stop_b, step_b
            if apart > allowed or now > allowed:
                worst = (root_up(max(apart, now)) / PLACES + error) / tolerance
                raise Refused(f"the paths of this run are passed at {worst:.3f} times the tolerance")
            bound = max(apart, now)
            if bound > greatest or error > 0:
                greatest = max(greatest, (root_up(bound) + error * PLACES) ** 2)
            apart = now
    return root_up(greatest) // PLACES + 1 if greatest else 0

# --- what a control remembers --------------------------------------------------------------------
class State:
    """Of the control, as far as lines that are rewritten can depend on it or change it. None: not
    known; axes that no line has named stay None, too."""
    FIELDS = ("place", "motion", "feed", "plane", "absolute", "centres_absolute", "inch",
              "feed_mode", "off", "pole", "speed")
    __slots__ = FIELDS

    def __init__(self, inch):
        # motion: 0 rapid, 1 line, 2 and 3 arcs, "G5" .., "other"; feed: (number, whether the point
        # counts). All but the unit as after power-on.
        self.place, self.motion, self.feed, self.plane, self.absolute = (None, None, None), None, None, 17, True
        self.centres_absolute, self.inch, self.feed_mode = False, inch, 94
        self.off, self.pole, self.speed = frozenset(KNOWN_OFF), None, None

    def forget(self):
        """A line that is not known has acted."""
        for field in self.FIELDS:
            setattr(self, field, None)
        self.place, self.off = (None, None, None), frozenset()

    def differing(self, other):
        return [f for f in self.FIELDS if getattr(self, f) != getattr(other, f)]

def line_of(text):
    """What a line says. `words`: letter, text of the number; `silent`: nothing that acts; `title`: no code that a
    control could follow is in it."""
    return types.SimpleNamespace(words=[], comment="", known=True, number=False, silent=False, sets=False,
                                 computed="[" in text, title=TITLE.match(text) and not CODE.search(text))

AXES, OFFSETS = "XYZ", "IJK"
MOTIONS = {"0": 0, "1": 1, "2": 2, "3": 3}
PLANE_AXES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}

# What the codes do to the state; those that are not here may do anything. "place": the place is
# not known after it; "axes": the places of the axes that it names are not.
CODES = {}
for effect, rows in {
        "plane": {17: "G17", 18: "G18", 19: "G19"}, "inch": {True: "G20", False: "G21"},
        "absolute": {True: "G90", False: "G91"}, "centres_absolute": {True: "G90.1", False: "G91.1"},
        "feed_mode": {93: "G93", 94: "G94", 95: "G95"},
        "off": {"cutter compensation": "G40", "scaling": "G50", "mirroring": "G50.1", "rotation": "G69",
                "polar coordinates": "G15", "diameter mode": "G8", "modal macro": "G67"},
        "on": {"cutter compensation": "G41 G41.1 G42 G42.1", "scaling": "G51", "mirroring": "G51.1 M21 M22",
               "rotation": "G68 G68.2 G68.3", "polar coordinates": "G16", "diameter mode": "G7",
               "tool centre point control": "G43.4 G43.5 M128"},
        "motion": {"other": "G80"},
        "cycle": {None: "G31 G38.2 G38.3 G38.4 G38.5 G33 G33.1 G32 G34 G76 G73 G74 G81 G82 G83 G84 G84.2 G84.3 G85 "
                        "G86 G87 G88 G89"},
        "place": {None: "G10 G28 G30 G43 G43.1 G43.2 G44 G49 G52 G54 G54.1 G55 G56 G57 G58 G59 G59.1 G59.2 G59.3 "
                        "G92 G92.1 G92.2 G92.3 M6 M60 M61"},
        "axes": {None: "G4 G53"},
        "nothing": {None: "G61 G61.1 G64 G60 G62 G97 G98 G99 G5.1 G187 G28.1 G30.1 G96 G11 M0 M1 M3 M4 M5 M7 M8 M9 "
                          "M10 M11 M13 M14 M19 M29 M48 M49 M50 M51 M52 M53 M62 M63 M64 M65 M66 M67 M68"}}.items():
    CODES.update({code: (effect, value) for value, codes in rows.items() for code in codes.split()})
SIEMENS_CODES = {code: ("nothing", None) for code in
                 "G601 G602 G603 G641 G642 G643 G644 G645 G450 G451 G25 G26 G9".split()}
SIEMENS_CODES.update({code: ("place", None) for code in "G500 G505 G506 G507 G508".split()})
SIEMENS_CODES.update({"G70": ("inch", True), "G71": ("inch", False), "G700": ("inch", True),
                      "G710": ("inch", False), "G63": ("cycle", None)})
SIEMENS_NOT = "G7 G8 G74".split()  # other meanings there

# --- reading lines -------------------------------------------------------------------------------
WORD = re.compile(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))")
SIEMENS_WORD = re.compile(r"(CR=|[A-Z]=?)([-+]?(?:\d+\.?\d*|\.\d+))|(FFWON|FFWOF|SOFT|BRISK|STOPRE|COMPOF|COMPON|"
                          r"COMPCAD|COMPCURV|COMPSURF|POLY|DIAMOF|CYCLE832\([^()]*\)|MSG\([^()]*\)|CUT2DF?)|"
                          r"(PO\[[XYZ]\]|PL)=(\([-+\d.,]*\)|[-+]?[\d.]+)")
MESSAGE = re.compile(r"\(\s*(MSG|DEBUG|PRINT|LOG|LOGOPEN|LOGAPPEND|LOGCLOSE|PROBEOPEN|PROBECLOSE)\s*[,)]", re.I)
SCRIPT = re.compile(r"\(\s*PY\s*,|;\s*PY\s*,", re.I)
NEIGHBOURS = re.compile(r"\b(RND|RNDM|CHF|CHR)\b|,\s*[RCA]", re.I)
JUMPS = re.compile(r"\b(GOTO[FBC]?|WHILE|REPEATB?|ENDLOOP|UNTIL)\b|\bM99\s*P|\bM9[78]|G65|G66", re.I)
OWN_COMMENT = re.compile(r"\s*(?:\(Batten: smoothed within [\d.]+ (?:mm|in)\)|"
                         r";\s*Batten: smoothed within [\d.]+ (?:mm|in))\s*$", re.I)
ASSIGNMENT = re.compile(r"(?:N\d+)?#(?:\d{1,3}|<[A-Z_]+>)=[-+*/.\d#\[\]]+")  # of a parameter that is no offset
SETTING = re.compile(r"(?:N\d+)?#([1-9]|[12]\d|30|<[A-Z][A-Z0-9_]*>)=([-+]?(?:\d+\.?\d*|\.\d+))", re.I)
FLOW = re.compile(r"^\s*(N\d+\s*)?O[<\d]", re.I)  # subprograms, conditions, loops
TITLE = re.compile(r"[^#=\[\]$]*$")
CODE = re.compile(r"(?<![A-Z0-9])[GMOT]\s*\d", re.I)

def canonical(letter, number):
    """G01 is G1; 43.10 is none."""
    whole, _, part = number.rstrip("0" if "." in number else "").partition(".")
    return letter + str(int(whole or 0)) + ("." + part if part else "") if whole.isdigit() else ""

def read_words(text, siemens):
    """A line of plain words; of Siemens words."""
    line = line_of(text)
    body, found, rest = text.partition(";")
    line.comment = ";" + rest.strip() if found else ""
    if "(" in body:
        # Behind a Siemens name they are arguments.
        pattern = r"(?<![\w=\]])\([^()]*\)" if siemens else r"\([^()]*\)"
        comments = re.findall(pattern, body)
        line.comment += "".join(comments)
        body = re.sub(pattern, " ", body)
        if any(MESSAGE.match(comment) for comment in comments):
            line.words = [("message", "")]
    line.known = not SCRIPT.search(text)
    body = "".join(body.upper().split())
    line.sets = bool(ASSIGNMENT.fullmatch(body))
    if body in ("", "%") or line.sets:
        line.silent = line.known and not line.words
        return line
    found = list((SIEMENS_WORD if siemens else WORD).finditer(body))
    line.known = line.known and sum(m.end() - m.start() for m in found) == len(body)
    for m in found:
        if m.lastindex == 2:
            line.words.append((m.group(1).rstrip("="), m.group(2)))
        else:
            line.words.append((m.group(4), m.group(5)) if m.group(4) else ("name", m.group(3)))
    if line.words and line.words[0][0] == "N":
        line.number = True
        line.known = line.words.pop(0)[1].isdigit() and line.known
        line.silent = line.known and not line.words
    return line

KLARTEXT_WORD = re.compile(r"(I?[XYZ])([-+]?[\d.,]+)|(DR)([-+])|(R)([0LR])(?![\d.])|(F)(MAX|AUTO|\d+(?:[.,]\d*)?)|(M)(\d+)")
def read_klartext(text):
    """The words of L, CC and C; of other statements only their name."""
    line = line_of(text)
    body, _, rest = text.partition(";")
    line.comment = ";" + rest.strip() if rest else ""
    body = re.sub(r"^\s*\d+(?=\s|$)", "", body.upper()).strip()
    if not body:
        line.silent = True
        return line
    name = body.split()[0]
    line.words = [("name", name)]
    if name in ("L", "CC", "C"):
        body = "".join(body[len(name):].split())
        found = [[group for group in m if group] for m in KLARTEXT_WORD.findall(body)]
        line.words += [(letter, number.replace(",", ".")) for letter, number in found]
        line.known = "".join(letter + number for letter, number in found) == body
    elif name in ("BEGIN", "END", "TOOL", "BLK", "STOP", "CYCL"):
        line.words.append(("rest", " ".join(body.split()[1:])))
    else:
        line.known = False
    return line

# --- following lines -----------------------------------------------------------------------------
class Reader:
    """Follows the lines of one control."""
    def __init__(self, control, scale, old_lines):
        self.control, self.scale, self.values = control, scale, {}
        self.steady = control in ("linuxcnc", "grbl", "siemens") and not any(FLOW.match(line) or JUMPS.search(line) for line in old_lines)
        self.siemens, self.klartext = control == "siemens", control == "heidenhain"
        self.codes = dict(CODES)
        if self.siemens:
            self.codes = {code: does for code, does in CODES.items() if code not in SIEMENS_NOT} | SIEMENS_CODES
        if control == "fanuc":
            self.codes["G5"] = ("nothing", None)
        self.nurbs, self.begun = None, False  # points and knots of a curve; whether words were before

    def read(self, text):
        text = self.with_values(text) if self.steady and (self.values or "#" in text) else text
        return read_klartext(text) if self.klartext else read_words(text, self.siemens)

    def with_values(self, text):
        """With numbers for parameters: lines come as they are run, so that each is what it was last set to."""
        code = "".join(re.sub(r"\([^()]*\)|;.*", "", text).split())
        if SCRIPT.search(text) or "=" in code and not SETTING.fullmatch(code):
            self.values = {}
        elif setting := SETTING.fullmatch(code):
            self.values[setting[1].upper()] = setting[2]
        elif "#" in text:
            text = re.sub(r"(?<![\d.#>])#(\d+|<\w+>)(?![\d.])", lambda name: self.values.get(name[1].upper(), name[0]), text)
            while inner := re.search(r"\[([^\[\]#]*)\]", text):
                value = decimal_of(inner[1])
                if value is None:
                    break
                text = text[:inner.start()] + value + text[inner.end():]
        return text

    def follow(self, line, state, in_run):
        """Moves: ("rapid" or "cut", piece, feed), and the state after the line. False: not known,
        and nothing is known after it. `in_run` refuses all but moves at feed rate."""
        if line.silent:
            return [], True
        inch = state.inch
        try:
            return (self.follow_klartext if self.klartext else self.follow_words)(line, state, in_run), True
        except Refused:
            if in_run:
                raise
            state.forget()
            self.values = {}  # a call may have set any
            if self.klartext:
                state.inch = inch
            return [], False

    def follow_words(self, line, state, in_run):
        if not line.known:
            if not self.begun and not in_run and line.title:
                return []
            raise Refused("an expression: this checker evaluates none" if line.computed else "not understood")
        codes, axes, offsets, others, feed, names = [], {}, {}, {}, None, {}
        for letter, text in line.words:
            if letter == "G" or letter == "M":
                code = canonical(letter, text)
                if code in codes:
                    raise Refused(f"{code} twice")
                codes.append(code)
                continue
            named = letter == "name" or len(letter) > 2
            place = names if named else axes if letter in AXES else offsets if letter in OFFSETS else others
            word = text if letter == "name" else letter
            if word in place or letter == "F" and feed is not None:
                raise Refused(f"{word} twice")
            if letter == "F":
                feed = (Fraction(text), self.control == "fanuc" and "." in text)
            else:
                place[word] = text
        if in_run:
            others.pop("S" if others.get("S") == state.speed else "", None)  # said again
            self.check_run_words(codes, others, names, axes or offsets or names)
        if self.nurbs is not None and (not codes or codes == ["G6.2"]):
            return self.nurbs_line(state, axes, offsets, others)
        motion, effects = None, []
        for code in codes:
            if code == "G6.2" and in_run and self.control == "fanuc":
                state.motion, self.nurbs, state.feed = "G6.2", ([], []), feed if feed is not None else state.feed
                return self.nurbs_line(state, axes, offsets, others)
            if code[0] == "G" and code[1:] in MOTIONS:
                refuse_if(motion is not None, "two motion words")
                motion = MOTIONS[code[1:]]
            elif code == "G5" and self.control == "linuxcnc":
                motion = "G5"
            elif code in self.codes:
                effects.append(self.codes[code])
            elif code[0] == "M" and len(code) >= 4 and code != "M198":
                effects.append(("place", None))  # of the user: may move, knows no modes of ours
            else:
                raise Refused(f"{code} is not known")
        if "POLY" in names:
            refuse_if(motion is not None, "two motion words")
            motion = "POLY"
        if "O" in others and (self.begun or len(others) > 1) or "L" in others and self.siemens:
            raise Refused("another program")
        self.begun = True
        state.speed = None if {"G96", "G97", "G92"} & set(codes) else others.get("S", state.speed)
        kinds = {effect[0] for effect in effects}
        if motion is not None:
            state.motion = motion
        for kind, value in effects:
            if kind in ("off", "on"):
                state.off = state.off | {value} if kind == "off" else state.off - {value}
            elif kind == "cycle":
                state.motion = "other"
            elif kind == "motion" and motion is None:
                state.motion = value
            elif kind in State.FIELDS and kind != "motion":
                setattr(state, kind, value)
        if feed is not None or kinds & {"feed_mode", "inch"}:
            state.feed = feed
        if kinds & {"place", "cycle"} or any(letter in others for letter in "UVW"):
            state.place = (None, None, None)
            return []
        if "axes" in kinds:
            state.place = tuple(None if letter in axes else x for letter, x in zip(AXES, state.place))
            return []
        polynomials = {letter: text for letter, text in names.items() if letter[:2] in ("PO", "PL")}
        if not axes and not offsets and not polynomials:
            return []
        try:
            return self.motion_of(state, axes, offsets, others, polynomials)
        except Refused:
            if in_run:
                raise
            state.place = (None, None, None) if motion == "POLY" else state.place
            return [("unknown", None, None)]

    def check_run_words(self, codes, others, names, goes_on):
        own = {"linuxcnc": ["G5"], "fanuc": ["G6.2"]}.get(self.control, [])
        for code in codes:
            if code not in ["G1", "G2", "G3", "G17", "G18", "G19", "G90", "G91.1"] + own:
                raise Refused(f"{code} among rewritten lines")
        for letter in list(others) + list(names):
            if letter not in ("R", "CR", "P", "Q", "POLY") and letter[:2] not in ("PO", "PL") or not goes_on:
                raise Refused(f"{letter} among rewritten lines")

    def motion_of(self, state, axes, offsets, others, polynomials):
        motion = state.motion
        refuse_if(polynomials and motion != "POLY", "PO without POLY, which runs straight")
        if motion == "other" or motion is None and (offsets or state.absolute is None):
            state.place = (None, None, None)
            return [("unknown", None, None)] if motion is None else []
        start, end = state.place, self.end_of(state, axes)
        if motion == "POLY":
            refuse_if(offsets or others.keys() & {"R", "CR", "P", "Q"}, "words of another curve beside a polynomial")
            return self.polynomial_of(state, start, axes, polynomials)
        state.place = end
        if motion is None:
            return [("unknown", (start, end), None)]
        if motion == 0:
            return [("rapid", (start, end), None)]
        if any(AXES[n] in axes and None in (start[n], end[n]) for n in range(3)):
            return [("unknown", None, state.feed)]
        p, q = ([0 if x is None else x for x in point] for point in (start, end))
        if motion == 1:
            refuse_if(offsets or others.keys() & {"R", "CR", "P", "Q"}, "words of a curve beside a line")
            return [("cut", ("line", p, q), state.feed)] if p != q else []
        if motion == "G5":
            return [("cut", self.g5(state, p, q, axes, offsets, others), state.feed)]
        return [("cut", self.arc(state, p, q, start, offsets, others), state.feed)]

    def length(self, text, state):
        refuse_if(state.inch is None, "the unit is not known")
        if self.control == "fanuc" and "." not in text and Fraction(text) != 0:
            raise Refused(f"{text} has no decimal point: 5 mm or 0.005 mm on this control")
        return self.scale.length(text, state.inch)

    def end_of(self, state, axes):
        end = list(state.place)
        for n, letter in enumerate(AXES):
            if letter in axes:
                try:
                    number = self.length(axes[letter], state)
                    end[n] = number if state.absolute else end[n] + number if state.absolute is False else None
                except (Refused, TypeError):  # the number, the unit or the place is not known
                    end[n] = None
        return tuple(end)

    def arc(self, state, p, q, start, offsets, others):
        refuse_if(state.plane is None or state.centres_absolute is None, "an arc whose plane or centre is not known")
        i, j, k = PLANE_AXES[state.plane]
        refuse_if(start[i] is None or start[j] is None, "an arc from an unknown place")
        if Fraction(offsets.get(OFFSETS[k], "0")) != 0 or others.keys() - {"R", "CR", "F"} & {"P", "Q"}:
            raise Refused("an arc with words of another one")
        turn = 1 if state.motion == 3 else -1
        radius_words = others.keys() & {"R", "CR"}
        if radius_words and not offsets and len(radius_words) == 1:
            radius = self.length(others[radius_words.pop()], state)
            return arc_of_radius(p, q, radius, (i, j, k), turn)
        refuse_if(not offsets or radius_words, "an arc without one centre")
        centre = []
        for axis in (i, j):
            number = self.length(offsets.get(OFFSETS[axis], "0"), state)
            refuse_if(state.centres_absolute and OFFSETS[axis] not in offsets, "an arc without its whole centre")
            centre.append(number if state.centres_absolute else p[axis] + number)
        return self.arc_about(p, q, centre, (i, j, k), turn)

    def arc_about(self, p, q, centre, axes, turn):
        r, s = (math.isqrt(sum((x[n] - c) ** 2 for n, c in zip(axes, centre))) for x in (p, q))
        if abs(r - s) * 1000 > (16 * self.scale.per_mm if self.klartext else max(r, 28 * self.scale.per_mm)):
            raise Refused("an arc whose radii at its ends differ by more than the control takes")
        return ("arc", p, q, centre, axes, turn, 0)

    def g5(self, state, p, q, axes, offsets, others):
        if state.plane != 17 or "Z" in axes or offsets.keys() != {"I", "J"} or not {"P", "Q"} <= others.keys():
            raise Refused("a G5 that is not written whole, or not in XY")
        refuse_if(others.keys() & {"R", "CR"}, "a radius beside a G5")
        shift = lambda text: self.length(text, state)
        b1 = [p[0] + shift(offsets["I"]), p[1] + shift(offsets["J"]), p[2]]
        b2 = [q[0] + shift(others["P"]), q[1] + shift(others["Q"]), p[2]]
        return ("cubic", p, b1, b2, q)

    def nurbs_line(self, state, axes, offsets, others):
        """G06.2: order 4, weights 1, a knot in each line, four lines with a knot alone at the end."""
        points, knots = self.nurbs
        start = [0 if x is None else x for x in state.place]  # of axes that the curve leaves alone
        if offsets.keys() != {"K"} or others.get("P", "4") != "4" or others.keys() - {"P", "R"} or state.inch is None or \
                Fraction(others.get("R", "1")) != 1 or any(state.place[AXES.index(letter)] is None for letter in axes):
            raise Refused("a curve that is not written as one of order 4 without weights")
        knots.append(Fraction(offsets["K"]))
        if axes:
            refuse_if(len(knots) > len(points) + 1, "a curve with a control point behind its last knots")
            points.append([self.length(axes[letter], state) if letter in axes else
                           (points[-1] if points else start)[n] for n, letter in enumerate(AXES)])
            return []
        if len(knots) < len(points) + 4:
            return []
        self.nurbs = None
        if len(points) < 4 or points[0] != start or sorted(knots) != knots or \
                knots[0] != knots[3] or knots[-4] != knots[-1]:
            raise Refused("a curve that does not begin at its place, or whose knots are not clamped")
        state.place = tuple(None if x is None else q for x, q in zip(state.place, points[-1]))
        moves = []
        for i in range(3, len(points)):
            low, high = knots[i], knots[i + 1]
            if low < high:
                control = [blossom(points, knots, i, [low] * (3 - n) + [high] * n) for n in range(4)]
                moves.append(("cut", ("cubic", *control), state.feed))
        return moves

    def polynomial_of(self, state, start, axes, polynomials):
        """POLY of Siemens: end, a2, a3 of each axis; a1 is what the end leaves."""
        if not state.absolute or None in (start[n] for n in range(3) if f"PO[{AXES[n]}]" in polynomials):
            raise Refused("a polynomial from an unknown place")
        refuse_if(Fraction(polynomials.get("PL", "1")) != 1, "PL other than 1")
        control, end = [[], [], [], []], list(start)
        for n, letter in enumerate(AXES):
            a0 = start[n] if start[n] is not None else 0
            if f"PO[{letter}]" in polynomials:
                numbers = [self.length(t, state) for t in polynomials[f"PO[{letter}]"].strip("()").split(",") if t]
                refuse_if(not 1 <= len(numbers) <= 3 or letter in axes, "a polynomial of another kind")
                end[n], a2, a3 = (numbers + [0, 0])[:3]
            else:
                end[n], a2, a3 = self.end_of(state, axes)[n], 0, 0
            last = end[n] if end[n] is not None else 0
            a1 = last - a0 - a2 - a3
            for c, value in zip(control, (a0, a0 + Fraction(a1, 3), a0 + Fraction(2 * a1 + a2, 3), last)):
                c.append(value)
        state.place = tuple(end)
        return [("cut", ("cubic", *control), state.feed)]

    def follow_klartext(self, line, state, in_run):
        name = line.words[0][1]
        words = line.words[1:]
        if in_run and (not line.known or name not in ("L", "CC", "C")):
            raise Refused(f"{name} among rewritten lines")
        rest = words[0][1] if words else ""
        if name in ("BEGIN", "END"):
            state.forget()
            if rest.endswith((" MM", " INCH")):
                state.__init__(rest.endswith(" INCH"))
        elif not line.known or name == "CYCL" and not re.match(r"DEF (32|9)\.\d", rest) or \
                name == "TOOL" and re.match(r"CALL \S+ [XYUVW]", rest):
            raise Refused("not understood")
        elif name == "TOOL" and rest.startswith("CALL"):
            state.place, feed = (None, None, None), re.search(r"\bF(\d+)", rest)
            state.feed = (Fraction(feed.group(1)), False) if feed else state.feed
        axes, others, codes = {}, {}, []
        if name not in ("L", "CC", "C"):
            return []
        for letter, text in words:
            if letter == "M":
                codes.append(int(text))
                continue
            place = axes if letter[-1] in AXES else others
            if letter in place:
                raise Refused(f"{letter} twice")
            place[letter] = text
        if in_run and (codes or others.get("F") in ("MAX", "AUTO") or others.get("R", "0") != "0" or
                       any(letter[0] == "I" for letter in axes)):
            raise Refused("more than moves to places among rewritten lines")
        refuse_if(set(codes) - {0, 1, 2, 3, 4, 5, 6, 8, 9, 13, 14, 30}, "an M function that is not known")
        values = {}
        for letter, text in axes.items():
            n, number = AXES.index(letter[-1]), self.length(text, state)
            here = state.place[n] if letter[0] == "I" else 0
            values[n] = None if here is None else here + number
        if name == "CC":
            refuse_if(axes.keys() != {"X", "Y"} or others, "a pole that is not written whole")
            state.pole = (values[0], values[1])
            return []
        start = state.place
        end = state.place = tuple(values.get(n, start[n]) for n in range(3))
        if "F" in others and others["F"] != "MAX":
            state.feed = (Fraction(others["F"]), False) if others["F"] != "AUTO" else None
        if "R" in others:
            state.off = state.off | {KNOWN_OFF[0]} if others["R"] == "0" else state.off - {KNOWN_OFF[0]}
        state.place = (None, None, None) if 6 in codes else state.place
        if set(codes) & {2, 30}:
            state.forget()
        if set(codes) & {2, 30} or name == "L" and not axes:
            return []
        if others.get("F") == "MAX":
            return [("rapid", (start, end), None)]
        if any(start[n] is None or end[n] is None for n in values):
            return [("unknown", None, state.feed)]
        p, q = ([0 if x is None else x for x in point] for point in (start, end))
        if name == "L":
            return [("cut", ("line", p, q), state.feed)] if p != q else []
        if state.pole is None or None in state.pole or "DR" not in others or None in start[:2]:
            raise Refused("an arc whose centre is not known")
        turn = 1 if others["DR"] == "+" else -1
        return [("cut", self.arc_about(p, q, list(state.pole), (0, 1, 2), turn), state.feed)]

def blossom(points, knots, i, arguments):
    """Of the cubic on the knots from i to i + 1: its control points are those of three arguments."""
    d = points[i - 3:i + 1]
    for level, u in enumerate(arguments, 1):
        for j in range(3, level - 1, -1):
            low, high = knots[i - 3 + j], knots[i + 1 + j - level]
            part = (u - low) / (high - low)
            d[j] = [(1 - part) * x + part * y for x, y in zip(d[j - 1], d[j])]
    return d[3]

def arc_of_radius(p, q, radius, axes, turn):
    """The centre is rounded to a step, so the arc is off by some steps."""
    i, j, _ = axes
    dx, dy = q[i] - p[i], q[j] - p[j]
    square = dx * dx + dy * dy
    left = 4 * radius * radius - square
    if square == 0 or left * 10 ** 6 < square:  # the centre moves far with a last digit of half a turn
        raise Refused("an arc whose radius does not reach, or just for half a turn")
    side = turn if radius > 0 else -turn
    fine = 1 << 40
    height = math.isqrt(left * fine * fine // square)  # times 2 over the chord
    centre = [(2 * p[i] + dx) * fine - side * dy * height, (2 * p[j] + dy) * fine + side * dx * height]
    centre = [(c + fine) // (2 * fine) for c in centre]
    slack = 8 + (abs(dx) + abs(dy)) // fine
    return ("arc", p, q, centre, axes, turn, slack)

# --- the two programs ----------------------------------------------------------------------------
def read_certificate(text, tolerance):
    version, *lines = text.split("\n")
    said = re.fullmatch(r"tolerance ([\d.]+(?:e-?\d+)?) mm", lines[0]) if lines else None
    refuse_if(version != "Batten certificate 1", "the certificate does not begin as one of version 1")
    refuse_if(not said or Fraction(said.group(1)) > tolerance, "the certificate is of another tolerance")
    runs = []
    for line in lines[1:]:
        header = re.fullmatch(r"run (\d+) (\d+) (\d+) (\d+)", line)
        if header:
            numbers = dict(zip(("old", "old_count", "new", "new_count"), map(int, header.groups())))
            runs.append(types.SimpleNamespace(**numbers, words=[]))
            runs[-1].old, runs[-1].new = runs[-1].old - 1, runs[-1].new - 1  # lines from 0
        elif line and not runs:
            raise Refused("pairs before the first run of the certificate")
        elif line:
            runs[-1].words += line.split(" ")
    return runs

PAIR = re.compile(r"(\d+)(?:\.(\d{1,9}))?(?::(\d+)(?:\.(\d{1,9}))?)?(?:\*(\d{1,7}))?")
def pairs_of(words):
    """For each part of one feed: places on both paths, as a piece and a fraction of it."""
    parts, old, new = [[]], 0, 0
    for word in words:
        if word == "/":
            parts, old, new = parts + [[]], 0, 0
            continue
        found = PAIR.fullmatch(word)
        if not found:
            raise Refused(f"'{word[:40]}' is no pair of a certificate")
        onward, part, new_onward, new_part, times = found.groups()
        for _ in range(int(times or 1)):
            old += int(onward)
            new += 1 if new_onward is None else int(new_onward)
            parts[-1].append(((old, Fraction(f".{part or 0}")), (new, Fraction(f".{new_part or 0}"))))
    return parts

def by_feed(moves):
    """Neighbouring cuts of one feed together: feed, pieces."""
    groups = itertools.groupby(moves, key=lambda move: move[2])
    return [(feed, [piece for _, piece, _ in group]) for feed, group in groups]

class Checker:
    def __init__(self, old_lines, new_lines, runs, options, scale):
        self.old_lines, self.new_lines, self.runs = old_lines, new_lines, runs
        self.reader = Reader(options.control, scale, old_lines)
        self.tolerance = int(options.tolerance * scale.per_mm)  # rounded down: stricter
        self.added = set(line.strip() for line in options.added_line)
        # One value while both remember the same.
        self.old = self.new = State(options.units == "inch" if options.units else None)
        self.jumps = any(JUMPS.search(line) for line in old_lines)
        self.i = self.j = self.greatest = self.greatest_line = self.own_comments = self.added_lines = 0
        self.rewritten = [0, 0]
        # The last line that was copied, none behind a run; why the modes are not known, where they are not.
        self.neighbour, self.forgotten = "begin", ""

    def refuse(self, why, i=None, j=None):
        i, j = self.i if i is None else i, self.j if j is None else j
        raise Refused(f"old line {i + 1}, new line {j + 1}: {why}")

    def run(self):
        for run in self.runs:
            self.copy_to(run.old, run.new)
            if self.i + run.old_count > len(self.old_lines) or self.j + run.new_count > len(self.new_lines):
                self.refuse("a run of the certificate goes beyond the end")
            self.check_run(run)
        self.copy_to(len(self.old_lines), len(self.new_lines))
        for field in set(self.old.differing(self.new)) - {"motion", "pole", "place"}:
            self.refuse(f"at the end {field} is {getattr(self.new, field)}, and was {getattr(self.old, field)}")

    def copy_to(self, old_end, new_end):
        if old_end - self.i != new_end - self.j or not self.i <= old_end <= len(self.old_lines) or new_end > len(self.new_lines):
            self.refuse("lines between two runs are not as many in both programs")
        while self.i < old_end:
            text = self.old_lines[self.i]
            if text != self.new_lines[self.j]:
                self.refuse("these lines are in no run, and are not the same bytes")
            self.copy(text)
            self.i += 1
            self.j += 1

    def copy(self, text):
        line = self.reader.read(text)
        if line.silent:
            return
        if not self.neighbour and NEIGHBOURS.search(text):
            self.refuse("a corner behind a run is rounded: its moves count for that")
        self.neighbour = text
        if line.number and self.jumps or text.lstrip().startswith("/"):
            # Control may come from elsewhere; the line may be left out.
            line.known, line.silent, line.title, line.words = False, False, None, [("name", "")]
        if self.old is self.new:
            if not self.reader.follow(line, self.old, False)[1]:
                self.forgotten = f"; line {self.i + 1}, '{text.strip()}', may have changed anything"
            return
        fields = set(self.old.differing(self.new)) - {"pole"}
        old_moves, old_known = self.reader.follow(line, self.old, False)
        new_moves, new_known = self.reader.follow(line, self.new, False)
        if not (old_known and new_known):
            self.refuse(f"'{text.strip()}' is not understood, and the control remembers another "
                        f"{', '.join(sorted(fields)) or 'pole'} there")
        self.compare_copied(old_moves, new_moves)
        # Axis words that are no moves, cycles, modes: they may use what is not the same.
        named = any(letter in AXES for letter, _ in line.words) or self.old.motion == "other"
        codes = [self.reader.codes.get(canonical(*word), ("",))[0] for word in line.words if word[0] in ("G", "M")]
        if not old_moves and named and fields and (fields != {"motion"} or self.old.motion != self.new.motion) or \
                fields - {"motion", "place", "feed", "speed"} and {"on", "cycle", "place", "axes"} & set(codes):
            self.refuse(f"'{text.strip()}' may depend on {', '.join(sorted(fields))}, which is not the same")
        if not self.old.differing(self.new):
            self.new = self.old

    def compare_copied(self, old_moves, new_moves):
        """The same line from two states: the same move, from and to places within the tolerance."""
        if [move[0] for move in old_moves] != [move[0] for move in new_moves]:
            self.refuse("this copied line does not move alike in both programs")
        for (kind, old_piece, old_feed), (_, new_piece, new_feed) in zip(old_moves, new_moves):
            if kind == "unknown" or kind == "cut" and old_feed != new_feed:
                self.refuse("this copied line depends on a mode, a place or a feed that is not the same")
            if old_piece == new_piece:
                continue
            if kind == "cut" and "line" not in (old_piece[0], new_piece[0]):
                self.refuse("this copied arc begins at another place in both programs")
            for p, q in zip(old_piece[-2:], new_piece[-2:]):
                apart = [None if x is y else math.inf if None in (x, y) else x - y for x, y in zip(p, q)]
                if sum(x * x for x in apart if x is not None) > self.tolerance ** 2:
                    self.refuse("this copied line begins or ends too far away")

    def check_run(self, run):
        if NEIGHBOURS.search(self.neighbour):
            self.refuse("a corner before a run is rounded: its moves count for that")
        old, new = self.old, copy.copy(self.old) if self.new is self.old else self.new
        before = [copy.copy(old), copy.copy(new)]
        start = [[0 if x is None else x for x in state.place] for state in before]
        old_moves, old_comments = self.moves_of(self.old_lines, self.i, run.old_count, old, False)
        new_moves, new_comments = self.moves_of(self.new_lines, self.j, run.new_count, new, True)
        if old_comments != new_comments:
            self.refuse("the comments of a run are not the same")
        if before[0].place != before[1].place and None in before[0].place + before[1].place:
            self.refuse("a run begins at a place that is not known")
        for state in before if old_moves or new_moves else []:
            self.check_state(state)
        if bool(old_moves) != bool(new_moves):
            self.refuse("one of the programs does not move in this run")
        if (old_moves or new_moves) and not (run.old_count and run.new_count):
            self.refuse("a run without lines of the other program")
        self.check_paths(run, old_moves, new_moves, start)
        self.rewritten = [self.rewritten[0] + run.old_count, self.rewritten[1] + run.new_count]
        self.i, self.j = self.i + run.old_count, self.j + run.new_count
        self.old, self.new = old, new if old.differing(new) else old
        self.neighbour = ""

    def check_state(self, state):
        on = ", ".join(name for name in KNOWN_OFF if name not in state.off)
        for wrong, why in ((state.absolute is not True, "where places may be incremental"),
                           (state.inch is None, "whose unit is not known; --units says it"),
                           (state.feed_mode not in (94, 95), "where the feed may be an inverse time"),
                           (on, f"where this may be on: {on}")):
            if wrong:
                self.refuse(f"a run {why}{self.forgotten}")

    def moves_of(self, lines, begin, count, state, is_new):
        moves, comments = [], []
        for n in range(begin, begin + count):
            text = lines[n]
            if is_new:
                text, found = OWN_COMMENT.subn("", text)
                self.own_comments += found
                if found and (not text.strip() or text.strip().isdigit()):  # a line of its own
                    continue
            if is_new and text.strip() and text.strip() in self.added:
                self.added_lines += 1
                continue
            where = (None, n) if is_new else (n, None)
            line = self.reader.read(text)
            comments += [line.comment] if line.comment else []
            if line.number and self.jumps or text.lstrip().startswith("/"):
                self.refuse("a line of a run that may be jumped to or left out", *where)
            try:
                found, _ = self.reader.follow(line, state, True)
            except Refused as why:
                self.refuse(f"{why}", *where)
            if line.sets or any(kind != "cut" for kind, _, _ in found):
                self.refuse("a rewritten line that is no move at feed rate between known places", *where)
            moves += found
        if self.reader.nurbs is not None:
            self.refuse("a curve that is not at its end")
        return moves, comments

    def check_paths(self, run, old_moves, new_moves, start):
        old_parts, new_parts = by_feed(old_moves), by_feed(new_moves)
        if [feed for feed, _ in old_parts] != [feed for feed, _ in new_parts]:
            self.refuse("the feeds of a run are not the same, or not in the same order")
        pairs = pairs_of(run.words)
        if len(pairs) != max(1, len(old_parts)):
            self.refuse("the certificate has not the parts of this run")
        for (_, old_pieces), (_, new_pieces), part in zip(old_parts, new_parts, pairs):
            start = self.check_part(old_pieces, new_pieces, part, start)

    def check_part(self, old_pieces, new_pieces, pairs, start):
        bent = any(piece[0] != "line" for piece in old_pieces + new_pieces)
        for share in CHORD_SHARES:
            try:
                a, b = (Chords(pieces, place, self.tolerance * share)
                        for pieces, place in zip((old_pieces, new_pieces), start))
                places = [(a.place(*old), b.place(*new)) for old, new in pairs]
                bound = pass_together(a, b, places, self.tolerance)
                break
            except Refused as why:
                if share == CHORD_SHARES[-1] or not bent:
                    self.refuse(f"{why}")
        if bound > self.greatest:
            self.greatest, self.greatest_line = bound, self.i + 1
        return [list(a.points[-1]), list(b.points[-1])]

# --- the command ---------------------------------------------------------------------------------
def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs=3, metavar="FILE", help="OLD NEW CERTIFICATE")
    parser.add_argument("--control", required=True, choices=["linuxcnc", "grbl", "fanuc", "siemens", "heidenhain"])
    parser.add_argument("--tolerance", required=True, type=Fraction)
    parser.add_argument("--units", choices=["mm", "inch"])
    parser.add_argument("--added-line", action="append", default=[])
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    if options.tolerance <= 0:
        parser.error("--tolerance: expected a length in mm above 0")
    try:
        data = [open(name, "rb").read() for name in options.files]
    except OSError as error:
        print(f"{error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    texts = [content.decode("latin-1") for content in data]
    old, new = (re.findall(r"[^\n]*\n|[^\n]+", text) for text in texts[:2])
    try:
        runs, scale = read_certificate(texts[2], options.tolerance), Scale(texts[:2])
        checker = Checker(old, new, runs, options, scale)
        checker.run()
    except Refused as why:
        print(f"NOT CERTIFIED: {options.files[1]} against {options.files[0]}\n  {why}")
        return 1
    if options.quiet:
        return 0
    print(f"CERTIFIED: {options.files[1]} keeps {float(options.tolerance):g} mm to {options.files[0]}, in order and "
          f"both ways\n  greatest distance of what is passed together: at most "
          f"{-(-checker.greatest * 10 ** 6 // scale.per_mm) / 1e6:.6f} mm" +
          (f", in the run at line {checker.greatest_line}" if checker.greatest else "") +
          f"\n  {len(runs)} runs: {checker.rewritten[0]} lines are rewritten as {checker.rewritten[1]}; "
          f"{len(old) - checker.rewritten[0]} lines are the same bytes"
          f"\n  added: {checker.own_comments} comments of Batten, {checker.added_lines} lines of --added-line"
          f"\n  read as a program for {options.control}, which begins with G17 G90 G94 G40 or what stands for them")
    for name, content in zip(options.files, data):
        print(f"  {hashlib.sha256(content).hexdigest()}  {name}")
    return 0

if __name__ == "__main__":
    sys.exit(main())
