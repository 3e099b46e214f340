#!/usr/bin/env python3
"""damaged_outputs.py BATTEN [--targets linuxcnc,fanuc,siemens,heidenhain] [--count 10000] [--seed 1]
                       [--keep DIR] [--jobs 2]

Does `verify` find what is wrong with a program? Random programs, with everything between the cuts
that programs have (calls, loops, cycles, modes, words that nobody knows), are smoothed, and the
output is damaged: one word, digit, sign, line, feed, line end or comment is changed, lost, added or
moved. Each damaged output goes to `verify --target`, as many for each target as --count says.

What verify proves all the same has to be harmless, and others than Batten say so:

  linuxcnc  LinuxCNC's own interpreter (`rs274`) runs both: the same commands, and paths that are
            nowhere further from each other than the tolerance allows, at the same feeds; it must not
            refuse the damaged one.
  others    every word but coordinates, block numbers and motion words stands there in the same
            order, and so do the feeds of the cuts.

Prints a line for each that is not, with what was changed and where it lies (--keep), and one line
per target. Exits with 1 when there was any."""

import argparse
import concurrent.futures
import difflib
import itertools
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

TOLERANCE = 0.01  # mm
# What chords of arcs, digits of rs274 and samples add to it, in mm.
SEEN_AS_KEPT = 0.0112
DAMAGES_PER_PROGRAM = 25
PROVED, NOT_PROVED = 0, 3

# Lines that stand between cuts; several where a line needs what stands behind it.
BETWEEN = {
    "linuxcnc": """M8|M9|M7|G64 P0.01|G61|G4 P0.5|(hi)|M3 S1000|S2000|T2 M6|G43 H1|o100 call|#1=[#1+1]|G55|G54|
        F777|M8 F888|M199|M66 P0 L0|G91.1|G17|G18;G17|G40|G94;F400|G92 X1|G92.1|M48|M50 P1|G93;G94 F900|M62 P1|
        M67 E0 Q1|G80|G98|M5|G81 X5 Y5 Z-5 R2|G10 L2 P1 X1|G20;G21|G91;X1;G90|G0 Z5;G1 Z0|G53 G0 Z0|G28|
        N100 M8|/M8|G33 Z-1 K1|G5.2 X1 Y1 P1;X2 Y2;G5.3|G95 F0.1;G94 F500|o10 if [#1 EQ 0];F555;o10 endif|
        o20 repeat [2];F600;o20 endrepeat|(MSG, hi)|G64""",
    "fanuc": """M8|M9|G61|G64|G4 P500|(hi)|M3 S1000|S2000|T2 M6|G43 H1|M98 P100|#1=#1+1|G55|F777.|M8 F888.|M199|
        G17|G40|G94;F400.|G92 X1.|G81 X5. Y5. Z-5. R2. F50.|G80|G91;X1.;G90|G0 Z5.;G1 Z0.|G53 Z0.|
        G91 G28 Z0.;G90|N100|G65 P9000 A1. F5.|IF [#1 EQ 0] GOTO 100|G05.1 Q1|G41 D1|G68 X0. Y0. R30.;G69|
        G05 P10000;G05 P0|G95 F.1;G94 F500.|G10 L2 P1 X1.|M198 P2|G66 P9000;X5.;G67""",
    "siemens": """M8|M9|G60|G64|G642|G4 F0.5|MSG()|M3 S1000|S2000|T2 M6;D1|UP1|R1=R1+1|G55|F777|M8 F888|M199|
        G17|G40|G94;F400|TRANS X1;TRANS|MCALL CYCLE81(10,0,2,-5);X5 Y5;MCALL|G91;X1;G90|G0 Z5;G1 Z0|
        SUPA G0 Z0;G1|MSG("x")|LBL1:|GOTOF LBL1|FFWON|SOFT|CYCLE832(0.05,3,1)|G63 Z-5 F100;G1 F500|
        ROT RPL=5;ROT|STOPRE|H5|G95 F0.1;G94 F500|G331 Z-1 K1;G1|COMPCAD;COMPOF|X=IC(5)|G41 D1|CALL "UP2"|
        FGROUP(X,Y);FGROUP()|G9""",
    "heidenhain": """L M8|L M9|L F777|L M8 F888|L Z+5 FMAX|L Z+0 F200|CALL LBL 1|Q1 = Q1 + 1|
        TOOL CALL 2 Z S1000|TOOL CALL S2000 F300|CYCL DEF 7.0 DATUM SHIFT;CYCL DEF 7.1 X+1|
        CYCL DEF 32.0 TOLERANCE;CYCL DEF 32.1 T0.05|CYCL DEF 9.0 DWELL TIME;CYCL DEF 9.1 DWELL 0.5|LBL 5|
        FN 9: IF +Q1 EQU +2 GOTO LBL 5|L IX+1 IY+1|CYCL CALL M3|STOP M0|CC X+5 Y+5;C X+6 Y+5 DR+|
        L M140 MB MAX|CYCL DEF 200 DRILLING Q200=2 Q201=-5 Q206=150|L X+1 RL F300|L R0|L F AUTO|L M91 Z+0""",
}
HEADS = {
    "linuxcnc": "G21 G17 G90 G94 G64 P0.01|G0 X0 Y0 Z5|G1 Z0 F200",
    "fanuc": "%|O1|G21 G17 G90 G94|G0 X0. Y0. Z5.|G1 Z0. F200.",
    "siemens": "G71 G17 G90 G94|G0 X0 Y0 Z5|G1 Z0 F200",
    "heidenhain": "BEGIN PGM A MM|TOOL CALL 1 Z S500|L X+0 Y+0 Z+5 R0 FMAX|L Z+0 F200",
}
ENDS = {
    "linuxcnc": "G0 Z5|M2",
    "fanuc": "G0 Z5.|M30|%",
    "siemens": "G0 Z5|M30",
    "heidenhain": "L Z+5 FMAX|L M30|END PGM A MM",
}
ADDED = """G0 G2 G3 G91 G90 G18 G20 F100 M8 M9 X5 Y5 Z1 I1 J1 G53 G41 G93 G95 G64 G61 S300 M5 G55 / M0 P1 R5
    N5 N-1 G4 E1 A5 T3 H2 D1 ( (a) (a(b) ;a""".split()
