#!/usr/bin/env python3
"""Does the check of what is reached see what it is there for? Small sets of objects of its own."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import check  # noqa: E402

# Source -> what it defines, what it names.
BASE = {
    "postproc/main.cpp": ({"main"}, {"smooth"}),
    "api/batten.cpp": ({"batten"}, {"verify"}),
    "postproc/smooth.cpp": ({"smooth"}, {"parse", "printf"}),
    "postproc/verify.cpp": ({"verify"}, {"parse"}),
    "gcode/parse.cpp": ({"parse"}, {"point"}),
    "geometry/point.cpp": ({"point"}, set()),
}
# What is changed (None: left out), and a part of the complaint; none: it is kept.
CASES = [
    ({}, ""),
    ({"gcode/alarms.cpp": ({"alarms"}, {"parse"})}, "gcode/alarms.cpp: neither"),
    ({"gcode/a.cpp": ({"a"}, {"b"}), "gcode/b.cpp": ({"b"}, {"a"})}, "gcode/b.cpp: neither"),
    ({"gcode/alarms.cpp": ({"alarms"}, set()), "gcode/parse.cpp": ({"parse"}, {"point", "alarms"})}, ""),
    ({"api/batten.cpp": None}, "no object of api/batten.cpp"),
    ({"gcode/parse.cpp": None}, "no objects of gcode/"),
]


def main():
    wrong = []
    for change, complaint in CASES:
        said = check.judge({s: v for s, v in {**BASE, **change}.items() if v is not None})
        if not complaint and said or complaint and not any(complaint in line for line in said):
            wrong.append(f"{sorted(change)}: expected {complaint or 'nothing'}, but: {said}")
    if not check.judge({}):
        wrong.append("no objects at all were taken")
    for line in wrong:
        print(line)
    print(f"{len(CASES) + 1} sets of objects, {len(wrong)} judged wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
