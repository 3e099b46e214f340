#!/usr/bin/env python3
"""Does the oracle of the campaign find planted faults, and nothing where there is none? Does the checker
of certificates refuse what the campaign has found?

For each kind of program a text, and changes of it: each that does harm has to be found, by the readers
and, for LinuxCNC's family, by LinuxCNC's own interpreter where rs274 is there; each that does none
must not be."""

import contextlib
import io
import math
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tools")]
import campaign  # noqa: E402
import check_certificate  # noqa: E402
import oracle  # noqa: E402
import paths  # noqa: E402

TOLERANCE = 0.01

PLAIN = """G21 G17 G90 G94
G0 X0 Y0 Z5
G1 Z0 F200
X1 Y0.1 F1000
X2 Y0.3
G2 X3 Y0.3 I0.5 J0
G1 X4 Y0
M8
X5 F500
G1 X6 Y1
G0 Z5
M2
"""
# Text, what is replaced by what, and whether it does harm.
PLAIN_CHANGES = [
    ("X2 Y0.3", "X2 Y0.33", True, "a place moved by three tolerances"),
    ("X2 Y0.3", "X2 Y0.305", False, "a place moved by half a tolerance"),
    ("X1 Y0.1 F1000", "X1 Y0.1 F1001", True, "another feed"),
    ("X5 F500", "X5", True, "a feed lost"),
    ("X5 F500\nG1 X6 Y1", "X5\nG1 X6 Y1 F500", True, "a feed a move later"),
    ("X2 Y0.3\n", "", True, "a block lost"),
    ("G1 X4 Y0\nM8", "M8\nG1 X4 Y0", True, "an M word moved"),
    ("M8\n", "", True, "an M word lost"),
    ("M8\n", "M9\n", True, "another M word"),
    ("G2 X3", "G3 X3", True, "an arc turned round"),
    ("I0.5 J0", "I0.5 J0.2", True, "an arc whose radii are not the same"),
    ("G1 X4 Y0", "X4 Y0", True, "a motion word lost"),
    ("X1 Y0.1 F1000", "X0.5 Y0.05 F1000\nX1 Y0.1", False, "a line in two"),
    ("X1 Y0.1 F1000", "X1 Y0.1 F1000\nX0.5 Y0.05\nX1 Y0.1", True, "there and back"),
    ("G0 Z5\nM2", "G1 Z5\nM2", True, "a rapid that is none any more"),
    ("G0 Z5\nM2", "G0 X7 Z5\nM2", True, "another end of a rapid"),
    ("G21", "G20", True, "another unit"),
    ("G1 X6 Y1", "G91\nG1 X6 Y1", True, "a distance mode"),
    ("G1 X6 Y1", "G1 X6 Y1 (done)", False, "a comment"),
    ("G1 X6 Y1", "G1 G90 X6 Y1", False, "a word that changes nothing"),
    ("M8\n", "M8\nG18\n", True, "a plane behind the last arc"),
]
FANUC = """%
O1
G21 G17 G90 G94
G0 X0. Y0. Z0.
G1 X1. Y0. F500.
X2. Y0.05
G06.2 P4 K0. X2. Y0.05 R1.
K0. X3. Y0.1
K0. X4. Y1.
K0. X5. Y1.
K1.
K1.
K1.
K1.
G1
X6. Y1.
M98 P7
X7. Y1.
X8. Y1.1
M30
%
"""
FANUC_CHANGES = [
    ("K0. X4. Y1.", "K0. X4. Y1.2", True, "a control point moved"),
    ("K0. X4. Y1.", "K0. X4. Y1.005", False, "a control point moved by less than the tolerance"),
    ("K0. X4. Y1.", "K0. X4. Y1. R2.", True, "a weight"),
    ("K0. X4. Y1.", "K0. X4. Y1. R1.005", False, "a weight that moves the curve by less than the tolerance"),
    ("K0. X4. Y1.", "K0. X4. Y1. R0.", True, "a weight that is not positive"),
    ("K1.\nK1.\nK1.\nK1.", "K1.\nK1.\nK1.\nK2.", True, "knots that are not clamped"),
    ("M98 P7\nX7. Y1.", "M98 P7\nX6.9 Y1.\nX7.", True, "a place behind a call, whatever it leaves"),
    ("M98 P7", "M98 P8", True, "another call"),
    ("X6. Y1.\nM98 P7", "M98 P7\nX6. Y1.", True, "a call a move too early"),
]
EVEN = """G21 G17 G90 G94
G0 X0 Y0 Z0
G1 X1 Y0 F500
G5.2 L5
X2 Y2 P0.5
X4 Y2 P2
X5 Y0 P1.5
X6 Y0 P1
G5.3
G1 X7 Y0
M2
"""
EVEN_CHANGES = [
    ("P0.5", "P0.6", True, "another weight"),
    ("P0.5", "P0.501", False, "a weight that moves the curve by less than the tolerance"),
    ("P2", "P0", True, "a weight that is not positive"),
    ("P1.5", "", True, "a point without its weight"),
    ("L5", "L4", True, "another order"),
    ("L5", "L6", True, "an order above the number of points"),
    ("X4 Y2 P2\n", "", True, "a point lost"),
    ("L5\nX2 Y2 P0.5", "X2 Y2 P0.5 L5", False, "the first point beside G5.2"),
]
SIEMENS = """G71 G17 G90 G94
G0 X0 Y0 Z0
G1 X1 Y0 F500
POLY PO[X]=(3,0,0) PO[Y]=(1,0.5,0.1)
G1 X4 Y1
CYCLE832(0.05,3,1)
G2 X5 Y1 CR=0.7
UNKNOWN(3)
G1 X6 Y1
G1 X7 Y1
M30
"""
SIEMENS_CHANGES = [
    ("PO[Y]=(1,0.5,0.1)", "PO[Y]=(1,0.7,0.1)", True, "another coefficient"),
    ("PO[Y]=(1,0.5,0.1)", "PO[Y]=(1,0.5001,0.1)", False, "a digit of a coefficient"),
    ("CR=0.7", "CR=0.6", True, "another radius"),
    ("POLY PO", "PO", True, "no POLY"),
    ("G1 X6 Y1\nG1 X7 Y1", "G1 X6.5 Y1\nG1 X7 Y1", True, "a place behind what nobody knows"),
    ("CYCLE832(0.05,3,1)\n", "", True, "a word lost"),
]
RATIONAL = """G71 G17 G90 G94
G0 X10 Y0 Z0
G1 X10 Y0 Z0 F500
POLY PO[X]=(0,-10) PO[Y]=(10) PO[]=(2,1)
PO[X]=(-2,3,1,-2,1) PO[Y]=(9,1,0,0.5,-0.5)
G1 X-4 Y9
M30
"""
RATIONAL_CHANGES = [
    ("POLY PO[X]=(0,-10) PO[Y]=(10) PO[]=(2,1)\nPO", "G3 X0 Y10 CR=10\nPOLY PO", False, "the arc that the polynomials are"),
    ("PO[]=(2,1)", "PO[]=(2,1.02)", True, "another denominator"),
    ("PO[]=(2,1)", "PO[]=(2,1.0005)", False, "a denominator that moves the curve by less than the tolerance"),
    (" PO[]=(2,1)", "", True, "no denominator"),
    ("PO[]=(2,1)", "PO[]=(2,-9)", True, "a denominator that falls below zero"),
    ("1,-2,1)", "1,-2)", True, "no fifth power"),
    ("1,-2,1)", "1,-1,0)", True, "another fourth power"),
    ("1,-2,1)", "1,-2,1) PL=1.1", True, "another length of the parameter"),
    ("PO[X]=(-2,3,1,-2,1) PO[Y]=(9,1,0,0.5,-0.5)", "PO[X]=(-2,12,8,-32,32) PO[Y]=(9,4,0,8,-16) PL=0.5", False,
     "another length of the parameter, and coefficients for it"),
]
BSPLINE = """G71 G17 G90 G94
G0 X0 Y0 Z0
G1 X1 Y0 F500
BSPLINE SD=3 X2 Y2 PL=1 PW=0.5
X4 Y2 PL=2 PW=2
X5 Y0 PL=0 PW=1.5
X6 Y0 PL=0
G1 X7 Y0
M30
"""
BSPLINE_CHANGES = [
    ("PW=0.5", "PW=0.6", True, "another weight"),
    ("PW=0.5", "PW=0.501", False, "a weight that moves the curve by less than the tolerance"),
    (" PW=2", "", True, "no weight"),
    ("PW=2", "PW=-2", True, "a weight that is not positive"),
    ("PL=1 ", "PL=1.5 ", True, "another span"),
    ("PL=1 PW=0.5\nX4 Y2 PL=2", "PL=2 PW=0.5\nX4 Y2 PL=4", False, "the same spans twice as long"),
    ("SD=3", "SD=2", True, "another degree"),
    ("X6 Y0 PL=0", "X6 Y0 PL=1", True, "a last span that is none"),
]
KLARTEXT = """BEGIN PGM A MM
TOOL CALL 1 Z S500
L X+0 Y+0 Z+5 R0 FMAX
L Z+0 F200
L X+1 Y+0.1 F1000
CC X+2 Y+0.1
C X+3 Y+0.1 DR-
SPL X+5 Y+0.1 K3X+0 K2X+0 K1X-2 K3Y+0 K2Y+0.4 K1Y-0.4
L X+6 Y+1
L M8
L X+7 Y+1 F500
L Z+5 FMAX
L M30
END PGM A MM
"""
KLARTEXT_CHANGES = [
    ("CC X+2 Y+0.1", "CC X+2 Y+0.2", True, "a pole moved"),
    ("DR-", "DR+", True, "an arc turned round"),
    ("K2Y+0.4 K1Y-0.4", "K2Y+0.8 K1Y-0.8", True, "another spline"),
    ("L X+6 Y+1\nL M8", "L M8\nL X+6 Y+1", True, "an M word moved"),
    ("L X+7 Y+1 F500", "L X+7 Y+1 F501", True, "another feed"),
    ("L X+6 Y+1", "L X+6 Y+1 RL", True, "compensation"),
    ("L X+6 Y+1", "L X+6 Y+1 ; hi", False, "a comment"),
    ("L Z+5 FMAX", "L Z+5", True, "a rapid that is none any more"),
]
PARTS = """G21 G17 G90 G94
G0 X0 Y0 Z0
G1 X1 Y0.1 F1000
X2 Y0.3
X3 Y0.1
(TOLERANCE 0.003)
X4 Y0
X5 Y0.2
X6 Y0.1
(TOLERANCE 0.02 MM)
X7 Y0
X8 Y0.2
M8
(TOLERANCE 0.02)
X9 Y0
X9.5 Y0.1
(TOLERANCE 0.004)
X10 Y0.2
M2
"""
PART_CHANGES = [
    ("X2 Y0.3", "X2 Y0.308", False, "a place before the part moved by less than is asked for"),
    ("X5 Y0.2", "X5 Y0.208", True, "a place of the part moved by more than it states"),
    ("X5 Y0.2", "X5 Y0.202", False, "a place of the part moved by less than it states"),
    ("X8 Y0.2", "X8 Y0.208", False, "a place of a part that states more than is asked for"),
    ("X8 Y0.2", "X8 Y0.218", True, "a place of a part that is moved by more than is asked for"),
    ("(TOLERANCE 0.003)\n", "", False, "the words of a part lost"),
    ("(TOLERANCE 0.003)\nX4 Y0\nX5 Y0.2", "X4 Y0\nX5 Y0.208\n(TOLERANCE 0.003)", True, "the words of a part moved"),
    ("(TOLERANCE 0.02 MM)\nX7 Y0\nX8 Y0.2\nM8\n(TOLERANCE 0.02)\nX9 Y0\n", "X7 Y0\nX8 Y0.2\nM8\n(TOLERANCE 0.02)\nX9 Y0.008\n",
     False, "the words of a part lost, and elsewhere a place of another part moved by less than that states"),
]
CASES = [("linuxcnc", PLAIN, PLAIN_CHANGES), ("grbl", PLAIN, PLAIN_CHANGES), ("fanuc", FANUC, FANUC_CHANGES),
         ("siemens", SIEMENS, SIEMENS_CHANGES), ("heidenhain", KLARTEXT, KLARTEXT_CHANGES), ("linuxcnc", PARTS, PART_CHANGES),
         ("linuxcnc", EVEN, EVEN_CHANGES), ("siemens", RATIONAL, RATIONAL_CHANGES),
         ("siemens-bspline", BSPLINE, BSPLINE_CHANGES)]


