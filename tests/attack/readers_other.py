"""Readers of Siemens words and of Klartext; see readers.py."""

import re

import paths
from readers import NUMBER, PLANES, PlainReader, Reader, Unknown

ARGUMENTS = r"\((?:[^()]|\([^()]*\))*\)"


class SiemensReader(PlainReader):
    KEEPS = {"SOFT", "BRISK", "DRIVE", "FFWON", "FFWOF", "STOPRE", "MSG", "CYCLE832", "G601", "G602", "G603", "DYNNORM",
             "COMPOF"}
    PATH = {"G60", "G64", "G641", "G642", "G643", "G644", "G645"}
    ON = {"COMPON": "compressor", "COMPCURV": "compressor", "COMPCAD": "compressor", "TRAORI": "transformation",
          "ROT": "rotation", "AROT": "rotation", "SCALE": "scaling", "MIRROR": "mirror"}
    PIECE = re.compile(rf"(PO\[[XYZ]?\]|PL|PW|SD|CR|RPL|[A-Z])=({ARGUMENTS}|[A-Z]+{ARGUMENTS}|[A-Z0-9_.+*/-]+)|([A-Z])({NUMBER})"
                       rf"|([A-Z_][A-Z_][A-Z0-9_]*)({ARGUMENTS})?")

    def __init__(self, text, effect="nothing", inch=None, kind="siemens"):
        super().__init__(text, effect, inch, kind)
        self.inches = {70: True, 71: False, 700: True, 710: False}
        self.labels = set(re.findall(r"GOTO[FBC]?\s+([A-Z0-9_]+)", text.upper()))
        self.any_call = False
        self.modal_call = False
        self.spline = None  # of BSPLINE: points, weights, lengths of spans, words
        self.lines.append("")  # ends a curve at the end

    def follow(self, line):
        body = line.split(";")[0].strip()
        upper = body.upper()
        if self.spline is not None and not re.search(r"\bPL\s*=", upper):
            self.spline_end()
        if not upper or upper.startswith("%"):
            return
        if upper.startswith("/"):
            self.used_effects.add("deleted")
            if self.effect == "deleted":
                return
            upper = upper.lstrip("/")
        label = re.match(r"\s*N(\d+)\s*", upper)
        if label:
            if "N" + label.group(1) in self.labels:
                self.act("anything")
            upper = upper[label.end():]
        named = re.match(r"\s*([A-Z_][A-Z0-9_]+):\s*", upper)
        if named:
            self.event(upper)
            if named.group(1) in self.labels:
                self.act("anything")
            return
        if not upper:
            return
        if re.match(r"R\d+\s*=", upper) or re.match(r"DEF\b|EXTERN\b", upper):
            return self.event(upper)
        if re.match(r"GOTO", upper):
            return self.opaque(upper, None)
        if (re.search(r"RND|CHF|CHR|G153|SUPA", upper) and
                re.fullmatch(r"((RND|CHF|CHR)\s*=\s*|G153\b|SUPA\b|[XYZF\d.\s+-])+", upper)):
            return self.opaque(upper, "moves")  # with a cut corner behind it, or in the machine's axes
        try:
            self.statement(upper, " ".join(upper.split()))
        except Unknown:
            self.opaque(upper)

    def statement(self, body, raw):
        values, codes, names, at = {}, [], [], 0
        while at < len(body):
            if body[at].isspace():
                at += 1
                continue
            found = self.PIECE.match(body, at)
            if not found:
                raise Unknown
            at = found.end()
            if found.group(1):
                name, text = found.group(1), found.group(2)
                if name in values:
                    raise Unknown
                values[name] = float(text) if re.fullmatch(NUMBER, text) else text
            elif found.group(3):
                name, number = found.group(3), float(found.group(4))
                if name in "GM":
                    codes.append(f"{name}{found.group(4).lstrip('0') or '0'}" if float(found.group(4)) else name + "0")
                elif name in values:
                    raise Unknown
                else:
                    values[name] = number
            else:
                names.append((found.group(5), found.group(6)))
        if names or codes:
            self.spline_end()
        if "L" in values or "T" in values and isinstance(values["T"], str) and not values["T"]:
            raise Unknown
        for name, arguments in names:
            if codes and name in ("TRANS", "ATRANS", "ROT", "AROT", "SCALE", "MIRROR"):
                self.siemens_words({}, codes, raw)  # the values are those of the frame
            if name in ("TRANS", "ATRANS", "SUPA", "G153"):
                self.event(raw)
                self.act("moves")
                if not values:
                    for switched in ("rotation", "scaling", "mirror"):
                        self.unsafe.discard(switched)
                    return
                return
            if name in ("ROT", "SCALE", "MIRROR", "AROT"):
                self.event(raw)
                self.act("moves")
                if "RPL" in raw or values:
                    self.unsafe.add(self.ON[name])
                else:
                    self.unsafe -= {"rotation", "scaling", "mirror"}
                return
            if name == "MCALL":
                self.event(raw)
                self.modal_call = len(names) > 1 or bool(arguments)
                (self.unsafe.add if self.modal_call else self.unsafe.discard)("cycle")
                return self.act("moves")
            if name == "COMPOF":
                if "compressor" in self.unsafe:
                    self.unsafe.discard("compressor")
                    self.event(name)
                continue
            if name in ("COMPON", "COMPCURV", "COMPCAD"):
                self.unsafe.add("compressor")
                self.event(name)
                continue
            if name == "POLY":
                self.motion = "POLY"
                continue
            if name == "BSPLINE":
                self.spline_end()
                self.motion = "BSPLINE"
                self.spline = ([tuple(self.place)], [1.0], [], [])
                continue
            if name.startswith("POCKET"):  # a cycle of the control: modal functions are as before
                self.event(raw)
                return self.act("moves")
            if name not in self.KEEPS:
                raise Unknown
            self.event(name + (arguments or ""))
        if "M98" in codes or "M99" in codes:
            raise Unknown
        self.siemens_words(values, codes, raw)

    def siemens_words(self, values, codes, raw):
        for code in codes:
            if code in ("G93", "G94", "G95"):
                self.feed_mode, self.feed = int(code[1:]), None
        if "F" in values and "G4" not in codes:
            self.feed = (values["F"], self.inch)
        if "S" in values:
            self.switch("speed", values["S"])
        for letter in "TDH":
            if letter in values:
                self.event(f"{letter}{values[letter]}")
                if letter != "H":
                    self.act("moves")
        taken = "G4" in codes
        for code in codes:
            if code in self.PATH:
                self.switch("path", code)
            elif code in ("G601", "G602", "G603"):
                self.event(code)
            elif code[0] == "G" and code[1:].isdigit() and int(code[1:]) in (500, 505, 506, 507):
                self.event(code)
                self.act("moves")
            elif code in ("G63", "G331", "G332", "G33"):
                self.motion, self.cycle = code, True
            elif code in ("G74", "G75"):
                raise Unknown
            elif code == "G4" or code == "G9":
                self.event(raw)
            elif self.knows(code, values):
                taken = self.code(code, values, raw) or taken
            else:
                raise Unknown
        strings = {k: v for k, v in values.items() if isinstance(v, str) and k in "XYZIJK"}
        if strings:
            self.event(f"{self.motion} {raw} [{self.state()}]")
            for axis, text in strings.items():
                found = re.fullmatch(rf"IC\(({NUMBER})\)", text)
                if axis in "XYZ":
                    n = "XYZ".index(axis)
                    self.place[n] = self.place[n] + self.length(float(found.group(1))) if found else 1.5
            values = {k: v for k, v in values.items() if k not in strings}
            self.place = self.end_of(values)
        elif not taken and any(k in values for k in ("X", "Y", "Z", "I", "J", "K", "PO[X]", "PO[Y]", "PO[Z]", "CR",
                                                     "A", "B", "C", "U", "V", "W", *(["PL"] if self.spline else []))):
            self.siemens_go(values, raw)
        for code in codes:
            if code in ("M0", "M1"):
                self.event(code)
            elif code in ("M2", "M30"):
                self.event(f"{code} {self.state()}")
                self.ended = True

    def spline_line(self, values, raw):
        """A control point of BSPLINE; PL is the length of the span that it ends."""
        if self.spline is None or not self.absolute or values.keys() - set("XYZFN") - {"PL", "PW", "SD"} or \
                "F" in values and self.spline[2] or not {type(x) for x in values.values()} <= {float}:
            self.spline_end()
            raise Unknown
        points, weights, lengths, texts = self.spline
        last = list(points[-1])
        for n, letter in enumerate("XYZ"):
            if letter in values:
                last[n] = self.length(values[letter])
        points.append(tuple(last))
        weights.append(values.get("PW", 1.0))
        # No length for another degree: it is refused.
        lengths.append(values["PL"] if values.get("SD", 3.0) == 3.0 else -1.0)
        texts.append(raw)

    def spline_end(self):
        if self.spline is None:
            return
        points, weights, lengths, texts = self.spline
        self.spline = None
        clamped = len(lengths) >= 3 and not any(lengths[-2:]) and lengths[0] and lengths[-3] and min(lengths) >= 0
        if not clamped or min(weights) <= 0:
            self.event(f"refused {' '.join(texts)}")
            self.place = list(points[-1])
            return
        knots = [0.0] * 4
        for length in lengths[:-2]:
            knots.append(knots[-1] + length)
        self.move(paths.nurbs_points(4, points, weights, knots + knots[-1:] * 3), False, " ".join(texts))

    def siemens_go(self, values, raw):
        if self.motion == "BSPLINE":
            return self.spline_line(values, raw)
        if self.motion != "POLY":
            if any(k.startswith("PO") for k in values):
                raise Unknown  # a straight line, without an alarm
            if "CR" in values:
                values["R"] = values.pop("CR")
            return self.go(values, raw)
        length = values.get("PL", 1.0)
        try:
            numbers = {name: [float(t) for t in str(text).strip("()").split(",")] for name, text in values.items()
                       if name[:3] == "PO["}
        except ValueError:
            raise Unknown from None
        if not self.absolute or any(len(a) > 5 for a in numbers.values()):
            raise Unknown

        def polynomial(begin, end, others):
            """In p / PL: a0, what is left for a1, a2 .."""
            higher = [a * length ** k for k, a in enumerate(others, 2)]
            return [begin, end - begin - sum(higher), *higher]

        weight = numbers.get("PO[]", [1.0])
        denominator, axes, end = polynomial(1.0, weight[0], weight[1:]), [], list(self.place)
        for n, letter in enumerate("XYZ"):
            if f"PO[{letter}]" in numbers:
                last, *others = (self.length(a) for a in numbers[f"PO[{letter}]"])
            elif letter in values:
                last, others = self.end_of({letter: values[letter]})[n], []
            else:  # it does not move
                axes.append([end[n] * b for b in denominator])
                continue
            axes.append(polynomial(end[n], last * weight[0], others))
            end[n] = last
        points = paths.polynomial_points(axes, denominator)
        if points is None:
            self.event(f"refused {raw}")
            self.place = end
            return
        self.move([*points[:-1], tuple(end)], False, raw)


