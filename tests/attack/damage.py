"""Random damage to a program's text."""

import re

ADDED = """G0 G2 G3 G91 G90 G18 G20 F100 M8 M9 X5 Y5 Z1 I1 J1 G53 G41 G93 G95 G64 G61 S300 M5 G55 / M0 P1 R5
    N5 N-1 G4 E1 A5 T3 H2 D1 ( (a) (a(b) ;a""".split()
# Of G5.2, G06.2, BSPLINE and POLY.
WEIGHT = re.compile(r"(PW=|PO\[\]=\(|^(?:N\d+ ?)?(?:G5\.2 ?)?X[-\d.]+ ?Y[-\d.]+ ?P|K[\d.]+[^R\n]*R)(\d+\.?\d*)", re.M)
ADDED_KLARTEXT = """FMAX F100 M8 M9 M5 R0 RL RR X+5 IY+1 Z+1 M91 M3 DR+ M89 M90 A+5 M0 S300 / M2""".split()


class Damage:
    def __init__(self, klartext, point, chance):
        self.random, self.klartext, self.point = chance, klartext, point

    def of(self, text):
        """(kind, text); None where this time there was nothing to do it to."""
        kind = self.random.choice([name for name in dir(self) if name.startswith("damage_")])
        lines = text.split("\n")
        lines = getattr(self, kind)(lines, self.random.randrange(len(lines) - 1))
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



    def moved_place(self, lines, at, factor):
        at = self.line_with(lines, r"[XYZ][-+]?\d*\.\d")
        if at is None:
            return None
        places = list(re.finditer(r"([XYZ])([-+]?\d*\.(\d+))", lines[at]))
        m = self.random.choice(places)
        by = self.random.choice([-1, 1]) * factor
        sign = "+" if self.klartext else ""
        text = f"{m.group(1)}{float(m.group(2)) + by:{sign}.{max(4, len(m.group(3)))}f}"
        return lines[:at] + [lines[at][:m.start()] + text + lines[at][m.end():]] + lines[at + 1:]

    def damage_place_a_little(self, lines, at):
        return self.moved_place(lines, at, self.random.choice([0.002, 0.012, 0.03]))

    def damage_place_far(self, lines, at):
        return self.moved_place(lines, at, self.random.choice([0.1, 1.0, 25.4]))

    def damage_turned_arc(self, lines, at):
        at = self.line_with(lines, r"\bG0?[23]\b|DR[-+]")
        if at is None:
            return None
        other = {"2": "3", "3": "2", "+": "-", "-": "+"}
        line = re.sub(r"\b(G0?)([23])\b|(DR)([-+])",
                      lambda m: (m.group(1) or m.group(3)) + other[m.group(2) or m.group(4)], lines[at], count=1)
        return lines[:at] + [line] + lines[at + 1:]

    def damage_moved_lines(self, lines, at):
        count, to = self.random.choice([1, 2, 5]), self.random.randrange(len(lines))
        taken = lines[at:at + count]
        rest = lines[:at] + lines[at + count:]
        return rest[:to] + taken + rest[to:]

    def damage_lost_lines(self, lines, at):
        return lines[:at] + lines[at + self.random.choice([2, 4, 9]):]

    def damage_other_weight(self, lines, at):
        at = self.line_with(lines, WEIGHT)
        if at is None:
            return None
        factor = self.random.choice([0.2, 0.7, 0.98, 1.01, 1.5, 6, 0, -1])
        line = WEIGHT.sub(lambda m: f"{m.group(1)}{float(m.group(2)) * factor:.4f}", lines[at], count=1)
        return lines[:at] + [line] + lines[at + 1:]

    def damage_other_comment(self, lines, at):
        at = self.line_with(lines, r"[(;]")
        return None if at is None else lines[:at] + [re.sub(r"[(;].*", "", lines[at])] + lines[at + 1:]
