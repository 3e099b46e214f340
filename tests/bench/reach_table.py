#!/usr/bin/env python3
"""reach_table.py BATTEN [--corpus DIR] [--below 2] [--only TEXT] [--lines]

How far Batten reaches into programs: of the short lines of plain 3-axis cutting, how many lie in runs
(`batten inspect`), and what keeps the others. Every program of the corpus beside the checkout (or
BATTEN_CORPUS); one that names no unit is read with `--units`, in inches where its name says so.

The lines are counted by a small reader of its own, in the text as it stands: G1 in X, Y or Z with a
length below `--below` mm, in words of RS-274, of Siemens programs and of Klartext. Loops and calls are
not followed. A number may be an expression of variables that were assigned above it. Counted apart:

  rule     under a word that changes what X, Y, Z mean or how they are cut: compensation, increments,
           inverse time, rotation .. ; and lines that move another axis or feed a filament
  unknown  lines whose length cannot be told: nothing said where the tool was
"""

import argparse
import collections
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "corpus"))
from programs import bytes_of, programs_in

COMMENT = re.compile(r"\([^)]*\)?|;.*")
NUMBER = r"[+-]?\s*(?:\d+\.?\d*|\.\d+)"
VARIABLE = r"#\s*<[^>]*>|#\s*\d+|\bR\d+(?=\s*[=*+/)-])|\bQ\d+"
WORD = re.compile(rf"([A-Z])\s*=?\s*(\[[^\]]*\]|{NUMBER}|[+-]?(?:{VARIABLE}))")
ASSIGNED = re.compile(rf"^\s*(?:N\d+\s*)?(?:DEF\s+REAL\s+)?({VARIABLE}|[A-Z_]\w+)\s*=\s*([^=]+)$")

# G codes that make a state, with those that end it; what is plain is cut in none of them.
TRICKY = {
    "increments": ({91}, {90}), "inverse time": ({93}, {94, 95}), "feed per revolution": ({95}, {93, 94}),
    "compensation": ({41, 42, 41.1, 42.1}, {40}), "exact stop": ({61, 61.1, 60}, {64}),
    "diameters": ({7}, {8}), "polar": ({16, 12.1}, {15, 13.1}), "rotation": ({68, 68.2}, {69}),
    "scaling": ({51}, {50}), "surface speed": ({96}, {97}),
}
MOTIONS = {0, 1, 2, 3, 5, 5.1, 5.2, 6.2, 33, 76, *range(80, 90)}
INCHES, MILLIMETRES = {20, 70, 700}, {21, 71, 710}


class Reader:
    def __init__(self, inches, klartext):
        self.scale = 25.4 if inches else 1.0
        self.klartext = klartext
        self.place, self.mode, self.states, self.values = {}, None, set(), {}

    def value(self, text):
        """A number or an expression of what was assigned; None where it is not known."""
        known = re.sub(VARIABLE, lambda name: repr(self.values.get(re.sub(r"\s", "", name[0]), "?")), text)
        known = known.replace("[", "(").replace("]", ")").replace(" ", "")
        if not re.fullmatch(r"[\d.+*/()e-]+", known):
            return None
        try:
            return float(eval(re.sub(r"\b0+(?=\d)", "", known)))
        except (SyntaxError, ZeroDivisionError, TypeError):
            return None

    def line(self, text):
        """(kind, length in mm) of a cutting line: plain, rule or unknown; None for all else."""
        text = COMMENT.sub(" ", text.upper()).strip()
        if assigned := ASSIGNED.match(text):
            self.values[re.sub(r"\s", "", assigned[1])] = self.value(assigned[2])
            return None
        if self.klartext:
            return self.klartext_line(text)
        words = [(letter, self.value(value)) for letter, value in WORD.findall(text)]
        codes = {value for letter, value in words if letter == "G" and value is not None}
        for name, (begin, end) in TRICKY.items():
            if codes & end:
                self.states.discard(name)
            if codes & begin:
                self.states.add(name)
        if codes & (INCHES | MILLIMETRES):
            self.scale = 25.4 if codes & INCHES else 1.0
        for code in codes & MOTIONS:
            self.mode = code
        letters = {letter for letter, _ in words}
        if not letters & set("XYZ") or codes & {4, 10, 28, 30, 52, 53, 92}:
            return None
        return self.move({letter: value for letter, value in words}, letters)

    def klartext_line(self, text):
        words = {letter: self.value(value) for letter, value in WORD.findall(text)}
        if not re.match(r"^\d*\s*L\s", text) or not words.keys() & set("XYZ"):
            return None
        self.mode = 0 if "FMAX" in text else 1
        return self.move(words, words.keys() - {"L", "N", "R", "M"})

    def move(self, words, letters):
        to = dict(self.place)
        for axis in "XYZ":
            if axis not in words:
                continue
            number = None if words[axis] is None else words[axis] * self.scale
            if "increments" in self.states and number is not None:
                number = None if axis not in to or to[axis] is None else to[axis] + number
            to[axis] = number
        named = [axis for axis in "XYZ" if axis in words]
        steps = [None if to[a] is None or self.place.get(a) is None else to[a] - self.place[a] for a in named]
        self.place = to
        if self.mode != 1:
            return None
        if letters & set("ABCUVWE") or self.states:
            return "rule", 0.0
        return ("unknown", 0.0) if None in steps else ("plain", math.hypot(*steps))


