"""Does a new program do what the old one does? Told without any code of Batten.

Both traces (readers.py, or LinuxCNC's own interpreter) must have the same events in the same order;
between two events the cuts at each feed and the rapids follow each other alike, and each pair of paths
can be travelled together within the tolerance (paths.together)."""

import decimal
import itertools
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

import paths
from readers import EFFECTS, PLANES
from readers_other import reader_for

# What chords, and the digits of rs274, add to the tolerance; mm.
SLACK, RS274_SLACK, RS274_INCH_SLACK = 0.0012, 0.0015, 0.0065
SPEEDS, STARTS = ("speed ", "SET_SPINDLE_SPEED"), ("spindle ", "START_SPINDLE")
# In one block LinuxCNC does the second before the first, whatever their order; nothing moves by either.
OFFSETS = ("SET_G5X_OFFSET", "SET_XY_ROTATION")
BEFORE_OFFSETS = ("STOP_SPINDLE", "START_SPINDLE", "SET_SPINDLE", "FLOOD_", "MIST_")
LIKE_LINUXCNC = ("linuxcnc", "grbl", "grblhal", "mach3")


def sections(trace, least):
    """Neighbouring cuts of one feed as one path: [kind, feed or text, points, parts]. `parts`: of a path
    those that keep one tolerance, [tolerance, points]. Paths that go no further than `least` are left
    out."""
    joined, part = [], math.inf
    for kind, what, value in trace:
        if kind == "part":
            part = value
        elif kind == "event":
            # A speed beside the word that starts the spindle, in one block or two.
            if joined and value.startswith(SPEEDS) and str(joined[-1][1]).startswith(STARTS):
                joined.insert(-1, [kind, value, None, None])
            elif value.startswith(OFFSETS):
                at = len(joined)
                while at > 0 and joined[at - 1][0] == "event" and joined[at - 1][1].startswith(BEFORE_OFFSETS):
                    at -= 1
                joined.insert(at, [kind, value, None, None])
            else:
                joined.append([kind, value, None, None])
        else:
            append([kind, what, list(value), [[part, list(value)]]], joined)
    kept = []
    for section in joined:
        if section[0] == "event" or paths.extent(section[2]) > least:
            append(section, kept)
    return kept


def append(section, all_of_them):
    before = all_of_them[-1] if all_of_them else None
    if section[0] != "cut" or before is None or before[:2] != section[:2]:
        all_of_them.append(section)
        return
    before[2].extend(section[2][1:] if section[2][0] == before[2][-1] else section[2])
    for tolerance, points in section[3]:
        if before[3][-1][0] == tolerance:
            before[3][-1][1].extend(points)
        else:
            before[3].append([tolerance, list(points)])


def said(section):
    if section is None:
        return "nothing"
    kind, what, points, _ = section
    if kind == "event":
        return f"'{what}'"
    feed = f" at {what}" if kind == "cut" else ""
    begin, end = (", ".join(f"{x:.4f}" for x in points[n]) for n in (0, -1))
    return f"{kind}{feed} from {begin} to {end}"


def alike(a, b, reach):
    """Each part of a path keeps the tolerance that the old program states, or all of it the least of
    them, where the new one does not tell its parts."""
    if a is None or b is None or a[:2] != b[:2]:
        return False
    if a[0] == "rapid":
        return math.dist(a[2][-1], b[2][-1]) <= reach and math.dist(a[2][0], b[2][0]) <= reach
    if a[0] == "event":
        return True
    stated = [tolerance for tolerance, _ in a[3]]
    if paths.together(a[2], b[2], min(reach, min(stated) + SLACK)):
        return True
    return len(stated) > 1 and stated == [tolerance for tolerance, _ in b[3]] and all(
        paths.together(p, q, min(reach, tolerance + SLACK)) for (tolerance, p), (_, q) in zip(a[3], b[3]))