ADDED_KLARTEXT = """FMAX F100 M8 M9 M5 R0 RL RR X+5 IY+1 Z+1 M91 M3 DR+ M89 M90 A+5 M0 S300 / M2""".split()


def between(target):
    words = " ".join(BETWEEN[target].split())
    return [part.strip().split(";") for part in words.split("|")]


class Programs:
    """Random programs for one target, and random damage."""

    def __init__(self, target, seed):
        self.target = target
        self.random = random.Random(f"{target} {seed}")
        self.klartext = target == "heidenhain"
        self.point = "." if target == "fanuc" else ""
        self.between = between(target)

    def cut(self, x, y, first):
        feed = f" F{self.random.choice([500, 750, 3000])}{self.point}" if first else ""
        if self.klartext:
            return f"L X{x:+.3f} Y{y:+.3f}{feed}"
        return f"{'G1 ' if first else ''}X{x:.3f} Y{y:.3f}{feed}"

    def program(self):
        chance = self.random
        lines = HEADS[self.target].split("|")
        x = y = angle = 0.0
        for _ in range(chance.choice([1, 2, 3])):
            turn = chance.choice([0.03, 0.06, -0.04, 0.0])
            step = chance.choice([0.3, 1, 2])
            lines.append(self.cut(x, y, True))
            for _ in range(chance.choice([6, 10, 18])):
                angle += turn
                x += step * math.cos(angle)
                y += step * math.sin(angle)
                lines.append(self.cut(x, y, False))
                if chance.random() < 0.03:
                    lines[-1] += f" F{chance.choice([500, 750, 3000])}{self.point}"
            for _ in range(chance.choice([0, 1, 2, 2])):
                lines += chance.choice(self.between)
            if not self.klartext:
                lines.append(("G1 " if chance.random() < 0.7 else "") + self.cut(x, y, False))
        return "\n".join(lines + ENDS[self.target].split("|")) + "\n"

    def damaged(self, text):
        """What was done and the text; None where this time there was nothing to do it to."""
        kind = self.random.choice([name for name in dir(self) if name.startswith("damage_")])
        lines = text.split("\n")
        at = self.random.randrange(len(lines) - 1)
        lines = getattr(self, kind)(lines, at)
        if lines is None or "\n".join(lines) == text:
            return None
        return kind[len("damage_"):], "\n".join(lines)

    def with_words(self, lines, at, words):
        return lines[:at] + [" ".join(words)] + lines[at + 1:]

    def damage_lost_word(self, lines, at):
        words = lines[at].split()
        if words:
            words.pop(self.random.randrange(len(words)))
        return self.with_words(lines, at, words)

    def damage_other_word(self, lines, at):
        words, others = lines[at].split(), self.random.choice(lines).split()
        if not words or not others:
            return None
        words[self.random.randrange(len(words))] = self.random.choice(others)
        return self.with_words(lines, at, words)

    def damage_added_word(self, lines, at):
        words = lines[at].split()
        word = self.random.choice(ADDED_KLARTEXT if self.klartext else ADDED)
        if self.point and word[0] in "XYZFIJRA":
            word += self.point
        words.insert(self.random.randrange(len(words) + 1), word)
        return self.with_words(lines, at, words)

    def damage_swapped_lines(self, lines, at):
        if at + 2 >= len(lines):
            return None
        return lines[:at] + [lines[at + 1], lines[at]] + lines[at + 2:]

    def damage_lost_line(self, lines, at):
        return lines[:at] + lines[at + 1:]

    def damage_doubled_line(self, lines, at):
        return lines[:at + 1] + lines[at:]

    def damage_added_line(self, lines, at):
        return lines[:at] + [self.random.choice(lines)] + lines[at:]

    def line_with(self, lines, pattern):
        having = [i for i, line in enumerate(lines) if re.search(pattern, line)]
        return self.random.choice(having) if having else None

    def damage_other_feed(self, lines, at):
        at = self.line_with(lines, r"F\d")
        if at is None:
            return None
        other = lambda f: self.random.choice([f * 10, max(1, f // 10), f + 1])
        line = re.sub(r"F(\d+)", lambda m: f"F{other(int(m.group(1)))}", lines[at], count=1)
        return lines[:at] + [line] + lines[at + 1:]

    def damage_lost_feed(self, lines, at):
        at = self.line_with(lines, r"F\d")
        if at is None:
            return None
        return lines[:at] + [re.sub(r" ?F\d+\.?\d*", "", lines[at], count=1)] + lines[at + 1:]

    def damage_moved_word(self, lines, at):
        at = self.line_with(lines, r"\b([GMFS]\d|F)")
        words = lines[at].split() if at is not None else []
        acting = [i for i, word in enumerate(words) if word[0] in "GMFS"]
        if not acting:
            return None
        word = words.pop(self.random.choice(acting))
        lines = self.with_words(lines, at, words)
        to = max(0, min(len(lines) - 2, at + self.random.choice([-2, -1, 1, 2, 3])))
        both = [word, lines[to]] if self.random.random() < 0.5 else [lines[to], word]
        return self.with_words(lines, to, both)

    def damage_other_digit(self, lines, at):
        digits = [m.start() for m in re.finditer(r"\d", lines[at])]
        if not digits:
            return None
        place = self.random.choice(digits)
        line = lines[at][:place] + self.random.choice("0123456789") + lines[at][place + 1:]
        return lines[:at] + [line] + lines[at + 1:]

    def damage_other_sign(self, lines, at):
        if not re.search(r"[XYZIJK]-?\d", lines[at]):
            return None
        turned = lambda m: m.group(1) + ("" if m.group(2) else "-") + m.group(3)
        line = re.sub(r"([XYZIJK])(-?)(\d)", turned, lines[at], count=1)
        return lines[:at] + [line] + lines[at + 1:]

    def damage_lost_point(self, lines, at):
        return lines[:at] + [lines[at].replace(".", "", 1)] + lines[at + 1:]

    def damage_lost_line_end(self, lines, at):
        if at + 1 >= len(lines):
            return None
        return lines[:at] + [lines[at] + self.random.choice(["", " ", "\r"]) + lines[at + 1]] + lines[at + 2:]

    def damage_added_line_end(self, lines, at):
        words = lines[at].split()
        if len(words) < 2:
            return None
        cut = self.random.randrange(1, len(words))
        return lines[:at] + [" ".join(words[:cut]), " ".join(words[cut:])] + lines[at + 1:]


# --- what LinuxCNC does ------------------------------------------------------------------------


def canon_of(path):
    """The canonical commands of a program, and what rs274 complains of."""
    with tempfile.TemporaryDirectory() as folder:
        tools = pathlib.Path(folder, "tool.tbl")
        tools.write_text("".join(f"T{i} P{i} D0.2 Z0\n" for i in range(1, 10)))
        pathlib.Path(folder, "v.var").touch()
        command = ["rs274", "-g", "-n", "2", "-t", "tool.tbl", "-v", "v.var", str(path.resolve())]
        try:
            ran = subprocess.run(command, cwd=folder, env=dict(os.environ, HOME=folder), timeout=40,
                                 capture_output=True, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            return [], "does not end"
    said = ran.stderr.decode("latin1").split("\n")
    complaints = "\n".join(line for line in said if line.strip() and line.strip() != "executing")
    lines = ran.stdout.decode("latin1").split("\n")
    found = (re.match(r"\s*\d+\s+N\S*\s+(\w+\(.*\))", line) for line in lines)
    return [m.group(1) for m in found if m], complaints


def numbers(command):
    return [float(number) for number in re.findall(r"-?\d+\.\d+", command)]


def arc_points(command, plane, start):
    """Points on the arc of an ARC_FEED, so close that their chords leave it by 0.3 µm at most."""
    end1, end2, center1, center2 = numbers(command)[:4]
    turns, end3 = re.match(r"ARC_FEED\([^,]+,[^,]+,[^,]+,[^,]+,\s*(-?\d+),\s*([-\d.]+)", command).groups()
    turns, end3 = int(turns), float(end3)
    i, j, k = (1, 2, 0) if "YZ" in plane else (2, 0, 1) if "XZ" in plane else (0, 1, 2)
    radius = math.hypot(start[j] - center2, start[i] - center1)
    growth = math.hypot(end2 - center2, end1 - center1) - radius
    first = math.atan2(start[j] - center2, start[i] - center1)
    sweep = math.atan2(end2 - center2, end1 - center1) - first
    full, sign = 2 * math.pi, 1 if turns > 0 else -1
    while sign * sweep <= 1e-12:
        sweep += sign * full
    sweep += sign * full * (abs(turns) - 1)
    count = min(2000, max(2, int(abs(sweep) * math.sqrt(radius / 8 / 0.0003)) + 1))
    for n in range(1, count + 1):
        part = n / count
        point = [0.0, 0.0, 0.0]
        point[i] = center1 + (radius + growth * part) * math.cos(first + sweep * part)
        point[j] = center2 + (radius + growth * part) * math.sin(first + sweep * part)
        point[k] = start[k] + (end3 - start[k]) * part
        yield point


def moves_of(commands):
    """Straight moves (rapid or not, feed, from, to), and all other commands."""
    place, feed, plane, moves, others = [0.0, 0.0, 0.0], 0.0, "XY", [], []
    for command in commands:
        name = command.split("(")[0]
        if name == "SET_FEED_RATE":
            feed = numbers(command)[0]
        elif name == "SELECT_PLANE":
            plane = command
        elif name in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE"):
            end = numbers(command)[:3]
            rapid = name == "STRAIGHT_TRAVERSE"
            if end != place:
                moves.append((rapid, 0.0 if rapid else feed, place, end))
            place = end
        elif name == "ARC_FEED":
            for point in arc_points(command, plane, place):
                moves.append((False, feed, place, point))
                place = point
        elif name not in ("MESSAGE", "COMMENT") and others[-1:] != [command]:
            others.append(command)
    return moves, others


def from_segment(p, a, b):
    along = [b[i] - a[i] for i in range(3)]
    square = sum(x * x for x in along)
    t = sum((p[i] - a[i]) * along[i] for i in range(3)) / square if square else 0.0
    t = max(0.0, min(1.0, t))
    return math.dist(p, [a[i] + along[i] * t for i in range(3)])


def samples(moves):
    length = sum(math.dist(a, b) for _, _, a, b in moves)
    step = max(0.05, length / 6000)
    for rapid, feed, a, b in moves:
        count = max(1, int(math.dist(a, b) / step) + 1)
        for n in range(1, count + 1):
            yield [a[i] + (b[i] - a[i]) * n / count for i in range(3)], rapid, feed


def deviation(moves, others):
    """How far `moves` leave `others`, followed in order; another kind of move or feed is far off."""
    worst, at = 0.0, 0
    for point, rapid, feed in samples(moves):
        best, best_at = math.inf, at
        for i in range(at, min(len(others), at + 400)):
            other_rapid, other_feed, a, b = others[i]
            gap = from_segment(point, a, b)
            if rapid != other_rapid or abs(feed - other_feed) > 1e-3 * max(1, abs(feed)):
                gap += 500
            if gap < best - 1e-9:
                best, best_at = gap, i
            if best < TOLERANCE and i > best_at + 3:
                break
        worst, at = max(worst, best), best_at
    return worst


def harm_in_linuxcnc(old, new):
    """What LinuxCNC does otherwise; empty: nothing."""
    (old_commands, old_complaint), (new_commands, new_complaint) = canon_of(old), canon_of(new)
    if new_complaint and not old_complaint:
        return f"refused: {new_complaint.splitlines()[0]}"
    (old_moves, old_others), (new_moves, new_others) = moves_of(old_commands), moves_of(new_commands)
    if old_others != new_others:
        for one, other in itertools.zip_longest(old_others, new_others):
            if one != other:
                return f"{one} became {other}"
    if bool(old_moves) != bool(new_moves):
        return "no moves"
    gap = max(deviation(old_moves, new_moves), deviation(new_moves, old_moves)) if old_moves else 0
    return f"{gap:.4f} mm or another feed" if gap > SEEN_AS_KEPT else ""


# --- what the words say ------------------------------------------------------------------------

# Coordinates, block numbers, words of motions, and the plane, which says how arcs are
# written.
PLAIN = re.compile(r"^(N\d+|G0?[0123]|G1[789]|[XYZIJK][-+]?[\d.,]+|R[-+]?[\d.]+|CR=[-\d.]+|L|C|CC|DR[+-]|R|M|F|"
                   r"\d+)$")


def acting_words(path):
    """Every other word; an F at the next block that goes somewhere, where it is another one."""
    words, place, feed, last_feed, distance = [], {}, None, None, None
    for line in path.read_text("latin1").upper().split("\n"):
        line = re.sub(r"\([^()]*\)|;.*", "", line)
        line = re.sub(r"(?<=[\d.])(?=[A-Z])", " ", line)
        for word in line.split():
            if word.startswith("F") and word[1:2].isdigit():
                feed = float(word[1:].rstrip("."))
            elif not PLAIN.match(word) and word != distance and words[-1:] != [word]:
                words.append(word)
            distance = word if word in ("G90", "G91") else distance
        moved = {} if line.split()[:1] == ["CC"] else dict(re.findall(r"\b([XYZ])([-+]?[\d.]+)", line))
        moved = {axis: float(number) for axis, number in moved.items() if number.strip("+-.")}
        if any(place.get(axis) != number for axis, number in moved.items()) and feed != last_feed:
            last_feed = feed
            words.append(f"F{feed:g}")
        place.update(moved)
    return words


def harm_in_words(old, new):
    for one, other in itertools.zip_longest(acting_words(old), acting_words(new)):
        if one != other:
            return f"{one} became {other}"
    return ""


# --- the campaign ------------------------------------------------------------------------------


def run(command):
    ran = subprocess.run(list(map(str, command)), capture_output=True, timeout=120)
    return ran.returncode, (ran.stderr + ran.stdout).decode("latin1")


def changed_lines(old, new):
    lines = difflib.unified_diff(old.split("\n"), new.split("\n"), n=0, lineterm="")
    return [line for line in lines if not line.startswith(("---", "+++", "@@"))][:4]


def attack(batten, target, seed, count, keep):
    """How many outputs were damaged, how many of them were proved, and what was harmful."""
    programs = Programs(target, seed)
    harm_of = harm_in_linuxcnc if target == "linuxcnc" and shutil.which("rs274") else harm_in_words
    source = keep / f"{target}-{seed}.old"
    smoothed, broken = source.with_suffix(".out"), source.with_suffix(".new")
    tried = proved = 0
    found = []
    while tried < count:
        source.write_text(programs.program())
        # The words of curves tell nobody but `verify` what they do.
        form = programs.random.choice(["arcs", "lines"] + (["auto"] if target == "linuxcnc" else []))
        options = ["--target", target, "--tolerance", TOLERANCE]
        code, _ = run([batten, "smooth", source, "-o", smoothed, "--force", "--threads", "1", "--output",
                       form, *options])
        if code != PROVED:
            continue
        text = smoothed.read_text()
        for _ in range(min(DAMAGES_PER_PROGRAM, count - tried)):
            damage = programs.damaged(text)
            if damage is None:
                continue
            broken.write_bytes(damage[1].encode("latin1"))
            tried += 1
            code, said = run([batten, "verify", source, broken, *options])
            if code not in (PROVED, NOT_PROVED):
                found.append(f"{target}: verify ended with {code}: {said.strip()[-200:]}")
            if code != PROVED:
                continue
            proved += 1
            harm = harm_of(source, broken)
            if not harm:
                continue
            kept = keep / f"{target}-{seed}-{tried}"
            shutil.copy(source, f"{kept}.old")
            shutil.copy(broken, f"{kept}.new")
            found.append(f"{target}: {damage[0]}: {harm}: {changed_lines(text, damage[1])} {kept}.new")
    return tried, proved, found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("--targets", type=lambda text: text.split(","), default=list(BETWEEN))
    parser.add_argument("--count", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    keep = options.keep or pathlib.Path(tempfile.mkdtemp(prefix="batten-damaged-"))
    keep.mkdir(parents=True, exist_ok=True)
    harmful = 0
    pieces = 2 * options.jobs
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as workers:
        for target in options.targets:
            jobs = [workers.submit(attack, options.batten.resolve(), target, options.seed * 1000 + i,
                                   (options.count + i) // pieces, keep) for i in range(pieces)]
            results = [job.result() for job in jobs]
            tried, proved = (sum(result[i] for result in results) for i in (0, 1))
            found = [line for result in results for line in result[2]]
            harmful += len(found)
            print("\n".join(found + [f"{target}: {tried} damaged outputs, {proved} proved, {len(found)} of "
                                     "them not harmless"]), flush=True)
    return 1 if harmful else 0


if __name__ == "__main__":
    sys.exit(main())