# What the campaign found: lines 5 to 7 of this became others; what stands behind them; whether it is
# to be certified.
CERTIFIED_HEAD = "G21 G17 G90 G94\nS100 M3\nG0 X0 Y0 Z0\nG1 Z-1 F100\n"
CERTIFIED_RUN = "X1 Y0\nX2 Y0.001\nX3 Y0\n"
FOUND = [
    ("a run", CERTIFIED_RUN, "X3 Y0\n", "M5\nM2\n", True),
    ("another plane where compensation begins", CERTIFIED_RUN, "G18 X3 Y0\n", "G42.1 D0.1\nG17 G40\nM2\n", False),
    ("another plane that is set before it counts", CERTIFIED_RUN, "G18 X3 Y0\n", "G17\nG42.1 D0.1\nG17 G40\nM2\n", True),
    ("an arc whose radii differ", CERTIFIED_RUN, "G2 X3 Y0 I2.5 J-30\nG1\n", "M2\n", False),
    ("a speed that is said again", "X1 Y0\nX2 Y0.001 S100\nX3 Y0\n", "X3 Y0\n", "M2\n", True),
    ("another speed", "X1 Y0\nX2 Y0.001 S200\nX3 Y0\n", "X3 Y0\n", "M2\n", False),
    ("a G5", CERTIFIED_RUN, "G5 X3 Y0 I1 J0 P-1 Q0\nG1\n", "M2\n", True),
    ("a radius beside a G5", CERTIFIED_RUN, "R5 G5 X3 Y0 I1 J0 P-1 Q0\nG1\n", "M2\n", False),
    ("siemens: a radius beside a polynomial", CERTIFIED_RUN, "POLY CR=5 PO[X]=(3,0,0) PO[Y]=(0,0,0)\nG1\n", "M30\n", False),
    ("siemens: a polynomial", CERTIFIED_RUN, "POLY PO[X]=(3,0,0) PO[Y]=(0,0,0)\nG1\n", "M30\n", True),
    ("siemens: no POLY, so that it runs straight", CERTIFIED_RUN, "PO[X]=(3,0,0) PO[Y]=(0,0,0)\nG1\n", "M30\n", False),
    ("siemens: G1 beside POLY", CERTIFIED_RUN, "G1 POLY PO[X]=(3,0,0) PO[Y]=(0,0,0)\nG1\n", "M30\n", False),
    ("a speed that means another one", "G96\nX2 Y0.001 S100\nX3 Y0\n", "X3 Y0\n", "M2\n", False),
]