def difference(old, new, reach):
    """Of two traces; empty: none. A move that does not leave `reach` may be in one alone."""
    first = ""
    for least in (1e-6, reach / 3, reach):
        pairs = itertools.zip_longest(sections(old, least), sections(new, least))
        unlike = next(((a, b) for a, b in pairs if not alike(a, b, reach)), None)
        if unlike is None:
            return ""
        first = first or f"{said(unlike[0])} became {said(unlike[1])}"
    return first


def least_parts(trace, tolerance):
    """A part that may move by more than is asked for anyway is one like those that state nothing."""
    return [(kind, what, math.inf if kind == "part" and value >= tolerance else value) for kind, what, value in trace]


def without_parts(trace):
    return [each for each in trace if each[0] != "part"]


# --- the readers -------------------------------------------------------------------------------


class OldProgram:
    """What a program does, whatever the words do that nobody knows; read once for many new ones."""

    def __init__(self, text, control, inch=None):
        self.reader, self.inch = reader_for(control), inch
        self.traces = {}
        used = {"nothing"}
        for effect in EFFECTS:
            if effect in used:
                reader = self.reader(text, effect, inch)
                self.traces[effect] = reader.run()
                used |= reader.used_effects

    def harm(self, new, tolerance, of_parts=True):
        """What `new` does otherwise, by the readers; empty: nothing. `of_parts`: also where a part breaks
        the tolerance that the old program states for it."""
        for effect, trace in self.traces.items():
            reader = self.reader(new, effect, self.inch)
            both = least_parts(trace, tolerance), least_parts(reader.run(), tolerance)
            found = difference(*(both if of_parts else map(without_parts, both)), tolerance + SLACK)
            if not found and not reader.used_effects <= self.traces.keys():
                found = "a line was added that may do something"
            if found:
                return f"{found}, where what is not known does: {effect}"
        return ""


# --- LinuxCNC's interpreter ----------------------------------------------------------------------


LENGTHS = "XYZUVWIJKRFQ"
# Those of which all words of LENGTHS are lengths, and P is none.
INCHES_IN = {"G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G28", "G30", "G40", "G43", "G49", "G53", "G54", "G55",
             "G61", "G64", "G80", "G81", "G82", "G83", "G90", "G90.1", "G91", "G91.1", "G92", "G92.1", "G94", "G98", "G99"}


def in_millimetres(text):
    """The same program with G21, its lengths exact; None: not told by words alone. rs274 prints four
    digits of an inch, and an arc that is shorter than they tell looks like a full circle."""
    lines = []
    for line in text.split("\n"):
        if set(line) & set("[#<%") or re.match(r"\s*[oO]", line):
            return None
        code = re.sub(r"\([^)]*\)|;.*", "", line).upper().replace(" ", "")
        words = [(letter, decimal.Decimal(number)) for letter, number in re.findall(r"([A-Z])([-+]?[\d.]+)", code)]
        codes = [f"G{number.normalize():f}" for letter, number in words if letter == "G"]
        if not set(codes) <= INCHES_IN or "G64" in codes and any(letter == "P" for letter, _ in words):
            return None
        words = [(letter, number * decimal.Decimal("25.4") if letter in LENGTHS else number) for letter, number in words]
        lines.append(" ".join("G21" if (letter, number) == ("G", 20) else f"{letter}{number:f}" for letter, number in words))
    return "\n".join(lines)


