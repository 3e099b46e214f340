#!/usr/bin/env python3
"""The rules of the corpus test find what is planted, and nothing in a good pair."""

import copy
import sys

import rules

BEFORE = b"G21 G90\r\nG0 X0 Y0\r\nG1 X1 F9\r\nN7 X2 (two)\r\nX3\r\nM8\r\nX4\r\nX5\r\nX6\r\nM2"
AFTER = b"G21 G90\r\nG0 X0 Y0\r\n(told)\r\nG1 X3 F9\r\nM8\r\nG2 X6 I1\r\nM2"
RUN = {"status": "rewritten", "proved": True, "deviation_mm": 0.009,
       "time_before_s": 2.0, "time_after_s": 1.0}
REPORT = {"proved": True, "runs": [{**RUN, "first_line": 3, "last_line": 5},
                                   {"status": "kept", "first_line": 6, "last_line": 6},
                                   {**RUN, "first_line": 7, "last_line": 9}]}


def with_run(**changes):
    report = copy.deepcopy(REPORT)
    report["runs"][0].update(changes)
    return report


def before_with(old, new):
    assert old in BEFORE
    return BEFORE.replace(old, new), AFTER.replace(old, new), REPORT


PLANTED = {
    "a run without a proof": (BEFORE, AFTER, with_run(proved=False)),
    "a run that leaves the tolerance": (BEFORE, AFTER, with_run(deviation_mm=0.0101)),
    "a run that became slower": (BEFORE, AFTER, with_run(time_after_s=2.1)),
    "a program without a proof": (BEFORE, AFTER, {**REPORT, "proved": False}),
    "a lost first line": (BEFORE, AFTER.replace(b"G21 G90\r\n", b""), REPORT),
    "a lost line between runs": (BEFORE, AFTER.replace(b"M8\r\n", b""), REPORT),
    "a changed line between runs": (BEFORE, AFTER.replace(b"M8", b"M08"), REPORT),
    "a line end more at the end": (BEFORE, AFTER + b"\r\n", REPORT),
    "a rewritten cycle": (BEFORE.replace(b"X5\r\n", b"G81 X5 R1\r\n"), AFTER, REPORT),
    "a written word that acts": (BEFORE, AFTER.replace(b"G2 X6 I1", b"G2 X6 I1 M9"), REPORT),
    "changed bytes without a run": (BEFORE, AFTER, {**REPORT, "runs": []}),
    "a rewritten fourth axis": before_with(b"X2 ", b"X2 A1 "),
    "a rewritten extruder": before_with(b"X2 ", b"X2 E.5 "),
    "a rewritten expression": before_with(b"X2 ", b"X[#1] "),
    "a rewritten optional block": before_with(b"N7 ", b"/N7 "),
    "incremental distances": before_with(b"G90", b"G91"),
    "inverse time": before_with(b"G90", b"G90 G93"),
    "cutter compensation": before_with(b"G90", b"G90 g42"),
}


def main():
    failures = rules.all_rules(BEFORE, AFTER, REPORT, 0.01)
    for name, (before, after, report) in PLANTED.items():
        if not rules.all_rules(before, after, report, 0.01):
            failures.append(f"not found: {name}")
    print("\n".join(failures) or f"{len(PLANTED)} planted violations found")
    return 1 if failures else 0


sys.exit(main())
