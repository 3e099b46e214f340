#!/usr/bin/env python3
"""check.py BATTEN FOLDER...   every program of the first folder that exists, smoothed and
checked: what is promised of the samples holds for programs that were not made for Batten.

BATTEN_CORPUS in the environment goes before the folders. Exits with 77 when there is no folder.
"""

import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import rules
from programs import bytes_of, programs_in

TOLERANCE = 0.01  # mm
SKIPPED = 77
AT_ONCE = 2

# Seconds after which a program of some megabytes counts as hanging, on a slow build.
HANGS = 600


def linuxcnc_accepts(program, folder):
    """Whether LinuxCNC's own interpreter reads it without a complaint; None where it is missing."""
    if shutil.which("rs274") is None:
        return None
    (folder / "tool.tbl").write_text("".join(f"T{i} P{i} D0.2 Z0\n" for i in range(1, 10)))
    (folder / "parameters.var").write_text("")
    # Its exit code is 0 even after some errors.
    done = subprocess.run(
        ["rs274", "-g", "-n", "2", "-t", "tool.tbl", "-v", "parameters.var", program],
        cwd=folder, env={**os.environ, "HOME": str(folder)}, timeout=HANGS,
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    complaints = [line for line in done.stderr.splitlines() if line.strip() != b"executing"]
    return done.returncode == 0 and not complaints


class Check:
    """One program in a folder of its own. `wrong` holds what it found."""

    def __init__(self, batten, file, folder):
        self.batten, self.folder = batten, folder
        self.before = bytes_of(file)
        (folder / "old.nc").write_bytes(self.before)
        self.wrong, self.said = [], ""

    def run(self, command, *arguments):
        return subprocess.run([self.batten, command, *arguments, "--tolerance", str(TOLERANCE)],
                              cwd=self.folder, capture_output=True, timeout=HANGS)

    def smooth(self, old, new, *more):
        return self.run("smooth", old, "-o", new, "--target", "linuxcnc", *more)

    def check(self):
        done = self.smooth("old.nc", "new.nc", "--json", "report.json")
        if done.returncode == 2:
            self.check_refusal(done)
        elif done.returncode == 0:
            self.check_result()
        else:
            self.wrong.append(f"smooth: exit code {done.returncode}: {done.stderr[-500:]!r}")

    def check_refusal(self, done):
        self.said = "refused"
        if b"error: " not in done.stderr:
            self.wrong.append(f"refused without a diagnostic: {done.stderr!r}")
        if (self.folder / "new.nc").exists():
            self.wrong.append("refused, but written")

    def check_result(self):
        after = (self.folder / "new.nc").read_bytes()
        report = json.loads((self.folder / "report.json").read_text())
        self.said = f"{len(rules.rewritten(report))} of {len(report['runs'])} runs rewritten"
        self.wrong += rules.all_rules(self.before, after, report, TOLERANCE)
        self.check_verify()
        self.check_second_pass(after)
        if linuxcnc_accepts("old.nc", self.folder) and not linuxcnc_accepts("new.nc", self.folder):
            self.wrong.append("rs274 takes the old program, but not the new one")

    def check_verify(self):
        done = self.run("verify", "old.nc", "new.nc", "--target", "linuxcnc")
        if done.returncode != 0:
            self.wrong.append(f"verify: exit code {done.returncode}: {done.stderr[-500:]!r}")

    def check_second_pass(self, after):
        if after == self.before:
            return  # it would be the first pass again
        done = self.smooth("new.nc", "again.nc")
        if done.returncode != 0 or (self.folder / "again.nc").read_bytes() != after:
            self.wrong.append("a second pass changes the program")


def checked(batten, file):
    with tempfile.TemporaryDirectory(prefix="batten-corpus-") as folder:
        check = Check(batten, file, pathlib.Path(folder))
        try:
            check.check()
        except subprocess.TimeoutExpired as late:
            check.wrong.append(f"not done after {late.timeout} s: {late.cmd[0]} {late.cmd[1]}")
        except (OSError, ValueError) as error:
            check.wrong.append(str(error))
        return file.name, check.said, check.wrong


def main(batten, folders):
    named = os.environ.get("BATTEN_CORPUS")
    found = [f for f in map(pathlib.Path, [named] if named else folders) if f.is_dir()]
    programs = programs_in(found[0]) if found else []
    if not programs:
        print("no corpus of programs")
        return SKIPPED
    largest_first = sorted(programs, key=lambda f: -f.stat().st_size)
    failed = rewritten = 0
    with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
        for name, said, wrong in pool.map(lambda f: checked(batten, f), largest_first):
            print(f"{name}: {said}", *wrong[:5], sep="\n    ", flush=True)
            failed += bool(wrong)
            rewritten += said[:1].isdigit() and not said.startswith("0 ")
    print(f"{len(programs)} programs, {rewritten} with rewritten runs, {failed} failed")
    return 1 if failed or not rewritten else 0


if len(sys.argv) < 3:
    sys.exit(__doc__)
sys.exit(main(str(pathlib.Path(sys.argv[1]).resolve()), sys.argv[2:]))