class KlartextReader(Reader):
    WORD = re.compile(rf"(I?[XYZ]|K[123][XYZ])\s*([-+]?[\d.,]+(?:E[-+]\d+)?)|(DR)([-+])|(R)([0LR])(?![\d.])|(R)([-+]?[\d.,]+)|"
                      rf"(F)\s*(MAX|AUTO|[\d.,]+)|(M)(\d+)")
    STILL = re.compile(r"BLK FORM|TOOL DEF|Q\w*\d+\s*=|FN ([0-9]|1[0-2]):|CYCL DEF (32|9|200)\b|CYCL DEF (32|9)\.")
    # Behind them the tool is elsewhere.
    MOVES = re.compile(r"CYCL CALL|(LP|CP|CT|CTP|LN|RND|CHF|DEP|F|FL|FC|FLT|FCT|FPOL)\b|APPR|CYCL DEF (220|221)|"
                       r"L .*([XYZ][-+]?Q|\bM9[89]|\bM140\b)")
    # What may be on behind them, whether they say so or not.
    SWITCHES = re.compile(r"PLANE\b|FUNCTION TCPM|CYCL DEF (7|8|10|11|19|26|247)\.")

    def __init__(self, text, effect="nothing", inch=None):
        super().__init__(text, effect, inch)
        self.pole, self.begun = None, False
        self.labels = set(re.findall(r"(?:CALL|GOTO) LBL\s*(\S+)", text))
        # A statement that goes on behind ~ is one, and the coefficients below an SPL are its own.
        text = re.sub(r"~[ \t]*(;[^\n]*)?\r?\n", " ", text)
        self.lines = re.sub(r"(SPL [^\n;]*)\r?\n(?=[ \t]*K[123][XYZ])", r"\1 ", re.sub(
            r"(SPL [^\n;]*)\r?\n(?=[ \t]*K[123][XYZ])", r"\1 ", text)).split("\n")

    def follow(self, line):
        body = re.sub(r"^\s*\d+(?=\s|$)", "", line.split(";")[0].upper()).strip()
        if not body or body.startswith("*"):
            return
        name = body.split()[0]
        if body.startswith("/"):
            self.used_effects.add("deleted")
            if self.effect == "deleted":
                return
            body = body[1:].strip()
            name = body.split()[0]
        try:
            if self.MOVES.match(body):
                self.opaque(body, "moves")
                if re.search(r"\bM99\b", body):  # ends the modal call
                    self.unsafe.discard("M89")
                if re.search(r"\bR[LR]\b", body):
                    self.unsafe.add("compensation")
            elif name == "L" and re.search(r"\bI?[ABCUVW][-+]", body):
                self.event(f"{body} [{self.state()}]")
            elif name in ("BEGIN", "END"):
                self.event(body)
                self.inch = body.endswith("INCH") if name == "BEGIN" else self.inch
            elif name in ("L", "CC", "C", "CR", "SPL"):
                self.move_of(name, body[len(name):], body)
            elif re.fullmatch(r"M\d+|F(MAX|AUTO|\d+)|R[0LR]", name):  # as old controls print them
                self.move_of("L", body, body)
            elif name == "LBL":
                self.event(body)
                if body.split()[1:] and body.split()[1] in self.labels:
                    self.act("anything")
            elif self.STILL.match(body):
                self.event(body)
                if body.startswith("CYCL DEF 200"):  # a new cycle ends the modal call of the last one
                    self.unsafe.discard("M89")
            elif self.SWITCHES.match(body):
                self.event(body)
                self.act("moves")
                if not re.match(r"CYCL DEF (7|247)|PLANE RESET", body):
                    self.unsafe.add("transformation")
            elif name == "TOOL" and re.match(r"TOOL CALL", body):
                self.event(body)
                if not re.match(r"TOOL CALL [SF]", body):
                    self.act("moves")
                feed = re.search(r"\bF(\d+)", body)
                self.feed = (float(feed.group(1)), self.inch) if feed else self.feed
            elif name == "STOP":
                self.event(body)
                self.act("moves")
            else:
                raise Unknown
        except Unknown:
            self.opaque(body)

    def move_of(self, name, rest, raw):
        found = [[g for g in m if g] for m in self.WORD.findall(rest)]
        if "".join(a + b for a, b in found) != "".join(rest.split()):
            raise Unknown
        values, codes, feed_max = {}, [], False
        for letter, text in found:
            if letter == "M":
                codes.append(int(text))
            elif letter == "F" and text == "MAX":
                feed_max = True
            elif letter == "F":
                self.feed = (text if text == "AUTO" else float(text.replace(",", ".")), self.inch)
            elif letter == "R" and text in "0LR":
                if text == "0":
                    if "compensation" in self.unsafe:
                        self.unsafe.discard("compensation")
                        self.event("R0")
                else:
                    self.unsafe.add("compensation")
            elif letter in values:
                raise Unknown
            else:
                values[letter] = text if letter == "DR" else float(text.replace(",", "."))
        if 99 in codes or 98 in codes:
            raise Unknown
        for code in codes:
            if code in (89, 124, 128, 136):
                self.unsafe.add(f"M{code}")
            elif code in (129, 137):
                self.unsafe.discard(f"M{code - 1}")
        for code in codes:
            if code in (3, 4, 5):
                self.switch("spindle", code)
            elif code in (8, 9):
                self.switch("coolant", code)
            elif code not in (0, 1, 2, 30):
                self.event(f"M{code}")
                if code >= 89:
                    self.act("moves")
        if 91 in codes or 140 in codes:
            self.event(raw)
            return self.act("moves")
        end = list(self.place)
        for n, letter in enumerate("XYZ"):
            if letter in values:
                end[n] = self.length(values[letter])
            elif "I" + letter in values:
                end[n] += self.length(values["I" + letter])
        if name == "CC":
            self.pole = (end[0], end[1])
        elif set(values) & {letter for letter in values if letter != "DR"} or name != "L":
            self.moves(name, values, end, feed_max, raw)
        for code in codes:
            if code in (6,):
                self.act("moves")
            if code in (0, 1):
                self.event(f"M{code}")
            elif code in (2, 30):
                self.event(f"M{code} {self.state()}")
                self.ended = True

    def moves(self, name, values, end, feed_max, raw):
        turn = 1 if values.get("DR") == "+" else -1
        if name == "L":
            return self.move([tuple(end)], feed_max, raw)
        if name == "SPL":
            control = [[], [], [], []]
            for n, letter in enumerate("XYZ"):
                k3, k2, k1 = (self.length(values.get(f"K{d}{letter}", 0.0)) for d in (3, 2, 1))
                if letter not in values:
                    k1 = 0.0
                if abs(k3 + k2 + k1 + end[n] - self.place[n]) > 0.0011:
                    self.event("refused spline")
                # x(t) = k3 t^3 + k2 t^2 + k1 t + end, from t = 1 to 0: its Bezier points from t = 0 to 1.
                b = (end[n], end[n] + k1 / 3, end[n] + (2 * k1 + k2) / 3, end[n] + k1 + k2 + k3)
                for chain, value in zip(control, reversed(b)):
                    chain.append(value)
            return self.move(paths.cubic_points(*control), False, raw)
        centre = self.pole if name == "C" else paths.centre_by_radius(
            self.place, end, self.length(values.get("R", 0.0)), PLANES[17], turn)
        if centre is None or "DR" not in values:
            self.event(f"refused {raw}")
            self.place = end
            return
        radii = [((p[0] - centre[0]) ** 2 + (p[1] - centre[1]) ** 2) ** 0.5 for p in (self.place, end)]
        if abs(radii[0] - radii[1]) > 0.016:
            self.event(f"refused {raw}")
        self.move(paths.arc_points(self.place, end, centre, PLANES[17], turn), False, raw)


def reader_for(control):
    """Of a target's programs: a class, called with text, effect and unit."""
    if control in ("siemens", "siemens-bspline"):
        return SiemensReader
    if control in ("heidenhain", "itnc530"):
        return KlartextReader
    return lambda text, effect="nothing", inch=None: PlainReader(text, effect, inch, control)
