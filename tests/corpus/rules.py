"""What must be true of a program and what `batten smooth` made of it, asked of their bytes and
of the JSON report alone. Every rule gives a list of sentences, empty when it is kept."""

import re

LINE = re.compile(rb"[^\r\n]*(?:\r\n|\n|\r)|[^\r\n]+")
COMMENT = re.compile(rb"\([^)\r\n]*\)?|;[^\r\n]*")
WORD = re.compile(rb"([A-Z])\s*([+-]?[\d.]+)")

# Variables of LinuxCNC, and the numbers that they make.
VARIABLE = re.compile(rb"#\s*(?:<[^>]*>|\d+)")
ASSIGNED = re.compile(rb"(#\s*(?:<[^>]*>|\d+))\s*=")
EXPRESSION = re.compile(rb"(?<=[XYZIJKRF])\s*(?:\[[^\]]*\]|[+-]?#\s*(?:<[^>]*>|\d+))", re.IGNORECASE)

# Words of a line of a run: of straight moves, and those that only arcs have.
WORDS_OF_A_RUN = set(b"NGXYZF")
WORDS_OF_ARCS = set(b"IJKR")
WORDS_OF_NEW_LINES = WORDS_OF_A_RUN | WORDS_OF_ARCS

# With them a line with I, J, K or R is an arc; a cycle or a scaling has other codes.
CODES_OF_ARCS = {2, 3}

# G codes that forbid rewriting from their line on, with the codes that end them.
UNSAFE_STATES = {
    "incremental": ({91}, {90}),
    "inverse time": ({93}, {94, 95}),
    "feed per revolution": ({95}, {93, 94}),
    "cutter compensation": ({41, 42, 41.1, 42.1}, {40}),
    "exact path": ({61, 61.1}, {64}),
    "diameters": ({7}, {8}),
    "polar": ({16}, {15}),
    "rotation": ({68, 68.2}, {69}),
}

# A time is printed with few digits; a rewritten run may take half a percent more, or a period of
# the control.
TIME_MARGIN = 1.006
PERIOD = 0.001  # s


def lines_of(text):
    return LINE.findall(text)


def words_of(line):
    """(letter, number) of each word; a letter without a plain number has None."""
    plain = COMMENT.sub(b" ", line).upper()
    words = []
    at = 0
    while at < len(plain):
        if plain[at : at + 1].isspace():
            at += 1
            continue
        match = WORD.match(plain, at)
        try:
            words.append((plain[at], float(match.group(2)) if match else None))
        except ValueError:
            words.append((plain[at], None))
        at = match.end() if match else at + 1
    return words


def rewritten(report):
    return [run for run in report["runs"] if run["status"] == "rewritten"]


def runs_are_proved(report, tolerance):
    wrong = []
    for run in rewritten(report):
        where = f"run at line {run['first_line']}"
        if run["proved"] is not True:
            wrong.append(f"{where}: not proved")
        if not 0 <= run["deviation_mm"] <= tolerance:
            wrong.append(f"{where}: deviation {run['deviation_mm']} mm of {tolerance} mm")
        before = run["time_before_s"]
        if run["time_after_s"] > max(TIME_MARGIN * before, before + PERIOD):
            wrong.append(f"{where}: {run['time_before_s']} s became {run['time_after_s']} s")
    if report["proved"] is not True:
        wrong.append("the program as a whole is not proved")
    return wrong


def cut(before, after, report):
    """(new text instead of each run, sentences): what stands in `after` between the parts that
    were copied."""
    lines = lines_of(before)
    copied, first = [], 0
    for run in rewritten(report):
        copied.append(b"".join(lines[first : run["first_line"] - 1]))
        first = run["last_line"]
    copied.append(b"".join(lines[first:]))
    if len(copied) == 1:
        return [], [] if before == after else ["no run is rewritten, but the bytes differ"]
    if not after.startswith(copied[0]):
        return [], ["what stands before the first run differs"]
    if not after.endswith(copied[-1]):
        return [], ["what stands behind the last run differs"]
    new, at, end = [], len(copied[0]), len(after) - len(copied[-1])
    for run, part in zip(rewritten(report)[1:], copied[1:-1]):
        found = after.find(b"\n" + part, at, end) + 1
        if found == 0:
            return [], [f"what stands before the run at line {run['first_line']} differs"]
        new.append(after[at:found])
        at = found + len(part)
    if at > end:
        return [], ["parts of the program are missing"]
    return new + [after[at:end]], []


def rest_is_copied(before, after, report):
    return cut(before, after, report)[1]


def new_lines_only_move(before, after, report):
    wrong = []
    for text in cut(before, after, report)[0]:
        for line in lines_of(text):
            if any(letter not in WORDS_OF_NEW_LINES for letter, _ in words_of(line)):
                wrong.append(f"written: {line!r}")
    return wrong


def assigned_above(lines):
    """For each line the variables that some line above it assigns, as LinuxCNC writes them."""
    names, above = set(), []
    for line in lines:
        above.append(frozenset(names) if not above or above[-1] != names else above[-1])
        names.update(re.sub(rb"\s", b"", name).upper() for name in ASSIGNED.findall(COMMENT.sub(b" ", line)))
    return above


def without_expressions(line, assigned):
    """A number for each expression whose variables are all assigned above."""
    def number(match):
        names = {re.sub(rb"\s", b"", name).upper() for name in VARIABLE.findall(match[0])}
        return b"0" if names <= assigned else match[0]
    return EXPRESSION.sub(number, COMMENT.sub(b" ", line))


def runs_only_moved(before, report):
    """Nothing that does more than move was rewritten, nothing with a fourth axis or an extruder."""
    lines = lines_of(before)
    above = assigned_above(lines)
    wrong = []
    for run in rewritten(report):
        for number in range(run["first_line"], run["last_line"] + 1):
            words = words_of(without_expressions(lines[number - 1], above[number - 1]))
            letters = {letter for letter, _ in words}
            codes = {value for letter, value in words if letter == ord("G")}
            moves = letters <= WORDS_OF_A_RUN or (
                letters <= WORDS_OF_A_RUN | WORDS_OF_ARCS and codes <= CODES_OF_ARCS
            )
            if not moves or any(value is None for _, value in words):
                wrong.append(f"line {number} was rewritten: {lines[number - 1]!r}")
    return wrong


def runs_were_in_safe_states(before, report):
    in_run = set()
    for run in rewritten(report):
        in_run.update(range(run["first_line"], run["last_line"] + 1))
    active, wrong = set(), []
    for number, line in enumerate(lines_of(before), 1):
        codes = {value for letter, value in words_of(line) if letter == ord("G")}
        for name, (begin, end) in UNSAFE_STATES.items():
            if codes & end:
                active.discard(name)
            if codes & begin:
                active.add(name)
        if active and number in in_run:
            wrong.append(f"line {number} was rewritten in {', '.join(sorted(active))}")
    return wrong


def all_rules(before, after, report, tolerance):
    return (
        runs_are_proved(report, tolerance)
        + rest_is_copied(before, after, report)
        + new_lines_only_move(before, after, report)
        + runs_only_moved(before, report)
        + runs_were_in_safe_states(before, report)
    )