def check_found():
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        names = [str(pathlib.Path(folder, name)) for name in ("old.nc", "new.nc", "new.cert")]
        for name, run, new, tail, certified in FOUND:
            proof = f"Batten certificate 1\ntolerance 0.05 mm\nrun 5 3 5 {new.count(chr(10))}\n"
            siemens = name.startswith("siemens")
            head = CERTIFIED_HEAD.replace("G21", "G71") if siemens else CERTIFIED_HEAD
            for path, text in zip(names, (head + run + tail, head + new + tail, proof)):
                pathlib.Path(path).write_text(text)
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                code = check_certificate.main([*names, "--control", "siemens" if siemens else "linuxcnc",
                                               "--tolerance", "0.05"])
            if (code == 0) != certified:
                wrong.append(f"{name}: {said.getvalue()}")
    return wrong


def check_held():
    """Of a line that is as long as it may be, what the control drops does not count."""
    line = "G1 X1 (a (b) c" + "X" * 20
    held = {"grbl": "G1X1c" + "X" * 20, "reprapfirmware": "G1 X1  c" + "X" * 20, "linuxcnc": line}
    return [f"{target} holds {campaign.held_of(target, line)}" for target, what in held.items()
            if campaign.held_of(target, line) != what]


def check_together():
    """The distance that is decided on is that of the closed form."""
    wrong = []
    line = [(0.0, 0.0, 0.0), (10.0, 0.0, 0.0)]
    tooth = [(0.0, 0.0, 0.0), (5.0, 0.3, 0.0), (10.0, 0.0, 0.0)]
    back = [(0.0, 0.0, 0.0), (6.0, 0.0, 0.0), (4.0, 0.0, 0.0), (10.0, 0.0, 0.0)]  # 2 back: 1 apart at least
    circle = [(0.0, 0.0, 0.0)] + paths.arc_points((0, 0, 0), (0, 0, 0), (5, 0), (0, 1, 2), 1)
    for name, p, q, distance in (("tooth", line, tooth, 0.3), ("there and back", line, back, 1.0),
                                 ("circle and its start", [(0.0, 0.0, 0.0)], circle, 10.0)):
        for a, b in ((p, q), (q, p)):
            if paths.together(a, b, distance - 0.001) or not paths.together(a, b, distance + 0.001):
                wrong.append(f"{name}: not {distance} apart")
    length = math.fsum(math.dist(a, b) for a, b in zip(circle, circle[1:]))
    if abs(length - 10 * math.pi) > 0.01:
        wrong.append(f"a circle of {length} mm")
    return wrong


