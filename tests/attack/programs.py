"""Random programs as CAM systems write them, for many controls, with everything in them that programs
have: calls, loops, cycles, modes, words that nobody knows. Short, so that many can be tried."""

import math

# Lines that stand between cuts; `;` begins a new line, and where it must be more, several.
BETWEEN = {
    "linuxcnc": """M8|M9|M7|G64 P0.01|G61|G4 P0.5|(hi)|M3 S1000|S2000|T2 M6|G43 H1|o100 call|#1=[#1+1]|G55|G54|
        F777|M8 F888|M199|M66 P0 L0|G91.1|G17|G18;G17|G40|G94;F400|G92 X1|G92.1|M48|M50 P1|G93;G94 F900|M62 P1|
        M67 E0 Q1|G80|G98|M5|G81 X5 Y5 Z-5 R2|G10 L2 P1 X1|G20;G21|G91;X1;G90|G0 Z5;G1 Z0|G53 G0 Z0|G28|
        N100 M8|/M8|G33 Z-1 K1|G5.2 X1 Y1 P1;X2 Y2;G5.3|G95 F0.1;G94 F500|o10 if [#1 EQ 0];F555;o10 endif|
        o20 repeat [2];F600;o20 endrepeat|(MSG, hi)|G64|G91|G90|G18|G19|G20|G21|G90.1|G91.1|G41 D1|G40|G42.1 D0.1|
        G68 X0 Y0 R30|G69|G93|G7|G8|G51|/G91|/X1|/F300|o110 call|o120 call|o130 call|o140 call|#<up>=3;G0 Z#<up>;G1 Z0|
        X[#1+2]|G1 A5|G4 X1|G0 X3 Y4;G1|G2 X5 Y5 I1 J1|G3 X2 Y2 R8|G61.1|M1|M0|G59.1|G43.1 Z0.5;G49|G99|
        (Batten: smoothed within 0.01 mm)|; note|M64 P2|X1 Y1 F60|G38.2 Z-1|M30|G17 G1 G40 G90 G94 F500""",
    "fanuc": """M8|M9|G61|G64|G4 P500|(hi)|M3 S1000|S2000|T2 M6|G43 H1|M98 P100|#1=#1+1|G55|F777.|M8 F888.|M199|
        G17|G40|G94;F400.|G92 X1.|G81 X5. Y5. Z-5. R2. F50.|G80|G91;X1.;G90|G0 Z5.;G1 Z0.|G53 Z0.|
        G91 G28 Z0.;G90|N100|G65 P9000 A1. F5.|IF [#1 EQ 0] GOTO 100|G05.1 Q1|G41 D1|G68 X0. Y0. R30.;G69|
        G05 P10000;G05 P0|G95 F.1;G94 F500.|G10 L2 P1 X1.|M198 P2|G66 P9000;X5.;G67|G91|G90|G18|G17|G20|G21|
        G51 X0. Y0. P2.|G50|G68 X0. Y0. R10.|G69|G16|G15|G93|/G91|/X1.|/M8|M97 P5|G123|G2 X5. Y5. R9.|X5. Y6. ,R2.|
        G5.1 Q2 X0. Y0.;G5.1 Q0|G187 P3|G12.1|M21|WHILE [#1 LT 3] DO1;#1=#1+1;END1|GOTO 100|N100 X5.|X#1|X1000|
        G41.1|G43.4 H1|G49|M48|A5.|M600|G9 X1.|G52 X1.|G52 X0.|G40 G17 G90 G94 G1 F500.|M1|G98|G99""",
    "siemens": """M8|M9|G60|G64|G642|G4 F0.5|MSG()|M3 S1000|S2000|T2 M6;D1|UP1|R1=R1+1|G55|F777|M8 F888|M199|
        G17|G40|G94;F400|TRANS X1;TRANS|MCALL CYCLE81(10,0,2,-5);X5 Y5;MCALL|G91;X1;G90|G0 Z5;G1 Z0|
        SUPA G0 Z0;G1|MSG("x")|LBL1:|GOTOF LBL1|FFWON|SOFT|CYCLE832(0.05,3,1)|G63 Z-5 F100;G1 F500|
        ROT RPL=5;ROT|STOPRE|H5|G95 F0.1;G94 F500|G331 Z-1 K1;G1|COMPCAD;COMPOF|X=IC(5)|G41 D1|CALL "UP2"|
        FGROUP(X,Y);FGROUP()|G9|G91|G90|G18|G17|G70|G71|G500|TRANS X3|ROT RPL=20|ROT|SCALE X2|MIRROR X0|TRAORI|
        COMPCAD|COMPOF|G42|G93|N100 M8|GOTOF N100|X=R1|L123|POCKET1(1,2)|G2 X5 Y5 CR=9|RND=2 X4|$AC_TIME=1|
        M17|G153 X1|DIAMON|G1 A5|G1 X1 Y2 F60|G17 G40 G71 G90 G94 G64 G1 F500|/G91|/X1|G450|M1|KOMMA(1)""",
    "heidenhain": """L M8|L M9|L F777|L M8 F888|L Z+5 FMAX|L Z+0 F200|CALL LBL 1|Q1 = Q1 + 1|
        TOOL CALL 2 Z S1000|TOOL CALL S2000 F300|CYCL DEF 7.0 DATUM SHIFT;CYCL DEF 7.1 X+1|
        CYCL DEF 32.0 TOLERANCE;CYCL DEF 32.1 T0.05|CYCL DEF 9.0 DWELL TIME;CYCL DEF 9.1 DWELL 0.5|LBL 5|
        FN 9: IF +Q1 EQU +2 GOTO LBL 5|L IX+1 IY+1|CYCL CALL M3|STOP M0|CC X+5 Y+5;C X+6 Y+5 DR+|
        L M140 MB MAX|CYCL DEF 200 DRILLING Q200=2 Q201=-5 Q206=150|L X+1 RL F300|L R0|L F AUTO|L M91 Z+0|
        M128|L M128|L M129|PLANE RESET|CYCL DEF 10.0 ROTATION;CYCL DEF 10.1 ROT+20|CYCL DEF 8.0 MIRROR;CYCL DEF 8.1 X|
        CALL PGM X.H|L A+5|LP PR+5 PA+30|RND R2|CHF 1|CR X+5 Y+5 R+9 DR-|LBL 0|L M99|L RR X+5|/L X+1|/L F333|
        L X+Q1|CC IX+1 IY+1|L M1|L M136|L M89|FUNCTION TCPM F TCP|APPR LT X+1 Y+1 LEN2 RL|* - part|; note""",
}
# Of the small controls: what they have of LinuxCNC's words, and what they do not know.
BETWEEN["grbl"] = """M8|M9|M7|G4 P0.5|(hi)|M3 S1000|S2000|G55|G54|F777|M8 F888|G91.1|G17|G18;G17|G94;F400|G92 X1|G92.1|
    G93;G94 F900|G80|M5|G10 L2 P1 X1|G20;G21|G91;X1;G90|G0 Z5;G1 Z0|G53 G0 Z0|G28|M0|G91|G90|G18|G19|G20|G21|G93|G40|G61|
    G43.1 Z0.5|G49|M199|G123|$H|$X|$G|G38.2 Z-1|T1|G2 X5 Y5 I1 J1|G3 X2 Y2 R8|X1 Y1 F60|G0 X3 Y4;G1|; note|M4 S10|
    G17 G21 G90 G94 G1 F500"""
