#!/usr/bin/env python3
"""The comparison of two binaries finds what is planted, and nothing between equals."""

import contextlib
import io
import pathlib
import sys
import tempfile

import compare_binaries

# What stands for batten: it is called as in `smooth program.nc -o new --json report.json ..`.
BINARY = """#!/bin/sh
sed s/X1.0/X1/ "$2" > "$4"
echo '{"batten": "0.1", "runs": [{"time_s": 2.5}], "lines": 3}' > "$6"
echo "smoothed" >&2
echo called >> CALLED
exit 0
"""
PROGRAM = "G1 X0 F9\nX1.0\nX2\n"

# What is changed in the new binary, and what is said then; nothing where it does not count.
PLANTED = {
    "another byte": (("s/X1.0/X1/", "s/X1.0/X1./"), "output: line 2: 'X1\\n' became 'X1.\\n'"),
    "a line less": (('"$2" > "$4"', '"$2" | head -2 > "$4"'), "output: line 3: 'X2\\n' became the end"),
    "another line end": (("s/X1.0/X1/", "'s/X1.0/X1/;1s/$/\\r/'"), "output: line 1: 'G1 X0 F9\\n' became"),
    "no output": (('> "$4"', "> /dev/null"), "output: only the old one is there"),
    "another figure": (('"lines": 3', '"lines": 4'), "report: line 5: ' \"lines\": 3\\n' became"),
    "no report": (("exit 0", 'rm "$6"'), "report: only the old one is there"),
    "a broken report": (('"lines": 3}', '"lines": 3'), "report: line 1: "),
    "another message": (('"smoothed"', '"copied"'), "stderr: line 1: 'smoothed\\n' became 'copied\\n'"),
    "a message elsewhere": ((" >&2", ""), "stdout: line 1: the end became 'smoothed\\n'"),
    "another exit code": (("exit 0", "exit 3"), "exit code 0 became 3"),
    "a crash": (("exit 0", "kill -SEGV $$"), "exit code 0 became -11"),
    "another version": (('"0.1"', '"0.2"'), None),
    "an ignored figure": (("2.5", "2.6"), None),
    "nothing": (("exit 0", "exit 0 #"), None),
}


class Place:
    """Two binaries, one program as a sample and one in the corpus."""

    def __init__(self, folder):
        self.folder = folder
        (folder / "samples" / "one").mkdir(parents=True)
        (folder / "samples" / "one" / "program.nc").write_text(PROGRAM)
        (folder / "samples" / "one" / "README.md").write_text("no program")
        (folder / "corpus").mkdir()
        (folder / "corpus" / "two.nc").write_text(PROGRAM + "X3\n")
        self.put("old", BINARY)

    def put(self, name, text):
        (self.folder / name).write_text(text.replace("CALLED", str(self.folder / f"{name}.calls")))
        (self.folder / name).chmod(0o755)

    def calls(self, name):
        file = self.folder / f"{name}.calls"
        return len(file.read_text().splitlines()) if file.exists() else 0

    def compare(self):
        """(exit code, what was printed)"""
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            code = compare_binaries.main(compare_binaries.read_options(
                [str(self.folder / "old"), str(self.folder / "new"), "--targets", "fanuc,grbl",
                 "--prefer", "time", "--threads", "1", "--ignore-key", "time_s", "--cache",
                 str(self.folder / "cache"), "--samples", str(self.folder / "samples"),
                 "--corpus", str(self.folder / "corpus")]))
        return code, said.getvalue()


def planted_differences(place):
    failures = []
    for name, ((old, new), expected) in PLANTED.items():
        assert old in BINARY, old
        place.put("new", BINARY.replace(old, new))
        code, said = place.compare()
        if code != (expected is not None):
            failures.append(f"{name}: exit code {code}")
        if expected and said.count(f", time, threads 1: {expected}") != 4:
            failures.append(f"{name}: not told of both programs for both targets: {said}")
        if not expected and "0 runs differ\n" not in said:
            failures.append(f"{name}: {said}")
    return failures


def kept_results(place):
    """The old binary ran once for each program and target, the new ones each time; and another old one
    is asked again."""
    failures = []
    if place.calls("old") != 4 or place.calls("new") < 4 * (len(PLANTED) - 1):
        failures.append(f"{place.calls('old')} calls of the old, {place.calls('new')} of the new")
    place.put("old", BINARY.replace("exit 0", "exit 4"))
    place.put("new", BINARY)
    if "exit code 4 became 0" not in place.compare()[1]:
        failures.append("another old binary was not asked")
    return failures


def size_of_windows():
    """The large programs end as programs do, on both sides of the bound and a line apart."""
    below, above = (program.data for program in compare_binaries.large_programs())
    bound = compare_binaries.WINDOWS_FROM
    right = (bound - 100 < len(below) < bound <= len(above) < bound + 100 and
             below.endswith(b"M30\n%\n") and above.endswith(b"M30\n%\n") and
             below.count(b"\n") + 1 == above.count(b"\n"))
    return [] if right else [f"large programs of {len(below)} and {len(above)} bytes"]


def main():
    failures = size_of_windows()
    compare_binaries.large_programs = lambda: []
    with tempfile.TemporaryDirectory(prefix="batten-compare-check-") as folder:
        place = Place(pathlib.Path(folder))
        failures += planted_differences(place) + kept_results(place)
    print("\n".join(failures) or f"{len(PLANTED)} planted differences told as they should be")
    return 1 if failures else 0


sys.exit(main())