class Canon:
    """What rs274 says that a program does: a trace, what it refused, whether it was in inches, and
    whether it has curves, which it does not tell."""

    def __init__(self, text):
        self.read(text)
        metric = in_millimetres(text) if self.inch and not self.complaint else None
        if metric is not None:
            self.read(metric)

    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "tool.tbl").write_text("".join(f"T{i} P{i} D0.2 Z0\n" for i in range(1, 60)))
            (folder / "v.var").touch()
            (folder / "program.ngc").write_text(text, encoding="latin-1")
            command = ["rs274", "-g", "-n", "2", "-t", "tool.tbl", "-v", "v.var", "program.ngc"]
            try:
                ran = subprocess.run(command, cwd=folder, env=dict(os.environ, HOME=str(folder)), timeout=60,
                                     capture_output=True, stdin=subprocess.DEVNULL)
            except subprocess.TimeoutExpired:
                self.complaint, self.trace, self.curves, self.inch = "does not end", [], False, False
                return
        said = [line for line in ran.stderr.decode("latin1").split("\n") if line.strip()]
        self.complaint = "; ".join(line for line in said if line.strip() != "executing")
        if ran.returncode and not self.complaint:
            self.complaint = f"ended with {ran.returncode}"
        self.trace, self.curves, self.inch = [], False, False
        self.place, self.feed, self.plane, self.unit = (0.0, 0.0, 0.0), 0.0, 17, 1.0
        self.switches, self.others = {}, [0.0, 0.0, 0.0]
        for line in ran.stdout.decode("latin1").split("\n"):
            found = re.match(r"\s*\d+\s+N\S*\s+(\w+)\((.*)\)", line)
            if found:
                self.follow(*found.groups())

    def follow(self, name, text):
        text = re.sub(r"-(0\.0+)\b", r"\1", text)
        numbers = [float(n) for n in re.findall(r"-?\d+\.\d+", text)]
        if name == "SET_FEED_RATE":
            self.feed = numbers[0]
        elif name == "SELECT_PLANE":
            self.plane = {"XY": 17, "XZ": 18, "YZ": 19}[text.split("_")[-1]]
        elif name == "USE_LENGTH_UNITS":
            self.unit = 25.4 if "INCH" in text else 1.0
            self.inch = self.inch or self.unit != 1
        elif name in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE"):
            self.add(name == "STRAIGHT_TRAVERSE", [tuple(x * self.unit for x in numbers[:3])], numbers[3:])
        elif name == "ARC_FEED":
            words = [float(word) for word in text.split(",")]
            axes = i, j, k = PLANES[self.plane]
            end, turns = [0.0, 0.0, 0.0], int(words[4])
            end[i], end[j], end[k] = words[0] * self.unit, words[1] * self.unit, words[5] * self.unit
            centre = (words[2] * self.unit, words[3] * self.unit)
            self.add(False, paths.arc_points(self.place, end, centre, axes, 1 if turns > 0 else -1, abs(turns)), words[6:])
        elif name == "NURBS_FEED":
            self.curves = True
        elif name not in ("MESSAGE", "COMMENT"):
            value = f"{name}({text})"
            if self.switches.get(name) != value or name in ("DWELL", "PROGRAM_STOP"):
                self.switches[name] = value
                self.switches.pop({"FLOOD_ON": "FLOOD_OFF", "FLOOD_OFF": "FLOOD_ON", "MIST_ON": "MIST_OFF",
                                   "MIST_OFF": "MIST_ON"}.get(name), None)
                self.trace.append(("event", None, value))

    def add(self, rapid, points, others):
        begin, self.place = self.place, tuple(points[-1])
        if others != self.others:
            self.others = others
            self.trace.append(("event", None, f"other axes {others}"))
        self.trace.append(("rapid", None, [begin, points[-1]]) if rapid else
                          ("cut", (self.feed, 0), [begin, *points]))


def rs274_is_there():
    return shutil.which("rs274") is not None


def harm_in_linuxcnc(old, new, tolerance):
    """`old` is a Canon. What LinuxCNC does otherwise with the text `new`; None: it cannot tell."""
    if old.complaint:
        return None
    canon = Canon(new)
    if canon.complaint:
        return f"LinuxCNC refuses it: {canon.complaint}"
    if canon.curves or old.curves:
        return None
    slack = RS274_INCH_SLACK if canon.inch or old.inch else RS274_SLACK
    found = difference(old.trace, canon.trace, tolerance + slack)
    return f"LinuxCNC: {found}" if found else ""