BETWEEN["marlin"] = """M106 S255|M107|G4 P50|; hi|M3 S100|M5|F777|G1 F888|G91|G90|G92 X1|G28|M204 P500|G0 Z5;G1 Z0 F300|
    G1 X5 E1|M117 hello|M400|G21|G17|G123|T1|M0|G1 X1 Y1 F60|M82|M83|G92 E0|G2 X5 Y5 I1 J1"""
LIKE = {"grblhal": "grbl", "mach3": "grbl", "haas": "fanuc", "mitsubishi": "fanuc", "hurco": "fanuc", "syntec": "fanuc",
        "klipper": "marlin", "itnc530": "heidenhain", "siemens-bspline": "siemens"}
TARGETS = ["linuxcnc"] * 4 + ["grbl", "grbl", "fanuc", "fanuc", "siemens", "siemens", "siemens-bspline", "heidenhain", "heidenhain",
                              "itnc530", "marlin", "klipper", "grblhal", "mach3", "haas", "mitsubishi", "hurco", "syntec"]
FORMS = {"linuxcnc": ["arcs", "lines", "curves"], "fanuc": ["arcs", "lines", "curves"], "mitsubishi": ["arcs", "curves"],
         "syntec": ["arcs", "curves"], "siemens": ["arcs", "lines", "curves"],
         "siemens-bspline": ["arcs", "lines", "curves"], "itnc530": ["arcs", "lines", "curves"]}
