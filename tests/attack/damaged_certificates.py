#!/usr/bin/env python3
"""damaged_certificates.py BATTEN [--count 2000] [--seed 1]

Does tools/check_certificate.py accept what Batten certifies, and nothing that is wrong?

Random programs for five controls are smoothed in each form that the control has. The checker has to
accept each of them. Then the new program, its certificate or both are damaged, --count times in
all. Damage that is harmful by how it was made has to be rejected:

  - a place that is more than 1.5 tolerances away from all of the old path, also where the pairs of
    the certificate are changed at random to fit;
  - another feed, a feed lost; words that act, modes or rapids among rewritten lines;
  - another byte in a copied line, also where the certificate is changed to call it a run;
  - lines lost, added or swapped, also where the numbers of the certificate are changed to fit and
    the path is left by more than 1.5 tolerances;
  - a certificate of a larger tolerance.

Programs of right angles that became curves are certified. A program with expressions of constants is certified, and refused with a parameter set in a run.

Other damage may be harmless and is counted apart; where it is accepted, the readers of the campaign
(oracle.py) have to find it harmless. Prints a line for each kind, and what was accepted though it is
harmful; exits with 1 when there was any."""

import argparse
import collections
import contextlib
import io
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tools")]
import check_certificate  # noqa: E402
import oracle  # noqa: E402

TOLERANCE = 0.01  # mm
FAR = 1.5 * TOLERANCE
FORMS = {"linuxcnc": ["arcs", "lines", "curves"], "grbl": ["arcs", "lines"], "fanuc": ["arcs", "lines", "curves"],
         "siemens": ["arcs", "lines", "curves"], "heidenhain": ["arcs", "lines"]}
ACTING = {"plain": "M8 M0 S500 T2 G91 G20 G93 G41 G0 G92 G28 G68 G18 G52 A5. E1. G4 G55 M98".split(),
          "klartext": "M8 FMAX RL IX+1 M91 A+5 M0 Q1 M128".split()}


class Source:
    """A program of chains of short lines, each at a feed of its own, and the chains."""

    def __init__(self, control, chance):
        self.klartext = control == "heidenhain"
        point = "." if control == "fanuc" else ""
        inch = control in ("linuxcnc", "fanuc") and chance.random() < 0.2
        unit, decimals = (25.4, 5) if inch else (1.0, 3)
        heads = {"siemens": ["G71 G17 G90 G94", "S1000 M3"],
                 "heidenhain": ["BEGIN PGM A MM", "TOOL CALL 1 Z S500"]}
        lines = heads.get(control, ["G20 G17 G90 G94" if inch else "G21 G17 G90 G94", "S1000 M3"])[:]
        between = ["L M8", "L M9"] if self.klartext else ["M8", "M9", "M5", "M3 S2000"]
        self.chains = []
        step = lambda *xyz: [round(value / unit, decimals) * unit for value in xyz]
        text = lambda letter, value: f"{letter}{value / unit:+.{decimals}f}" if self.klartext else \
            f"{letter}{value / unit:.{decimals}f}"
        for n in range(chance.choice([2, 3])):
            x, y, z, angle = 50.0 * n, chance.uniform(-20, 20), chance.choice([-1.0, -2.0]), chance.uniform(0, 6)
            turn, feed = chance.choice([0.02, 0.05, -0.04, 0.0]), 100 * (n + 2)
            here = step(x, y, 5.0)
            xyz = lambda p, letters="XYZ": " ".join(text(c, p["XYZ".index(c)]) for c in letters)
            lines.append(f"L {xyz(here)} R0 FMAX" if self.klartext else f"G0 {xyz(here)}")
            here = step(x, y, z)
            lines.append(f"L {xyz(here, 'Z')} F50" if self.klartext else f"G1 {xyz(here, 'Z')} F50{point}")
            chain = [here]
            for k in range(chance.choice([20, 35])):
                angle += turn
                x, y = x + 0.5 * math.cos(angle), y + 0.5 * math.sin(angle)
                here = step(x + chance.uniform(-0.002, 0.002), y + chance.uniform(-0.002, 0.002), z)
                chain.append(here)
                words = xyz(here, "XY")
                if k == 0:
                    words += f" F{feed}{point}"
                lines.append("L " + words if self.klartext else words)
            self.chains.append(chain)
            lines.append("L Z+5 FMAX" if self.klartext else f"G0 Z{text('Z', 5.0)[1:]}")
            lines += chance.sample(between, 1)
            if not self.klartext and control != "siemens" and chance.random() < 0.5:
                lines.append(f"(chain {n})")
        lines += ["END PGM A MM"] if self.klartext else ["M30"]
        self.unit = unit
        self.text = "\n".join(lines) + "\n"

    def distance(self, place):
        """From the chains; mm."""
        return min(from_segment(place, a, b) for chain in self.chains for a, b in zip(chain, chain[1:]))


