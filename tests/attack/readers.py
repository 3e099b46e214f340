"""What programs do, read without any code of Batten: plain words (RS-274 with the curves of LinuxCNC,
FANUC and Marlin), Siemens words, Klartext.

A reader follows a program line by line and gives its trace: ("cut", feed, points), ("rapid", None,
points), ("event", None, text) and ("part", None, the tolerance that a comment states), in mm. What a control may do that no reader can know is played:
a word that nobody knows, a call, a label that is jumped to does what `effect` says (EFFECTS). A new
program has to do the same as the old one whatever that is. Where the words are not the path (cutter
compensation, rotation, inverse time ..), a move is an event with its words."""

import re

import paths

EFFECTS = ("nothing", "deleted", "incremental", "units", "plane", "feed", "shift", "rapid", "compensated", "rotated",
           "scaled", "inverse", "centres")
SHIFT = (7.0, -3.0, 2.0)
# Of a control that has no such thing, or of which it is known what an unknown word does. Printers have neither
# compensation nor rotation, scaling, inverse time and arc centres from the origin (Klipper: klippy/extras/gcode_arcs.py
# and gcode_move.py; Marlin: the list of G-codes in its docs), so that no macro of theirs can turn one on.
NO_WORD_OF_PRINTERS = {"units", "compensated", "rotated", "scaled", "inverse", "centres"}
NEVER = {"grbl": {*EFFECTS} - {"nothing", "shift", "deleted"}, "klipper": NO_WORD_OF_PRINTERS, "marlin": NO_WORD_OF_PRINTERS,
         "linuxcnc": {"scaled"}, "klartext": {"units"}}
LIKE_FANUC = ("fanuc", "syntec", "mitsubishi")
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)"
WORD = re.compile(rf"([A-Z])({NUMBER})")
# No words of a number alone: their lines are kept as they are.
# A comment by itself that says how exact the part behind it has to be.
STATED = re.compile(r"\s*(?:N?\d+\s*)?[(;]\s*TOLERANCE ([\d.]+)( MM)?\s*\)?\s*$")
FLOW = re.compile(r"\b(IF|WHILE|GOTO|END|DO|THEN)\b|^\s*N?\d*\s*O\d+\s*[A-Z]|^\s*O<", re.I)


class Unknown(Exception):
    """A line that may do anything."""


class Uncertain(Exception):
    """A word whose number nobody knows."""


def number_text(value):
    return f"{value:.6g}"


class Reader:
    """What all three have in common: the state, moves and events."""

    look_ahead = None

    def __init__(self, text, effect="nothing", inch=None, kind="klartext"):
        self.lines, self.kind = text.split("\n"), kind
        self.effect = effect
        self.trace, self.used_effects = [], {"nothing"}
        self.place, self.motion, self.plane = [0.0, 0.0, 0.0], None, 17
        self.absolute, self.centres_absolute, self.inch = True, False, inch
        self.feed, self.feed_mode, self.unsafe = None, 94, set()
        self.switches, self.offset = {}, (0.0, 0.0, 0.0)
        self.ended = False

    def run(self):
        for line in self.lines:
            if self.ended:
                break
            self.follow(line.rstrip("\r"))
            if stated := STATED.match(line):
                number = float(stated.group(1))
                self.trace.append(("part", None, number if stated.group(2) else self.length(number)))
        self.event("end " + self.state())
        return self.trace

    # --- what happens ---

    def event(self, text):
        self.trace.append(("event", None, text))

    def switch(self, name, value):
        """Of a control that remembers it: saying it again is nothing."""
        if self.switches.get(name) != value:
            self.switches[name] = value
            self.event(f"{name} {value}")

    def state(self):
        return (f"plane {self.plane} absolute {self.absolute} centres {self.centres_absolute} inch {self.inch} "
                f"feed {self.feed} {self.feed_mode} {sorted(self.unsafe)}" +
                (f" G05 P{self.look_ahead}" if self.look_ahead else ""))

    def opaque(self, line, acts="anything"):
        """A line that is the same in both programs, and what it may have done."""
        self.event(" ".join(line.split()) + (f" [{self.state()}]" if acts == "anything" else ""))
        if acts:
            self.act(acts)

    def act(self, acts):
        """Something happens here that no text tells."""
        self.used_effects |= {"moves": {"shift"}, "anything": set(EFFECTS) - NEVER.get(self.kind, set())}[acts]
        does = self.effect
        if does == "shift":
            self.place = [x + s for x, s in zip(self.place, SHIFT)]
        elif acts == "moves":
            return
        elif does == "incremental":
            self.absolute = False
        elif does == "units":
            self.inch = not self.inch
        elif does == "plane":
            self.plane = 18
        elif does == "feed":
            self.feed = 77.0
        elif does == "rapid":
            self.motion = 0
        elif does in ("compensated", "rotated", "scaled"):
            self.unsafe.add({"compensated": "compensation", "rotated": "rotation", "scaled": "scaling"}[does])
        elif does == "inverse":
            self.feed_mode = 93
        elif does == "centres":
            self.centres_absolute = True

    def length(self, number):
        return number * (25.4 if self.inch else 1.0)

    def move(self, points, rapid, words):
        """`points` without the place where it begins; `words` is what stands for it in an unsafe state."""
        begin, self.place = self.place, list(points[-1])
        if self.unsafe or self.feed_mode == 93 and not rapid:
            self.event(f"in {sorted(self.unsafe)} {self.feed_mode} {self.motion} {words} [{self.state()}]")
        elif rapid:
            self.trace.append(("rapid", None, [tuple(begin), tuple(points[-1])]))
        else:
            self.trace.append(("cut", (self.feed, self.feed_mode), [tuple(begin), *points]))