HEADS = {
    "linuxcnc": "G21 G17 G90 G94 G64 P0.01|G0 X0 Y0 Z5|G1 Z0 F200",
    "fanuc": "%|O1|G21 G17 G90 G94|G0 X0. Y0. Z5.|G1 Z0. F200.",
    "siemens": "G71 G17 G90 G94|G0 X0 Y0 Z5|G1 Z0 F200",
    "heidenhain": "BEGIN PGM A MM|TOOL CALL 1 Z S500|L X+0 Y+0 Z+5 R0 FMAX|L Z+0 F200",
    "grbl": "G21 G17 G90 G94|G0 X0 Y0 Z5|G1 Z0 F200",
    "marlin": "G21|G90|G0 X0 Y0 Z5|G1 Z0 F200",
}
ENDS = {"linuxcnc": "G0 Z5|M2", "fanuc": "G0 Z5.|M30|%", "siemens": "G0 Z5|M30", "heidenhain": "L Z+5 FMAX|L M30|END PGM A MM",
        "grbl": "G0 Z5|M2", "marlin": "G0 Z5|M84"}
# Subprograms of LinuxCNC that leave something behind, and one that does not.
SUBPROGRAMS = """o100 sub|M8|o100 endsub|o110 sub|G91|o110 endsub|o120 sub|F123|G18|o120 endsub|o130 sub|G0 X9 Y9|
    o130 endsub|o140 sub|G20|o140 endsub""".replace("\n", "").split("|")

# Curve words: of which controls, and as what their blocks are said. "weighted": with uneven weights, or of a
# degree above the third.
CURVES = {"linuxcnc": ["G5", "G5", "G5.1", "G5.2", "weighted G5.2", "weighted G5.2"], "grblhal": ["G5"], "marlin": ["G5"],
          "fanuc": ["G6.2", "weighted G6.2"], "siemens": ["POLY", "weighted POLY"],
          "siemens-bspline": ["BSPLINE", "weighted BSPLINE", "weighted BSPLINE"], "itnc530": ["SPL"]}

STYLES = ("contours", "raster", "waterlines", "adaptive", "engraving", "plasma", "laser", "printer", "drilling", "finishing")


def between(target):
    words = " ".join(BETWEEN[LIKE.get(target, target)].split())
    return [part.strip().split(";") if not part.strip().startswith(";") else [part.strip()] for part in words.split("|")]