def from_segment(p, a, b):
    along = [y - x for x, y in zip(a, b)]
    square = sum(x * x for x in along)
    t = sum((z - x) * d for x, z, d in zip(a, p, along)) / square if square else 0.0
    return math.dist(p, [x + min(1.0, max(0.0, t)) * d for x, d in zip(a, along)])


class Pair:
    """A proved pair with its certificate, and damage to it: (kind, harmful, new lines, certificate)."""

    def __init__(self, source, control, form, new, certificate, chance):
        self.source, self.control, self.form, self.chance = source, control, form, chance
        self.lines, self.certificate = new.split("\n")[:-1], certificate
        self.old = source.text.split("\n")[:-1]
        self.runs = [tuple(map(int, m)) for m in re.findall(r"run (\d+) (\d+) (\d+) (\d+)", certificate)]
        self.in_runs = [n - 1 for _, _, first, count in self.runs for n in range(first, first + count)]
        self.moves = [n for n in self.in_runs if re.search(r"[XYZ][-+]?[\d.]|PO\[", self.lines[n])]
        self.copied = [n for n in range(len(self.lines)) if n not in self.in_runs]
        self.acting = [n for n in self.copied if re.search(r"[GMS]\d|FMAX|PGM|TOOL", self.lines[n])]

    def damaged(self):
        return getattr(self, self.chance.choice([name for name in dir(self) if name.startswith("damage_")]))()

    def with_line(self, n, text):
        return self.lines[:n] + [text] + self.lines[n + 1:]

    def scrambled(self, text):
        """Pairs at random, near to what they were."""
        def other(m):
            if self.chance.random() < 0.8:
                return m.group(0)
            return str(max(0, int(m.group(1)) + self.chance.choice([-1, 0, 0, 1]))) + (
                f".{self.chance.randrange(10 ** 4):04}" if self.chance.random() < 0.5 else "")
        head, *rest = re.split(r"(?m)^(?=run )", text)
        parts = [part.split("\n", 1) for part in rest]
        return head + "".join(first + "\n" + re.sub(r"(?<![.\d*])(\d+)(?:\.\d+)?", other, tail) for first, tail in parts)

    def refitted(self, at, lines, count):
        """The certificate for `count` lines more in the run that has line `at` of the new program."""
        def shifted(m):
            old, old_count, new, new_count = map(int, m.groups())
            if new <= at + 1 < new + new_count:
                new_count += count
            elif new > at + 1:
                new += count
            return f"run {old} {old_count} {new} {new_count}"
        return lines, re.sub(r"run (\d+) (\d+) (\d+) (\d+)", shifted, self.certificate)

    def vertices(self, lines):
        """Ends of moves in lines of the new program, in mm: place or None for each."""
        place, places = [None, None, None], []
        for line in lines:
            body = re.sub(r"\([^()]*\)|;.*", "", line)
            named = False
            if not re.match(r"\s*CC\b", body):
                for n, letter in enumerate("XYZ"):
                    found = re.search(rf"{letter}([-+]?[\d.]+)|PO\[{letter}\]=\(([-+]?[\d.]+)", body)
                    if found:
                        place[n], named = float(found.group(1) or found.group(2)) * self.source.unit, True
            places.append(list(place) if named and None not in place else None)
        return places

    def far(self, lines, indices):
        """Whether the end of one of these moves is far from all of the old path. Control points of
        curves are no ends."""
        if self.control == "fanuc" and self.form == "curves":
            return False
        places = self.vertices(lines)
        return any(places[n] is not None and self.source.distance(places[n]) > FAR for n in indices if n < len(places))

    def damage_place(self):
        n = self.chance.choice(self.moves)
        by = self.chance.choice([0.0005, 0.02, 0.1, 1.0]) * self.chance.choice([-1, 1])
        axis = self.chance.choice("XYZ")
        pattern = rf"({axis}|PO\[{axis}\]=\()([-+]?[\d.]+)"
        if not re.search(pattern, self.lines[n]) or re.match(r"\s*CC", self.lines[n]):
            return None
        shift = lambda m: f"{m.group(1)}{float(m.group(2)) + by / self.source.unit:+.5f}"
        lines = self.with_line(n, re.sub(pattern, shift, self.lines[n], count=1))
        certificate = self.scrambled(self.certificate) if self.chance.random() < 0.5 else self.certificate
        return "place", self.far(lines, [n]), lines, certificate

    def damage_centre(self):
        having = [n for n in self.moves if re.search(r"[IJ][-+]?\d", self.lines[n])]
        if not having or self.form != "arcs":
            return None
        n = self.chance.choice(having)
        lines = self.with_line(n, re.sub(r"([IJ])([-+]?[\d.]+)", lambda m: f"{m.group(1)}{-float(m.group(2)):.4f}",
                                         self.lines[n]))
        return "centre", False, lines, self.scrambled(self.certificate)

    def damage_feed(self):
        having = [n for n in self.in_runs if re.search(r"F\d", self.lines[n])]
        if not having:
            return None
        n = self.chance.choice(having)
        other = self.chance.choice(["", lambda m: f"F{int(m.group(1)) + 1}{m.group(2)}",
                                    lambda m: f"F{int(m.group(1)) * 10}{m.group(2)}"])
        return "feed", True, self.with_line(n, re.sub(r"F(\d+)(\.?)", other, self.lines[n])), self.certificate

    def damage_added_feed(self):
        n = self.chance.choice(self.moves)
        if "F" in self.lines[n] or re.match(r"\s*CC|K", self.lines[n]) or self.form == "curves":
            return None
        return "added feed", True, self.with_line(n, f"{self.lines[n]} F77{'.' if self.control == 'fanuc' else ''}"), \
            self.certificate

    def damage_word(self):
        n = self.chance.choice(self.moves)
        word = self.chance.choice(ACTING["klartext" if self.source.klartext else "plain"])
        return "word", True, self.with_line(n, f"{self.lines[n]} {word}"), self.scrambled(self.certificate)

    def damage_said_twice(self):
        n = self.chance.choice(self.moves)
        axes = re.findall(r"(?<![A-Z])[XYZ]", self.lines[n])
        if len(set(axes)) < 2:
            return None
        lines = self.with_line(n, re.sub(rf"(?<![A-Z]){axes[0]}", axes[1], self.lines[n]))
        return "said twice", True, lines, self.scrambled(self.certificate)

    def damage_lost_end(self):
        return "lost end", True, self.lines[:self.chance.randrange(1, len(self.lines))], self.certificate

    def damage_block_number(self):
        n = self.chance.choice(self.moves)
        if self.source.klartext or self.lines[n].startswith("N"):
            return None
        return "block number", True, self.with_line(n, f"N{self.chance.choice(['-1', '1.5', '+2'])} {self.lines[n]}"), \
            self.certificate

    def damage_mode_line(self):
        n = self.chance.choice(self.moves)
        word = self.chance.choice(["L M8", "CYCL DEF 7.0", "LBL 1", "L FMAX"] if self.source.klartext else
                                  "G91 G20 G18 G41 M0 T2 G0 G93 G92 S5 G68 #5=1.".split())
        lines, certificate = self.refitted(n, self.lines[:n] + [word] + self.lines[n:], 1)
        return "mode line", True, lines, certificate

    def damage_copied_byte(self):
        n = self.chance.choice(self.copied)
        if not self.lines[n]:
            return None
        at = self.chance.randrange(len(self.lines[n]))
        line = self.lines[n][:at] + self.chance.choice("0123456789GMXYZ .-") + self.lines[n][at + 1:]
        return "copied byte", line != self.lines[n], self.with_line(n, line), self.certificate

    def damage_copied_called_run(self):
        """An acting line is changed, and the certificate says that it is a run."""
        n = self.chance.choice(self.acting)
        runs = sorted(self.runs + [(self.old_line(n) + 1, 1, n + 1, 1)], key=lambda run: run[2])
        parts = dict(zip(self.runs, re.split(r"(?m)^run .*\n", self.certificate)[1:]))
        certificate = "Batten certificate 1\ntolerance 0.01 mm\n" + "".join(
            "run {} {} {} {}\n".format(*run) + parts.get(run, "") for run in runs)
        line = self.chance.choice(["M9", "M8", "S1", "G0 X1", "", "(hi)", "L FMAX"])
        return "called a run", line != self.lines[n], self.with_line(n, line), certificate

    def old_line(self, n):
        """Of a copied line."""
        for old, old_count, new, new_count in reversed(self.runs):
            if n + 1 >= new + new_count:
                return old + old_count - 1 + (n + 1 - new - new_count)
        return n

    def damage_lost_line(self):
        n = self.chance.choice(self.in_runs)
        lines = self.lines[:n] + self.lines[n + 1:]
        if self.chance.random() < 0.5:
            return "lost line", True, lines, self.certificate
        lines, certificate = self.refitted(n, lines, -1)
        # An end of a straight path that is lost can be harmless; so may other lines be.
        return "lost line, fitted", False, lines, self.scrambled(certificate)

    def damage_swapped_lines(self):
        n = self.chance.choice(self.moves)
        if n + 1 not in self.moves or self.form != "lines" or self.source.klartext:
            return None
        lines = self.lines[:n] + [self.lines[n + 1], self.lines[n]] + self.lines[n + 2:]
        places = self.vertices(lines)
        both = [places[k] for k in (n, n + 1)]
        plain = all(re.fullmatch(r"X\S+ Y\S+", self.lines[k]) for k in (n, n + 1))
        harmful = plain and None not in both and math.dist(*both) > 6 * TOLERANCE
        return "swapped lines", harmful, lines, self.scrambled(self.certificate)

    def damage_added_line(self):
        n, other = self.chance.choice(self.moves), self.chance.choice(self.moves)
        lines, certificate = self.refitted(n, self.lines[:n] + [self.lines[other]] + self.lines[n:], 1)
        places = self.vertices(self.lines)
        plain = re.fullmatch(r"(L )?X\S+ Y\S+", self.lines[other]) and self.form == "lines" and \
            not any("Z" in self.lines[k] for k in (n, other)) and places[n] and places[other]
        harmful = bool(plain) and math.dist(places[n], places[other]) > 3
        return "added line", harmful, lines, self.scrambled(certificate)

    def damage_tolerance(self):
        larger = self.chance.choice(["0.02", "1", "0.0100001"])
        n = self.chance.choice(self.moves)
        return "tolerance", True, self.lines, self.certificate.replace("tolerance 0.01", f"tolerance {larger}")

    def damage_run_numbers(self):
        """A line that differs is said to be copied, or one that acts to be rewritten."""
        run = self.chance.choice(self.runs)
        old, old_count, new, new_count = run
        by = self.chance.choice([-1, 1])
        other = (old + by, old_count - by, new + by, new_count - by)
        if min(other) < 1:
            return None
        certificate = self.certificate.replace("run {} {} {} {}".format(*run), "run {} {} {} {}".format(*other))
        harmful = self.old[old - 1] != self.lines[new - 1] if by > 0 else new - 2 in self.acting and \
            not re.match(r"G1 Z|L Z\S+ F50", self.lines[new - 2])
        return "run numbers", harmful, self.lines, certificate

    def damage_pairs(self):
        return "pairs", False, self.lines, self.scrambled(self.certificate)