def inspected(batten, file, data):
    """The report of `inspect`, and whether inches were given to it."""
    suffix = pathlib.Path(file.stem if file.suffix == ".gz" else file.name).suffix or ".nc"
    with tempfile.TemporaryDirectory(prefix="batten-reach-") as folder:
        program = pathlib.Path(folder, "program" + suffix)
        program.write_bytes(data)
        inches = "inch" in file.name.lower()
        for units in [], ["--units", "inch" if inches else "mm"]:
            done = subprocess.run([batten, "inspect", program, "--json", "-", "--quiet", *units],
                                  stdin=subprocess.DEVNULL, capture_output=True)
            if done.returncode != 2:
                break
        return json.loads(done.stdout) if done.stdout else None, bool(units) and inches


def reach_of(options, file):
    """Counts of short lines by what they are in; of those that are plain and kept the lines by reason."""
    data = bytes_of(file)
    report, inches = inspected(options.batten, file, data)
    counts, kept = collections.Counter(), collections.defaultdict(list)
    if report is None:
        return counts, kept
    text = data.decode("latin-1")
    reader = Reader(inches, re.search(r"^\d*\s*BEGIN PGM", text, re.M) is not None)
    sections = iter(report["sections"])
    section = next(sections, None)
    for number, line in enumerate(text.splitlines(), 1):
        move = reader.line(line)
        while section and section["last_line"] < number:
            section = next(sections, None)
        if move is None or section is None:
            continue
        kind, length = move
        if kind != "plain":
            counts[kind] += 1
        elif 0 < length < options.below:
            counts["short"] += 1
            counts["in runs"] += section["status"] == "run"
            if section["status"] != "run":
                kept[section["reason"]].append(number)
    return counts, kept


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    beside = os.environ.get("BATTEN_CORPUS", HERE.parent.parent / ".." / "shared" / "corpus")
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("--corpus", type=pathlib.Path, default=beside)
    parser.add_argument("--below", type=float, default=2.0, metavar="MM")
    parser.add_argument("--only", default="", metavar="TEXT")
    parser.add_argument("--lines", action="store_true", help="the first lines that are kept for each reason")
    return parser.parse_args()


def percent(part, whole):
    return f"{100 * part / whole:5.1f} %" if whole else "      -"


def main():
    options = read_options()
    total, reasons, without = collections.Counter(), collections.Counter(), []
    print(f"{'program':46} {'short':>7} {'in runs':>8} {'share':>7} {'rule':>7} {'unknown':>7}  kept for")
    for file in programs_in(options.corpus):
        if options.only not in str(file):
            continue
        counts, kept = reach_of(options, file)
        causes = sorted(kept.items(), key=lambda each: -len(each[1]))
        print(f"{file.name[:46]:46} {counts['short']:7} {counts['in runs']:8} "
              f"{percent(counts['in runs'], counts['short'])} {counts['rule']:7} {counts['unknown']:7}  "
              + ", ".join(f"{reason} {len(lines)}" for reason, lines in causes[:5]))
        if options.lines:
            for reason, lines in causes:
                print(f"{'':8}{reason}: lines", *lines[:12], ".." if len(lines) > 12 else "")
        total += counts
        reasons.update({reason: len(lines) for reason, lines in kept.items()})
        if counts["short"] >= 100 and counts["in runs"] == 0:
            without.append(file.name)
    print(f"{'all':46} {total['short']:7} {total['in runs']:8} {percent(total['in runs'], total['short'])} "
          f"{total['rule']:7} {total['unknown']:7}  "
          + ", ".join(f"{reason} {count}" for reason, count in reasons.most_common()))
    print("100 or more short lines, none in a run:", ", ".join(without) or "no program")


if __name__ == "__main__":
    main()