def check_weights():
    """A half circle in two quadratic pieces with weights, and one of degree five by its definition."""
    wrong = []
    control = [(10.0, 0.0, 0.0), (10.0, 10.0, 0.0), (0.0, 10.0, 0.0), (-10.0, 10.0, 0.0), (-10.0, 0.0, 0.0)]
    root = math.sqrt(0.5)
    points = control[:1] + paths.nurbs_points(3, control, [1, root, 1, root, 1], [0, 0, 0, 1, 1, 3, 3, 3])
    off = [abs(math.hypot((p[0] + q[0]) / 2, (p[1] + q[1]) / 2) - 10) for p, q in zip(points, points[1:])]
    if max(off) > paths.CHORD_ERROR or max(abs(math.hypot(*p) - 10) for p in points) > 1e-9:
        wrong.append(f"a circle that is {max(off)} mm off")
    control = [(0.0, 0.0, 0.0), (1.0, 3.0, 0.0), (3.0, 4.0, 1.0), (5.0, 3.0, 0.0), (6.0, -2.0, 2.0), (9.0, 0.0, 0.0)]
    weights = [1.0, 0.4, 2.5, 0.7, 1.9, 1.2]

    def at(t):
        parts = [math.comb(5, i) * t ** i * (1 - t) ** (5 - i) * w for i, w in enumerate(weights)]
        return tuple(math.fsum(b * p[axis] for b, p in zip(parts, control)) / math.fsum(parts) for axis in range(3))

    if not paths.together(control[:1] + paths.nurbs_points(6, control, weights, [0.0] * 6 + [1.0] * 6),
                          [at(n / 2000) for n in range(2001)], 0.0005):
        wrong.append("a curve of degree five that is not its sum of Bernstein polynomials")
    return wrong


def main():
    wrong = check_together() + check_weights() + check_found() + check_held()
    for control, text, changes in CASES:
        old = oracle.OldProgram(text, control)
        canon = oracle.Canon(text) if control in oracle.LIKE_LINUXCNC and oracle.rs274_is_there() else None
        if canon and canon.complaint:
            wrong.append(f"{control}: rs274: {canon.complaint}")
        if old.harm(text, TOLERANCE):
            wrong.append(f"{control}: the same text: {old.harm(text, TOLERANCE)}")
        for before, after, harmful, name in changes:
            if text.count(before) != 1:
                raise ValueError(f"{control}: {before!r} is not once in the text")
            new = text.replace(before, after)
            found = {"readers": old.harm(new, TOLERANCE)}
            # rs274 tells no curves, and the plane by its arcs alone.
            if canon and text not in (PARTS, EVEN) and "plane" not in name:
                found["rs274"] = oracle.harm_in_linuxcnc(canon, new, TOLERANCE)
            for who, harm in found.items():
                if bool(harm) != harmful:
                    wrong.append(f"{control}: {name}: {who}: {harm or 'nothing found'}")
    print("\n".join(wrong + [f"{sum(len(case[2]) for case in CASES)} planted changes, {len(wrong)} wrong"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
