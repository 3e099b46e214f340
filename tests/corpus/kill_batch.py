#!/usr/bin/env python3
"""kill_batch.py BATTEN FOLDER [--kills 5] [--seed 1] [--jobs 2] [--options "..."]

`batten batch` of a folder of real programs, killed with SIGKILL at random moments and begun again,
against an undisturbed run: the same bytes in every file at the end, and at no moment a file that has
its name but not all its bytes. The tree is looked at all the time while batches run and after each
kill. The folder itself is only read.

Takes about twice as long as the batch; so it is no part of ctest, where tests/cli/batch_test.cpp does
the same with a few samples. Exits with 1 when something differs."""

import argparse
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

LOOK = 0.02  # s between two looks at the tree
wrong = []


def expect(truth, what):
    if not truth:
        wrong.append(what)
        print("WRONG:", what)


def files_below(root):
    """All files but the locks, which are empty, and halves, which have other names."""
    found = {}
    for folder, _, names in os.walk(root):
        for name in names:
            path = pathlib.Path(folder, name)
            if not name.endswith(".batten-part") and not name.startswith("lock"):
                found[str(path.relative_to(root))] = path
    return found


class Watched:
    """The new tree while it grows. A file is read again when another one stands in its place."""

    def __init__(self, root, expected):
        self.root, self.expected, self.seen, self.looks = root, expected, {}, 0

    def look(self):
        self.looks += 1
        for name, path in files_below(self.root).items():
            state = path.stat()
            mark = (state.st_ino, state.st_size, state.st_mtime_ns)
            if self.seen.get(name) == mark:
                continue
            self.seen[name] = mark
            expect(name in self.expected, f"{name}: not in the undisturbed tree")
            expect(path.read_bytes() == self.expected.get(name), f"{name}: not all its bytes")


def start(options, out):
    command = [options.batten, "batch", options.folder, out, *options.options.split(),
               "--jobs", str(options.jobs), "--progress", "off"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def run_to_the_end(options, out):
    began = time.monotonic()
    process = start(options, out)
    said = process.communicate()[1]
    expect(process.returncode in (0, 2), f"exit code {process.returncode}: {said[-500:]}")
    return process.returncode, time.monotonic() - began, said


def kill_once(options, out, after, watched):
    """Whether it was still at work."""
    process = start(options, out)
    end = time.monotonic() + after
    while process.poll() is None and time.monotonic() < end:
        watched.look()
        time.sleep(LOOK)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    watched.look()
    return process.returncode == -signal.SIGKILL


def check(options, scratch):
    code, seconds, _ = run_to_the_end(options, scratch / "undisturbed")
    expected = {n: p.read_bytes() for n, p in files_below(scratch / "undisturbed").items()}
    print(f"undisturbed: {len(expected)} files, {sum(map(len, expected.values()))} bytes, "
          f"{seconds:.1f} s, exit code {code}")
    source = {n: p.read_bytes() for n, p in files_below(options.folder).items()}

    chance = random.Random(options.seed)
    watched = Watched(scratch / "killed", expected)
    for _ in range(options.kills):
        # So that all kills together come before the work is done.
        after = chance.uniform(0.02, 1) * seconds / options.kills
        killed = kill_once(options, scratch / "killed", after, watched)
        expect(killed, f"it had ended before it was killed after {after:.2f} s")
        there = len(files_below(scratch / "killed"))
        parts = len(list((scratch / "killed").rglob("*.batten-part")))
        print(f"killed after {after:.2f} s: {there} whole files, {parts} halves under other names")
    last_code, last_seconds, said = run_to_the_end(options, scratch / "killed")
    expect(last_code == code, f"exit code {last_code} instead of {code}")
    watched.look()
    found = {n: p.read_bytes() for n, p in files_below(scratch / "killed").items()}
    expect(found == expected, "the trees differ")
    expect(not list((scratch / "killed").rglob("*.batten-part")), "halves are left")
    expect(source == {n: p.read_bytes() for n, p in files_below(options.folder).items()},
           "the programs themselves have changed")
    done = [line for line in said.splitlines() if "done already" in line]
    print(f"resumed: {last_seconds:.1f} s, {' '.join(done)}")
    print(f"{options.kills} kills, {watched.looks} looks at the tree, {len(found)} files, "
          f"{sum(map(len, found.values()))} bytes: "
          f"{'the same as undisturbed' if not wrong else f'{len(wrong)} wrong'}")


def main():
    words = argparse.ArgumentParser(description=__doc__,
                                    formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("batten", type=lambda name: str(pathlib.Path(name).resolve()))
    words.add_argument("folder", type=pathlib.Path)
    words.add_argument("--kills", type=int, default=5)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--jobs", type=int, default=2)
    words.add_argument("--options", default="--target linuxcnc --tolerance 0.01 --units mm")
    options = words.parse_args()
    with tempfile.TemporaryDirectory(prefix="batten-kill-batch-") as scratch:
        check(options, pathlib.Path(scratch))
    return 1 if wrong else 0


sys.exit(main())