class PlainReader(Reader):
    """RS-274. `inches`: the words of the units; `repeats`: motion words count for later lines."""

    def __init__(self, text, effect="nothing", inch=None, kind="linuxcnc"):
        super().__init__(text, effect, inch, kind)
        self.inches = {70: True, 71: False} if kind in ("fagor", "num", "beckhoff") else {20: True, 21: False}
        self.repeats = kind not in ("klipper", "marlin")
        self.parameters, self.nurbs, self.cycle = {}, None, False
        self.onwards = None  # of the last G5: the way in which it arrived
        self.even = None  # of G5.2: its points, their weights, whether they are a curve, order, words
        self.begun = False
        self.defines = ""  # the subprogram whose definition is passed over
        self.offset_code = None
        # Of those that want it around curves: G05 P.
        self.look_ahead = 0 if kind in ("syntec", "mitsubishi") else None
        # Labels that something jumps to: what the control remembers there is not known.
        self.labels = set(re.findall(r"GOTO\s*(\d+)", text.upper()))

    # --- a line as words ---

    def value(self, text):
        """Of an expression without functions."""
        def parameter(m):
            if m.group(1) not in self.parameters:
                raise Uncertain
            return f"({self.parameters[m.group(1)]!r})"
        body = re.sub(r"#(\d+|<[A-Z0-9_]+>)", parameter, text).replace("[", "(").replace("]", ")")
        if not re.fullmatch(r"[-+*/().\d\se]+", body):
            raise Uncertain
        try:
            return float(eval(body, {"__builtins__": {}}))  # digits, points, brackets and operators alone
        except (SyntaxError, ZeroDivisionError, TypeError):
            raise Uncertain from None

    def words_of(self, body):
        words, at = [], 0
        body = "".join(body.split())
        while at < len(body):
            found = WORD.match(body, at)
            if found:
                words.append((found.group(1), float(found.group(2)), found.group(0)))
                at = found.end()
                continue
            found = re.compile(r"([A-Z])([-+]?)([\[#])").match(body, at)
            if not found:
                raise Unknown
            end = found.start(3)
            if found.group(3) == "[":
                depth = 0
                while end < len(body):
                    depth += {"[": 1, "]": -1}.get(body[end], 0)
                    end += 1
                    if depth == 0:
                        break
            else:
                end = re.compile(r"#(\d+|<[A-Z0-9_]+>)?").match(body, end).end()
            number = self.value(body[found.start(3):end]) * (-1 if found.group(2) == "-" else 1)
            words.append((found.group(1), number, found.group(1) + number_text(number)))
            at = end
        return words

    def comments_of(self, line):
        """The line without comments; those that act are events."""
        body = line.split(";")[0] if ";" in line else line
        for comment in re.findall(r"\([^)]*\)", body):
            if re.match(r"\(\s*(MSG|DEBUG|PRINT|LOG|PROBE)", comment, re.I):
                self.event(comment)
        return re.sub(r"\([^)]*\)", " ", body)

    def follow(self, line):
        body = self.comments_of(line).upper()
        stripped = body.strip()
        if not stripped or stripped == "%":
            return
        definition = re.fullmatch(r"(?:N\d+)?O(\d+|<\w+>)(SUB|ENDSUB)", "".join(stripped.split()))
        if self.kind == "linuxcnc" and (self.defines or definition and definition.group(2) == "SUB"):
            self.event("defined " + "".join(body.split()))
            self.defines = self.defines or definition.group(1)
            if definition and definition.groups() == (self.defines, "ENDSUB"):
                self.defines = ""
            return
        if stripped.startswith("/"):
            self.used_effects.add("deleted")
            if self.effect == "deleted":
                return
            body = stripped.lstrip("/")
        if stripped.startswith("$") or re.match(r"(N\d+\s*)?M117\b", stripped):
            return self.opaque(body, None if re.match(r"\$([$#XGI]|\d)", stripped) else "moves")
        label = re.match(r"\s*N(\d+)", body)
        if label:
            if label.group(1) in self.labels:
                self.act("anything")
            body = body[label.end():]
            if not body.strip():
                return
        if re.search(r",\s*[RCA]\s*\d", body):  # a corner is rounded
            return self.opaque(body, "moves")
        if FLOW.search(body):
            keeps = re.search(r"GOTO", body) and not re.search(r"\b(WHILE|DO|END)", body)
            return self.opaque(body, None if keeps else "anything")
        if not self.begun and re.fullmatch(r"\s*[O:]\d+\s*", body):
            return
        assignment = re.fullmatch(r"\s*#(\d+|<[A-Z0-9_]+>)\s*=(.*)", body)
        try:
            if assignment:
                self.event("".join(body.split()))
                try:
                    self.parameters[assignment.group(1)] = self.value(assignment.group(2))
                except Uncertain:
                    self.parameters.pop(assignment.group(1), None)
                return
            words = self.words_of(body)
            self.begun = True
            self.execute(words, body)
        except Uncertain:
            self.begun = True
            if re.search(r"[GMTSHD]\s*[\[#]|\bM\s*9|G\s*(?!0*[0-3](?!\d))", body) or not self.plain(body):
                return self.opaque(body)
            # The words that are known count, the axes with others are anywhere.
            self.opaque(body, None)
            for letter in re.findall(r"([XYZ])\s*[-+]?[\[#]", body):
                self.place["XYZ".index(letter)] += SHIFT[0]
            if re.search(r"F\s*[\[#]", body):
                self.feed = "unknown"
        except Unknown:
            self.begun = True
            self.parameters = {}
            self.opaque(body)

    def plain(self, body):
        """Follows the words with known numbers of a line that has others."""
        rest = re.sub(r"[A-Z]\s*[-+]?(#(\d+|<\w+>)|\[[^\[\]]*\])", " ", body)
        try:
            self.execute([w for w in self.words_of(rest)], rest)
        except (Unknown, Uncertain):
            return False
        return True

    # --- a line of words ---

    def execute(self, words, body):
        letters = [letter for letter, _, _ in words]
        codes = [f"{letter}{number_text(number)}" for letter, number, _ in words if letter in "GM"]
        values = {letter: number for letter, number, _ in words if letter not in "GM"}
        raw = " ".join(text for _, _, text in words)
        if len(values) != sum(letter not in "GM" for letter in letters) or "O" in values:
            raise Unknown
        if self.nurbs is not None and not codes:
            return self.nurbs_line(values)
        if self.even is not None and codes != ["G5.3"]:
            return self.even_line(values, codes, raw)
        known = [code for code in codes if self.knows(code, values)]
        if len(known) < len(codes):
            raise Unknown
        if not self.repeats and not codes:  # the firmware knows no such command
            if "T" in values:
                self.event(raw)
                self.act("moves")
            return None
        if set(codes) & {"M98", "M97", "M99", "M198", "G65", "G66", "M1000"}:
            raise Unknown
        for code in codes:  # before the feed
            if code in ("G93", "G94", "G95"):
                self.feed_mode = int(code[1:])
                self.feed = None
        if "F" in values and "G4" not in codes:
            self.feed = (values["F"], self.inch)
        if "S" in values:
            self.switch("speed", values["S"])
        if "T" in values:
            self.event(f"T{values['T']}")
        moved = False
        for code in codes:
            moved = self.code(code, values, raw) or moved
        if values.keys() & {"H", "D"} and not set(codes) & {"G43", "G41", "G42"}:
            self.event(raw)
            self.act("moves")
        if not moved and values.keys() & set("XYZABCUVWEIJKR"):
            if "G4" not in codes:
                self.go(values, raw)
        for code in codes:
            if code in ("M0", "M1", "M60"):
                self.event(code)
            elif code in ("M2", "M30"):
                self.event(f"{code} {self.state()}")
                self.ended = True

    GROUPS = {"M3": "spindle", "M4": "spindle", "M5": "spindle", "M48": "overrides", "M49": "overrides",
              "G61": "path", "G61.1": "path", "G64": "path", "G98": "retract", "G99": "retract", "G96": "css",
              "G97": "css"}
    UNSAFE = {"G41": "compensation", "G42": "compensation", "G41.1": "compensation", "G42.1": "compensation",
              "G51": "scaling", "G51.1": "mirror", "G68": "rotation", "G16": "polar", "G7": "diameter",
              "G43.4": "centre", "G12.1": "cylinder"}
    SAFE = {"G40": "compensation", "G50": "scaling", "G50.1": "mirror", "G69": "rotation", "G15": "polar",
            "G8": "diameter", "G13.1": "cylinder"}
    OFFSETS = {f"G{n}" for n in (*range(54, 60), 59.1, 59.2, 59.3)}
    # Mill operator's manual; G112 and G113 are others.
    OFFSETS_OF_HAAS = {"G110", "G111", *(f"G{n}" for n in range(114, 130))}
    SHIFTS = ("G10", "G28", "G30", "G28.1", "G30.1", "G43", "G43.1", "G44", "G49", "G52", "G53", "G92", "G92.1",
              "G92.2", "G92.3", "M6", "M61")
    ONCE = ("M50", "M51", "M52", "M53", "M62", "M63", "M64", "M65", "M66", "M67", "M68", "M19", "M10", "M11", "G5.1",
            "G187", "G4")
    CYCLES = {f"G{n}" for n in (73, 74, 76, *range(81, 90))}

    def offsets(self):
        return self.OFFSETS | (self.OFFSETS_OF_HAAS if self.kind == "haas" else set())

    def knows(self, code, values):
        if code[0] == "M":
            return True
        if code in ("G5", "G5.1"):
            return self.kind in ("linuxcnc", "marlin", "grblhal", *LIKE_FANUC)
        if code in ("G5.2", "G5.3"):
            return self.kind == "linuxcnc"
        if code == "G6.2":
            return self.kind in LIKE_FANUC
        return code in {"G0", "G1", "G2", "G3", "G17", "G18", "G19", "G90", "G91", "G90.1", "G91.1", "G93", "G94",
                        "G95", "G80", "G33", "G38.2", "G4", "G9", *self.GROUPS, *self.UNSAFE, *self.SAFE,
                        *self.offsets(), *self.SHIFTS, *self.ONCE, *self.CYCLES} or \
            code[0] == "G" and code[1:].isdigit() and int(code[1:]) in self.inches

    def code(self, code, values, raw):
        """Whether the axis words belong to it."""
        number = code[1:]
        if code[0] == "G" and number.isdigit() and int(number) in self.inches:
            self.inch = self.inches[int(number)]
        elif code in ("G0", "G1", "G2", "G3"):
            self.motion, self.cycle, self.onwards = int(number), False, None
        elif code in ("G17", "G18", "G19"):
            self.plane = int(number)
        elif code in ("G90", "G91"):
            self.absolute = code == "G90"
        elif code in ("G90.1", "G91.1"):
            self.centres_absolute = code == "G90.1"
        elif code == "G5" and not (self.kind in LIKE_FANUC and "X" not in values and "Y" not in values):
            self.motion, self.cycle = "5", False
        elif code == "G6.2":
            self.motion, self.nurbs = "6.2", ([], [], [], int(values.get("P", 4)), raw)
            self.nurbs_line(values)
            return True
        elif code == "G80":
            self.switch("cycle", "off")
            self.motion, self.cycle = "80", False
        elif code in self.CYCLES:
            self.switches["cycle"] = code
            self.motion, self.cycle = code, True
        elif code in self.UNSAFE:
            self.unsafe.add(self.UNSAFE[code])
            self.event(raw)
            return True
        elif code in self.SAFE:
            if self.SAFE[code] in self.unsafe:
                self.unsafe.discard(self.SAFE[code])
                self.event(code)
                self.act("moves")
        elif code in self.GROUPS:
            # Path control counts each time it is said.
            text = " ".join([code, *(t for t in raw.split() if t[0] in "PQR")]) if self.GROUPS[code] == "path" else code
            self.switch(self.GROUPS[code], text)
        elif code in ("M7", "M8", "M9"):
            if code == "M9":
                self.switch("M7", "off")
                self.switch("M8", "off")
            else:
                self.switch(code, "on")
        elif code in self.offsets():
            if self.offset_code != code:
                self.event(code)
                self.act("moves")
            self.offset_code = code
        elif code in self.SHIFTS:
            self.event(" ".join([code, *(t for t in raw.split() if t[0] not in "GMFST")]))
            if code == "G49":
                self.unsafe.discard("centre")
            named = [n for n, letter in enumerate("XYZ") if letter in values]
            if code in ("G92", "G28", "G30", "G53") and named:
                self.used_effects.add("shift")
                for n in named:
                    self.place[n] += SHIFT[n] if self.effect == "shift" else 0.0
            elif not (code == "G92" and values):
                self.act("moves")
            return True
        elif code == "G5.2":
            self.motion, self.cycle, self.onwards = code, True, None
            has_point = bool(values.keys() & set("XY"))
            self.even = [[tuple(self.place)], [1.0], has_point or values.get("P", 1.0) == 1.0, values.get("L", 3.0), raw]
            if has_point:
                self.even_line({name: x for name, x in values.items() if name not in "LF"}, [], "")
            return True
        elif code == "G5.3":
            self.motion, self.cycle = code, True
            self.even_end()
            return True
        elif code in ("G33", "G38.2"):
            self.motion, self.cycle, self.onwards = code, True, None
        elif code == "G5" and self.look_ahead is not None:
            self.look_ahead = values.get("P", 0)
            return True
        elif code == "G5.1" and self.kind == "linuxcnc" and {"I", "J"} <= values.keys():
            self.motion, self.cycle, self.onwards = "5.1", False, None
        elif code in ("G5.1", "G187", "G5"):
            self.event(raw)
            if code == "G5.1" and values.get("Q", 0) > 1:
                self.unsafe.add("smoothing")
            elif code == "G5.1":
                self.unsafe.discard("smoothing")
            return True
        elif code == "G9" or code in self.ONCE:
            self.event(raw)
        elif code[0] == "M" and code not in ("M0", "M1", "M2", "M30", "M60"):
            self.event(raw)
            if "." in number or int(number) >= 100:
                self.act("moves")
        return False

    def end_of(self, values):
        end = list(self.place)
        for n, letter in enumerate("XYZ"):
            if letter in values:
                length = self.length(values[letter])
                end[n] = length if self.absolute else end[n] + length
        return end

    def go(self, values, raw):
        end = self.end_of(values)
        words = " ".join(text for text in raw.split() if text[0] not in "MTSF")
        if self.motion is None or self.cycle or self.motion == "80" or values.keys() & set("ABCUVWE"):
            if self.motion == 0 and not values.keys() & set("ABCUVWE"):
                pass
            else:
                self.event(f"{self.motion} {words} [{self.state()}]")
                self.place = end
                return
        if not values.keys() & set("XYZ") and self.motion in (0, 1, None):
            self.event(f"{self.motion} {words}")
            return
        if self.motion == 0:
            return self.move([end], True, words)
        if self.motion == 1:
            if "R" in values:  # a rounded corner
                self.event(f"{words} [{self.state()}]")
            return self.move([end], False, words)
        if self.motion == "5.1":
            b = [self.place[0] + self.length(values["I"]), self.place[1] + self.length(values["J"]), self.place[2]]
            if end[2] != self.place[2] or self.plane != 17:
                self.event("a curve that leaves its plane")
            inner = [[(p + 2 * q) / 3 for p, q in zip(at, b)] for at in (self.place, end)]
            return self.move(paths.cubic_points(self.place, *inner, end), False, words)
        if self.motion == "5":
            leaves = [self.length(values.get("I", 0)), self.length(values.get("J", 0))]
            if self.kind == "linuxcnc" and not values.keys() & set("IJ"):
                if self.onwards is None:
                    self.event(f"refused {words}")
                leaves = self.onwards or leaves
            b1 = [self.place[0] + leaves[0], self.place[1] + leaves[1], self.place[2]]
            back = [self.length(values.get("P", 0)), self.length(values.get("Q", 0))]
            self.onwards = [-x for x in back]
            b2 = [end[0] + back[0], end[1] + back[1], end[2]]
            if self.kind == "marlin":
                b1[2], b2[2] = (self.place[2] * 2 + end[2]) / 3, (self.place[2] + end[2] * 2) / 3
            elif end[2] != self.place[2] or self.plane != 17:
                self.event("a curve that leaves its plane")
            return self.move(paths.cubic_points(self.place, b1, b2, end), False, words)
        self.arc(values, end, words)

    def arc(self, values, end, words):
        axes = i, j, k = PLANES[self.plane]
        turn = 1 if self.motion == 3 else -1
        if "R" in values:
            centre = paths.centre_by_radius(self.place, end, self.length(values["R"]), axes, turn)
        else:
            offsets = [values.get("IJK"[n]) for n in (i, j)]
            if offsets == [None, None] or self.centres_absolute and None in offsets or values.get("IJK"[k]):
                centre = None
            else:
                centre = [self.length(o or 0.0) + (0.0 if self.centres_absolute else self.place[n])
                          for o, n in zip(offsets, (i, j))]
        if centre is None:
            self.event(f"refused {words}")
            self.place = end
            return
        radii = [((p[i] - centre[0]) ** 2 + (p[j] - centre[1]) ** 2) ** 0.5 for p in (self.place, end)]
        if abs(radii[0] - radii[1]) > max(0.03, 0.001 * radii[0]) or min(radii) < 1e-6:
            self.event(f"refused {words}")
        turns = int(values["P"]) if "P" in values and values["P"] >= 1 else 1
        self.move(paths.arc_points(self.place, end, centre, axes, turn, turns), False, words)

    def even_line(self, values, codes, raw):
        """A control point of G5.2, or what is none."""
        points, weights, good, order, text = self.even
        good = good and not codes and values.keys() - {"N"} == set("XYP") and values["P"] > 0
        if good:
            points.append((self.length(values["X"]), self.length(values["Y"]), points[-1][2]))
            weights.append(values["P"])
        self.even = [points, weights, good and self.absolute and self.plane == 17, order, f"{text} {raw}"]

    def even_end(self):
        points, weights, good, order, text = self.even or [[], [], False, 0, ""]
        self.even = None
        order = int(order) if order in (2, 3, 4, 5, 6) else 0
        if not good or not order or len(points) < order:
            self.event(f"{text} G5.3")
            return self.act("moves")
        spans = len(points) - order + 1
        knots = [0.0] * order + [float(n) for n in range(1, spans)] + [float(spans)] * order
        self.move(paths.nurbs_points(order, points, weights, knots), False, text)

    def nurbs_line(self, values):
        control, weights, knots, order, raw = self.nurbs
        if "K" in values:
            knots.append(values["K"])
        named = values.keys() & set("XYZ")
        if named:
            last = control[-1] if control else list(self.place)
            control.append([self.length(values[letter]) if letter in values else last[n]
                            for n, letter in enumerate("XYZ")])
            weights.append(values.get("R", 1.0))
        if len(knots) < len(control) + order or named:
            return
        self.nurbs, self.motion = None, "6.2"
        if len(control) < order or any(abs(a - b) > 1e-6 for a, b in zip(control[0], self.place)) or \
                sorted(knots) != knots or knots[0] != knots[order - 1] or knots[-1] != knots[-order]:
            self.event("refused curve")
        if min(weights) <= 0:
            self.event(f"refused curve {raw}")
            self.place = list(control[-1])
            return
        self.move(paths.nurbs_points(order, control, weights, knots), False, raw)