class Campaign:
    def __init__(self, batten, folder):
        self.batten, self.old = batten, folder / "old.nc"
        self.new, self.certificate = folder / "new.nc", folder / "new.cert"
        self.counts = collections.defaultdict(lambda: [0, 0, 0, 0])  # harmful, accepted; others, accepted
        self.wrong, self.judged = [], 0

    def check(self, control):
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            code = check_certificate.main([str(self.old), str(self.new), str(self.certificate), "--control", control,
                                           "--tolerance", str(TOLERANCE)])
        return code == 0, said.getvalue()

    def smoothed(self, control, form, chance):
        source = Source(control, chance)
        self.old.write_text(source.text)
        command = [self.batten, "smooth", self.old, "-o", self.new, "--certificate", self.certificate, "--force",
                   "--quiet", "--target", control, "--tolerance", str(TOLERANCE), "--output", form, "--threads", "1"]
        ran = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        if ran.returncode != 0:
            self.wrong.append(f"{control} {form}: smooth ended with {ran.returncode}: {ran.stderr[-300:]}")
            return None
        accepted, said = self.check(control)
        if not accepted:
            self.wrong.append(f"{control} {form}: not accepted: {said}")
            return None
        size = len(self.certificate.read_bytes()), len(self.new.read_bytes())
        if size[0] > size[1]:
            self.wrong.append(f"{control} {form}: certificate of {size[0]} bytes, program of {size[1]}")
        certificate = self.certificate.read_text()
        if "run " not in certificate:
            return None
        pair = Pair(source, control, form, self.new.read_text(), certificate, chance)
        return pair if pair.moves else None

    def damage(self, pair):
        damage = pair.damaged()
        if damage is None:
            return 0
        kind, harmful, lines, certificate = damage
        if lines == pair.lines and certificate == pair.certificate:
            return 0
        self.new.write_text("\n".join(lines) + "\n")
        self.certificate.write_text(certificate)
        accepted, _ = self.check(pair.control)
        count = self.counts[kind]
        count[0 if harmful else 2] += 1
        count[1 if harmful else 3] += accepted
        why = ""
        if accepted and not harmful:
            why = oracle.OldProgram(pair.source.text, pair.control).harm("\n".join(lines) + "\n", TOLERANCE)
            self.judged += 1
        if accepted and (harmful or why):
            changed = [line for line in lines if line not in pair.lines][:2]
            self.wrong.append(f"{pair.control} {pair.form}: {kind}: accepted: {changed} {why}")
        return 1

    def run(self, count, seed):
        done, round_number = 0, 0
        each = max(1, count // 39)
        while done < count and round_number < count + 3:
            for control, forms in FORMS.items():
                for form in forms:
                    pair = self.smoothed(control, form, random.Random(f"{seed} {control} {form} {round_number}"))
                    tries = 0
                    wanted = done + min(each, count - done) if pair else done
                    while done < wanted and tries < 20 * each:
                        done += self.damage(pair)
                        tries += 1
            round_number += 1
        return done


def constants(batten, folder):
    """Findings about a program with expressions of parameters: it has to be certified while lines before
    set each to a number, and none among the rewritten lines."""
    wave = [f"X[#<s>*{0.2 * i:.3f}] Y[#<s>*[{math.sin(0.2 * i):.4f}/2]]" for i in range(1, 101)]
    old, new, proof = (folder / name for name in ("old.ngc", "new.ngc", "new.cert"))

    def verdict(setting, planted, behind=None, control="linuxcnc"):
        """`planted`: among the rewritten lines; `behind`: the setting, in both programs."""
        lines = ["G21 G17 G90 G94 G40", setting, "G0 X0 Y0 Z5", "G1 Z-1 F300", "G1 " + wave[0] + " F2000",
                 *wave[1:], "G0 Z5", "G1 X[#<s>*3] F300", "M2"]
        if control == "siemens":  # which takes no names
            lines = [line.replace("#<s>", "#5") for line in lines]
        old.write_text("\n".join(lines) + "\n")
        subprocess.run([batten, "smooth", old, "-o", new, "--certificate", proof, "--force", "--quiet", "--target", control,
                        "--tolerance", str(TOLERANCE), "--output", "lines", "--prefer", "size"], check=True, capture_output=True)
        text, certificate = new.read_text().split("\n"), proof.read_text()
        run = re.search(r"run (\d+) (\d+) (\d+) (\d+)", certificate)
        if run is None:
            return "kept"
        if planted:
            text.insert(int(run[3]) + 5, planted)
            certificate = certificate.replace(run[0], f"run {run[1]} {run[2]} {run[3]} {int(run[4]) + 1}")
        if behind:
            text.insert(2, behind)
            old.write_text("\n".join([*lines[:2], behind, *lines[2:]]) + "\n")
            certificate = re.sub(r"run (\d+) (\d+) (\d+) ", lambda m: f"run {int(m[1]) + 1} {m[2]} {int(m[3]) + 1} ", certificate)
        new.write_text("\n".join(text))
        proof.write_text(certificate)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            code = check_certificate.main([str(old), str(new), str(proof), "--control", control,
                                           "--tolerance", str(TOLERANCE)])
        if "an expression" in said.getvalue() and behind:
            return "no value"
        return "refused" if code else "certified"

    expected = {("#<s> = 1.5", ""): "certified", ("#<s> = 1.5", "#<s> = 2.0"): "refused",
                ("#<s> = 1.5", "#5 = 2.0"): "refused", ("#<s> = 1.5", "#<other> = 2.0"): "refused",
                ("#<s> = 9\n#<s> = 1.5", ""): "certified", ("#<s> = 1.5 #<other> = 2", ""): "refused",
                ("#<s> = 1.5", "", "(PY,x)"): "no value", ("#<s> = 1.5", "", "O#1 call"): "no value",
                ("G69 G43 H1\n#<s> = 1.5", "", None, "siemens"): "certified",  # its ISO dialect
                ("G68 X0 Y0 R30\n#<s> = 1.5", "", None, "siemens"): "kept",
                ("#<s> = 1.5", "", "#<s> = [2]"): "no value", ("#<s> = 1.5", "", "(a)"): "certified"}
    found = {case: verdict(*case) for case in expected}
    return [f"constants: {case}: {found[case]}" for case in expected if found[case] != expected[case]]


def corners(batten, folder):
    """Findings about programs of right angles that became curves: symmetric, so that at every corner two steps
    of the rule are equal but for rounding."""
    old, new, proof = (folder / name for name in ("old.ngc", "new.ngc", "new.cert"))
    findings = []
    for seed, control in [(73, "siemens"), (230, "linuxcnc"), (283, "linuxcnc"), (293, "siemens"), (373, "linuxcnc")]:
        chance = random.Random(seed)
        x, y, lines = 0.0, 0.0, ["G21 G17 G90 G94", "G0 X0 Y0 Z5", "G1 Z-1 F300"]
        for k in range(chance.choice([4, 6, 10])):
            way = round(chance.choice([0.5, 2, 8]) * chance.uniform(0.5, 1.5), 3) * chance.choice([1, 1, -1])
            feed = " F1000" if k == 0 else ""
            if chance.random() < 0.3:
                x, y = round(x + way, 3), round(y + way * chance.uniform(-1, 1), 3)
                lines.append(f"G1 X{x:g} Y{y:g}{feed}")
            elif k % 2 == 0:
                x = round(x + way, 3)
                lines.append(f"G1 X{x:g}{feed}")
            else:
                y = round(y + way, 3)
                lines.append(f"G1 Y{y:g}{feed}")
        old.write_text("\n".join([*lines, "G0 Z5", "M2"]) + "\n")
        subprocess.run([batten, "smooth", old, "-o", new, "--certificate", proof, "--force", "--quiet", "--target", control,
                        "--tolerance", str(TOLERANCE), "--output", "curves"], check=True, capture_output=True)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            code = check_certificate.main([str(old), str(new), str(proof), "--control", control,
                                           "--tolerance", str(TOLERANCE)])
        if code or new.read_text() == old.read_text():
            findings.append(f"corners: {seed} {control}: {said.getvalue() or 'not rewritten'}")
    return findings


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        campaign = Campaign(options.batten.resolve(), pathlib.Path(folder))
        campaign.wrong += constants(options.batten.resolve(), pathlib.Path(folder))
        campaign.wrong += corners(options.batten.resolve(), pathlib.Path(folder))
        done = campaign.run(options.count, options.seed)
    for kind, (harmful, accepted, others, others_accepted) in sorted(campaign.counts.items()):
        print(f"{kind}: {harmful} harmful, {accepted} of them accepted; {others} others, {others_accepted} accepted")
    harmful = sum(count[0] for count in campaign.counts.values())
    print("\n".join(campaign.wrong + [f"{done} damaged, {harmful} of them harmful by construction; "
                                      f"{campaign.judged} others were accepted and read again; {len(campaign.wrong)} findings"]))
    return 1 if campaign.wrong or done < options.count else 0


if __name__ == "__main__":
    sys.exit(main())