class Programs:
    """For one target. Paths are chains of (point, feed) with rapids between; see `chains`."""

    curves = 0.0  # how often a curve begins at a place

    def __init__(self, target, chance):
        self.target, self.random = target, chance
        self.like = LIKE.get(target, target)
        self.klartext = self.like == "heidenhain"
        self.between = between(target)

    def program(self):
        """The text, its style."""
        chance = self.random
        self.inch = chance.random() < 0.12 and self.like in ("linuxcnc", "fanuc", "siemens", "grbl")
        self.point = "." if self.like == "fanuc" else ""
        self.decimals = chance.choice([3, 3, 4, 5]) + (1 if self.inch else 0)
        self.every_word = chance.random() < 0.3 or self.like == "marlin"
        self.all_axes = chance.random() < 0.2
        self.blank = chance.choice([" ", " ", " ", ""])
        self.zero = chance.choice(["G1", "G1", "G01"])
        self.numbered = chance.random() < 0.25 and self.like not in ("marlin",)
        self.noise = chance.choice([0.0, 0.0, 0.001, 0.004])
        self.comments = chance.random() < 0.15
        self.states = chance.choice([0.0, 0.0, 0.0, 0.02, 0.1])
        style = chance.choice(STYLES)
        often = chance.choice([0.0, 0.0, 0.01, 0.04, 0.12])
        self.curves = chance.choice([0.0, 0.0, 0.05, 0.3, 0.9]) if self.target in CURVES else 0.0
        lines = HEADS[self.like].split("|")
        if self.inch:
            lines = [line.replace("G21", "G20").replace("G71", "G70") for line in lines]
        self.last = {"X": None, "Y": None, "Z": None}
        self.last_feed = None
        for chain in getattr(self, style)():
            lines += self.between_chains(style)
            lines += self.chain_lines(chain, style, often)
            if chance.random() < 0.4:
                for _ in range(chance.choice([1, 1, 2])):
                    lines += chance.choice(self.between)
                self.last = dict.fromkeys("XYZ")
                self.last_feed = None
        lines += ENDS[self.like].split("|")
        if any("call" in line for line in lines) and self.target == "linuxcnc":
            lines = SUBPROGRAMS + lines
        if self.numbered:
            lines = self.with_numbers(lines)
        return "\n".join(lines) + "\n", style

    def with_numbers(self, lines):
        if self.klartext:
            return [f"{n} {line}" for n, line in enumerate(lines)]
        out = []
        for n, line in enumerate(lines):
            plain = line[:1] in "GXYZFMSTIJK" and line[:1]
            out.append(f"N{10 * n + 10}{self.blank}{line}" if plain else line)
        return out

    # --- text ---

    def number(self, value):
        value = value / (25.4 if self.inch else 1)
        text = f"{value:+.{self.decimals}f}" if self.klartext else f"{value:.{self.decimals}f}"
        return text

    def words(self, place):
        words = []
        for letter, value in zip("XYZ", place):
            text = letter + self.number(value)
            if text != self.last[letter] or self.all_axes:
                words.append(text)
            self.last[letter] = text
        return words

    def line(self, place, feed, rapid=False):
        chance = self.random
        words = self.words(place)
        if not words:
            words = ["X" + self.number(place[0])]
        if self.klartext:
            text = "L " + " ".join(words)
            if rapid:
                return text + " FMAX"
            return text + (f" F{feed}" if feed != self.last_feed or chance.random() < 0.02 else "")
        if rapid:
            return self.blank.join(["G0", *words])
        word = self.zero if self.every_word or self.begins else ""
        self.begins = False
        words = ([word] if word else []) + words
        if feed != self.last_feed or chance.random() < 0.02:
            words.append(f"F{feed / 25.4:.1f}" if self.inch else f"F{feed}{self.point}")
        return self.blank.join(words)

    def stated_tolerance(self, chance):
        """A comment by itself, in the units of the program."""
        words = f"TOLERANCE {chance.choice([0.003, 0.006, 0.02]) / (25.4 if self.inch else 1):.6f}"
        return f"; {words}" if self.klartext or self.like in ("marlin", "siemens") else f"({words})"

    def chain_lines(self, chain, style, often):
        chance, lines = self.random, []
        first, *rest = chain
        top = (first[0][0], first[0][1], first[0][2] + 4)
        self.begins = True
        # The height first, so that the place is known whatever was before.
        lines.append(self.line(top, None, True))
        lines.append(self.line(first[0], 200))
        self.last_feed = 200
        self.spoken = None  # the place as it was printed, where a curve can begin
        skipped = 0
        for at, (place, feed) in enumerate(rest):
            if skipped:
                skipped -= 1
                continue
            if self.curves and feed == self.last_feed and chance.random() < self.curves:
                skipped = self.curve_lines(chain, at, lines)
                if skipped:
                    skipped -= 1
                    continue
            place = tuple(x + chance.uniform(-self.noise, self.noise) for x in place)
            text = self.line(place, feed)
            self.last_feed = feed
            self.spoken = tuple(float(self.number(x)) * (25.4 if self.inch else 1) for x in place)
            if style == "laser" and not self.klartext and chance.random() < 0.1:
                text += f"{self.blank}S{chance.choice([100, 200, 250])}"
            if style == "printer" and self.like == "marlin" and chance.random() < 0.05:
                text += " E0.5"
            if self.comments and chance.random() < 0.1:
                text += " ; c" if self.klartext or self.like in ("marlin", "siemens") else " (c)"
            if style == "finishing" and self.like in ("linuxcnc", "fanuc") and chance.random() < 0.03:
                lines.append("#5=0." if self.like == "fanuc" else "#5=[1-1]")
                text += " (x)"
            lines.append(text)
            if chance.random() < self.states:
                lines.append(self.stated_tolerance(chance))
            if chance.random() < often:
                lines += chance.choice(self.between)
                self.last = dict.fromkeys("XYZ")
                self.spoken = None
                if chance.random() < 0.8:
                    self.last_feed = None
                    self.begins = True
                if chance.random() < 0.3 and not self.klartext:
                    lines.append({"linuxcnc": "G17 G21 G90 G94 G64 G40 G49 G69 G91.1", "grbl": "G17 G21 G90 G94",
                                  "fanuc": "G17 G21 G90 G94 G40 G69", "marlin": "G90",
                                  "siemens": "G17 G71 G90 G94 G64 G40 TRANS"}[self.like])
        lines.append(self.line((rest[-1][0][0], rest[-1][0][1], 5.0) if rest else top, None, True))
        return lines

    # --- curves ---

    def curve_lines(self, chain, at, lines):
        """A curve from the place behind chain[at] over the next points; how many of them, or none."""
        chance = self.random
        word = chance.choice(CURVES[self.target])
        count = chance.choice([1, 1, 2, 4])
        feed = chain[at + 1][1]
        ends = [p for p, f in chain[at + 1:at + 1 + count] if f == feed]
        here = self.spoken
        if here is None or len(ends) < count or min(math.dist(a, b) for a, b in zip([here, *ends], ends)) < 0.02:
            return 0
        in_xy = "G5" in word
        if in_xy and any(abs(p[2] - here[2]) > 1e-9 for p in ends):
            return 0
        kink = chance.choice([0.0, 0.01, 0.05])
        number = lambda x: float(self.number(x)) * (25.4 if self.inch else 1)  # noqa: E731
        pieces, before = [], chain[at][0] if at else here
        for n, end in enumerate(ends):
            end = tuple(number(x) for x in end)
            after = chain[min(at + 2 + n, len(chain) - 1)][0]
            legs = [[(q - p) / 6 * (1 + chance.uniform(-kink, kink)) + chance.uniform(-kink, kink) * 0.1 * math.dist(here, end)
                     for p, q in pair] for pair in (zip(before, end), zip(here, after))]
            if in_xy:
                legs[0][2] = legs[1][2] = 0.0
            pieces.append((here, tuple(p + v for p, v in zip(here, legs[0])), tuple(p - v for p, v in zip(end, legs[1])), end))
            before, here = here, end
        lines += self.curve_words(word, pieces)
        self.spoken = here
        self.last = dict.fromkeys("XYZ")
        self.begins = True
        return count

    def curve_words(self, word, pieces):
        n, blank = self.number, self.blank
        if word[:8] == "weighted" or word == "BSPLINE":
            return self.weighted_words(word, pieces)
        xy = lambda p: [f"X{n(p[0])}", f"Y{n(p[1])}"]  # noqa: E731
        if word == "G5":
            lines = []
            for k, (a, b, c, d) in enumerate(pieces):
                leaves = [f"I{n(b[0] - a[0])}", f"J{n(b[1] - a[1])}"]
                goes_on = k > 0 and self.target == "linuxcnc" and self.random.random() < 0.4
                lines.append(blank.join(["G5", *xy(d), *([] if goes_on else leaves), f"P{n(c[0] - d[0])}", f"Q{n(c[1] - d[1])}"]))
            return lines
        if word == "G5.1":
            return [blank.join(["G5.1", *xy(d), f"I{n(1.5 * (b[0] - a[0]))}", f"J{n(1.5 * (b[1] - a[1]))}"])
                    for a, b, _, d in pieces]
        if word == "G5.2":
            points = [p for piece in pieces for p in piece[1:]]
            return ["G5.2 P1 L" + str(self.random.choice([2, 3, 4]))] + [blank.join([*xy(p), "P1"]) for p in points] + ["G5.3"]
        if word == "G6.2":
            xyz = lambda p: blank.join([*xy(p), f"Z{n(p[2])}"])  # noqa: E731
            points = [pieces[0][0]] + [p for piece in pieces for p in piece[1:]]
            knots = [0] * 4 + [k for k in range(1, len(pieces)) for _ in range(3)] + [len(pieces)] * 4
            return [blank.join(["G06.2", "P4", f"K{knots[0]}.", xyz(points[0])])] + \
                [blank.join([f"K{k}.", xyz(p)]) for k, p in zip(knots[1:], points[1:])] + [f"K{knots[-1]}."] * 4
        lines = []
        for k, (a, b, c, d) in enumerate(pieces):
            words = []
            for axis, name in enumerate("XYZ"):
                end = float(n(d[axis]))
                start = float(n(a[axis]))
                unit = 25.4 if self.inch else 1
                if word == "POLY":
                    second, third = 3 * (a[axis] - 2 * b[axis] + c[axis]), d[axis] - a[axis] - 3 * (c[axis] - b[axis])
                    words.append(f"PO[{name}]=({n(d[axis])},{second / unit:.6f},{third / unit:.6f})")
                else:
                    k1, k2 = round(3 * (c[axis] - d[axis]), 6), round(3 * (b[axis] - 2 * c[axis] + d[axis]), 6)
                    words.append((f"{name}{n(d[axis])}", f" K3{name}{start - end - k1 - k2:+.6f} K2{name}{k2:+.6f} K1{name}{k1:+.6f}"))
            if word == "POLY":
                lines.append(" ".join((["POLY"] if k == 0 else []) + words))
            else:
                lines.append("SPL " + " ".join(w[0] for w in words) + "".join(w[1] for w in words))
        return lines

    def weighted_words(self, word, pieces):
        """The control points of the pieces, with other weights, orders and knots."""
        chance, n, blank = self.random, self.number, self.blank
        # The nearer the control points are to a straight line, the less the weights matter.
        spread = chance.choice([0.0, 0.1, 0.3, 0.6])
        places = [pieces[0][0]]
        for a, b, c, d in pieces:
            size = spread * math.dist(a, d)
            places += [(p[0] + chance.uniform(-size, size), p[1] + chance.uniform(-size, size), p[2]) for p in (b, c)] + [d]
        decimals = chance.choice([2, 3, 4])
        weight = lambda: f"{chance.uniform(0.4, 2.5):.{decimals}f}"  # noqa: E731
        xyz = lambda p: [name + n(x) for name, x in zip("XYZ", p)]  # noqa: E731
        if word == "weighted G5.2":
            order = chance.choice([k for k in (2, 3, 3, 4, 5, 6) if k <= len(places)])
            lines = [blank.join([*xyz(p)[:2], f"P{weight()}"]) for p in places[1:]]
            if chance.random() < 0.5:
                return [f"G5.2{blank}L{order}", *lines, "G5.3"]
            return [f"G5.2{blank}{lines[0]}{blank}L{order}", *lines[1:], "G5.3"]
        if word == "weighted G6.2":
            order = chance.choice([2, 3, 4, 4])
            most = chance.choice([1, order - 1])  # how often an inner knot stands at most
            knots, at = [0] * order, 0
            while len(knots) < len(places):
                at += chance.choice([1, 2, 5])
                knots += [at] * min(most, len(places) - len(knots))
            knots += [at + chance.choice([1, 2, 5])] * order
            lines = [blank.join([f"K{k}.", *xyz(p), f"R{weight()}"]) for k, p in zip(knots, places)]
            return [f"G06.2{blank}P{order}{blank}{lines[0]}", *lines[1:]] + [f"K{knots[-1]}."] * order
        if word.endswith("BSPLINE"):
            lengths = [f"{chance.uniform(0.5, 3):.2f}" for _ in places[3:]] + ["0", "0"]
            weights = [f" PW={weight()}" if word[:8] == "weighted" else "" for _ in lengths]
            lines = [" ".join([*xyz(p), f"PL={length}"]) + w for p, length, w in zip(places[1:], lengths, weights)]
            return [f"BSPLINE SD=3 {lines[0]}", *lines[1:]]
        return [("POLY " if k == 0 else "") + self.poly_words(places[3 * k:3 * k + 4], weight) for k in range(len(pieces))]

    def poly_words(self, piece, weight):
        """A Bezier curve of degree 3 to 5, with weights or without, by its polynomials."""
        chance, unit = self.random, 25.4 if self.inch else 1
        degree = chance.choice([3, 4, 5])
        control = [list(p) for p in piece]
        while len(control) <= degree:
            k = len(control)
            control = [[(i * p + (k - i) * q) / k for p, q in zip(control[max(i - 1, 0)], control[min(i, k - 1)])]
                       for i in range(k + 1)]
        size = math.dist(piece[0], piece[3]) if degree > 3 else 0.0
        control[1:-1] = [[p[0] + chance.uniform(-0.2, 0.2) * size, p[1] + chance.uniform(-0.2, 0.2) * size, p[2]]
                         for p in control[1:-1]]
        weights = [1.0] + [float(weight()) if degree == 3 or chance.random() < 0.6 else 1.0 for _ in range(degree)]
        length = chance.choice([1, 1, 0.5, 2, 3])
        chains = [[w * p[axis] for w, p in zip(weights, control)] for axis in range(3)] + [weights]
        # a_k of each: k-th differences of the Bernstein coefficients.
        chains = [[math.comb(degree, k) * math.fsum((-1) ** (k - i) * math.comb(k, i) * b[i] for i in range(k + 1)) / length ** k
                   for k in range(degree + 1)] for b in chains]
        words = []
        for axis, a in enumerate(chains[:3]):
            if axis == 2 and all(p[2] == piece[0][2] for p in piece) and chance.random() < 0.5:
                continue
            words.append(f"PO[{'XYZ'[axis]}]=({','.join([self.number(piece[3][axis])] + [f'{x / unit:.6f}' for x in a[2:]])})")
        if set(weights) != {1.0}:
            words.append(f"PO[]=({','.join([str(weights[-1])] + [f'{x:.6f}' for x in chains[3][2:]])})")
        return " ".join(words + ([f"PL={length}"] if length != 1 else []))

    def between_chains(self, style):
        if style == "plasma" and not self.klartext:
            return ["M3 S1" if self.like != "siemens" else "M3", {"siemens": "G4 F0.2"}.get(self.like, "G4 P0.2")]
        if style == "drilling" and self.like in ("linuxcnc", "fanuc"):
            p = self.point
            return [f"G81 X{self.random.randrange(9)}{p} Y3{p} Z-3{p} R2{p} F100{p}", f"X9{p} Y9{p}", "G80"]
        return []

    # --- styles: chains of (place, feed) ---

    def curve(self, count, step, turn, start, angle, feed, z=lambda s: 0.0):
        """Turning by `turn` rad/mm that changes evenly to its second value."""
        x, y = start
        chain = [((x, y, z(0)), feed)]
        for n in range(count):
            angle += (turn[0] + (turn[1] - turn[0]) * n / count) * step
            x, y = x + step * math.cos(angle), y + step * math.sin(angle)
            chain.append(((x, y, z((n + 1) * step)), feed))
        return chain

    def contours(self):
        chance = self.random
        r, lobes, amplitude = chance.uniform(4, 15), chance.choice([0, 2, 3, 5]), chance.choice([0.0, 0.1, 0.2])
        count, feed, out = chance.choice([24, 40, 70]), chance.choice([500, 1500, 3000]), []
        for depth in range(chance.choice([1, 2])):
            chain = []
            for n in range(count + 1):
                t = 2 * math.pi * n / count
                radius = r * (1 + amplitude * math.cos(lobes * t))
                chain.append(((radius * math.cos(t), radius * math.sin(t), -1.0 - depth), feed))
            out.append(chain)
        return out

    def raster(self):
        chance = self.random
        rows, count, wave, rise = chance.choice([2, 3, 5]), chance.choice([12, 20]), chance.uniform(0.1, 0.5), chance.uniform(0.2, 1.5)
        feed, chain = chance.choice([800, 2000]), []
        for row in range(rows):
            for n in range(count + 1):
                x = (n if row % 2 == 0 else count - n) * 0.8
                chain.append(((x, row * 0.7, rise * math.sin(wave * x + 0.3 * row)), feed))
        if chance.random() < 0.4:
            chain = [((y, x, z), f) for (x, y, z), f in chain]
        return [chain]

    def waterlines(self):
        chance = self.random
        out, r = [], chance.uniform(3, 8)
        for level in range(chance.choice([2, 3])):
            count = chance.choice([20, 30])
            out.append([(((r + level) * math.cos(2 * math.pi * n / count), 0.7 * (r + level) * math.sin(2 * math.pi * n / count),
                          -0.5 * level), 1200) for n in range(count + 1)])
        return out

    def adaptive(self):
        chance = self.random
        chain, x = [], 0.0
        for loop in range(chance.choice([2, 4])):
            for n in range(18):
                t = 2 * math.pi * n / 18
                feed = 2400 if n < 9 else chance.choice([2400, 900])
                chain.append(((x + 2 * math.cos(t), 2 * math.sin(t), -1.0), feed))
            x += 0.8
        return [chain]

    def engraving(self):
        chance = self.random
        return [self.curve(chance.choice([4, 9, 14]), chance.choice([0.05, 0.2, 0.4]), (chance.uniform(-2, 2), chance.uniform(-2, 2)),
                           (3.0 * n, chance.uniform(0, 3)), chance.uniform(0, 6), 600, lambda s: -0.2) for n in range(chance.choice([2, 4]))]

    def plasma(self):
        chance = self.random
        return [self.curve(chance.choice([12, 25]), 1.0, (chance.uniform(-0.1, 0.1), chance.uniform(-0.1, 0.1)), (30.0 * n, 0.0),
                           chance.uniform(0, 6), 3200) for n in range(2)]

    def laser(self):
        chance = self.random
        return [self.curve(chance.choice([15, 30]), chance.choice([0.1, 0.5]), (0.0, chance.uniform(-0.5, 0.5)), (0.0, 5.0 * n),
                           0.0, 4000) for n in range(2)]

    def printer(self):
        chance = self.random
        chain = []
        for n in range(chance.choice([20, 45])):
            t = 0.25 * n
            chain.append((((5 + 0.05 * n) * math.cos(t), (5 + 0.05 * n) * math.sin(t), 0.2 + 0.01 * n * chance.choice([0, 1])),
                          1800))
        return [chain]

    def drilling(self):
        return self.contours()[:1] + self.plasma()[:1]

    def finishing(self):
        chance = self.random
        a, b = chance.uniform(0.05, 0.3), chance.uniform(0.05, 0.3)
        return [self.curve(chance.choice([30, 50]), chance.choice([0.3, 0.6]), (chance.uniform(-0.2, 0.2), chance.uniform(-0.2, 0.2)),
                           (0.0, 4.0 * n), chance.uniform(0, 1), chance.choice([1000, 5000]),
                           lambda s: math.sin(a * s) + 0.3 * math.cos(b * s)) for n in range(chance.choice([1, 2]))]
