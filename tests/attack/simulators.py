#!/usr/bin/env python3
"""simulators.py BATTEN [--count 12] [--seed 1] [--self-check]

Does a firmware do with the new programs what Batten says? Takes simulators that the user has built:

  BATTEN_GRBL_SIM   a command for programs of grbl, BATTEN_GRBL_MACHINE the machine (its name or file
                    for `batten time --machine`; default: router)
  BATTEN_KLIPPER    a command for programs of Klipper, BATTEN_KLIPPER_MACHINE (default: klipper-router)

The command is called with the path of a program as its last word. It prints where the tool is, on
lines `t,x,y,z` (seconds from the first motion, mm), with one at least at each end of each move that
was planned, beginning at 0,0,0,0; lines that do not begin with a number are left out.

Random programs are smoothed for the target at 0.05 mm. What the firmware does with the new one has to
be the path of the old one within the tolerance and 0.03 mm (its steps and chords), in order and both
ways; its time what `batten time` says to 2 % and 0.02 s, and not longer than that of the old program.
Exits with 1 where it is not, with 77 where neither variable is set. --self-check tests these checks
themselves, with a command that does as Batten says and with faults in it: it says nothing of any firmware."""

import argparse
import json
import os
import pathlib
import random
import re
import shlex
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import paths  # noqa: E402
from programs import Programs  # noqa: E402
from readers_other import reader_for  # noqa: E402

TOLERANCE, STEPS_AND_CHORDS = 0.05, 0.03  # mm
STYLES = ("contours", "raster", "waterlines", "adaptive", "engraving", "finishing")
FIRMWARES = [("BATTEN_GRBL_SIM", "BATTEN_GRBL_MACHINE", "grbl", "router"),
             ("BATTEN_KLIPPER", "BATTEN_KLIPPER_MACHINE", "klipper", "klipper-router")]


class PlainPrograms(Programs):
    """In millimetres, of moves alone."""

    def program_of(self, style):
        self.inch, self.point, self.decimals, self.noise = False, "", 4, self.random.choice([0.0, 0.002])
        self.every_word, self.all_axes, self.blank, self.zero = True, False, " ", "G1"
        self.comments, self.states, self.last, self.last_feed = False, 0.0, dict.fromkeys("XYZ"), None
        lines = ["G21", "G90"]
        for chain in getattr(self, style)():
            lines += self.chain_lines(chain, style, 0.0)
        return "\n".join(lines) + "\n"


def moves_of(text, target):
    """The whole path of a program from 0,0,0."""
    points = [(0.0, 0.0, 0.0)]
    for kind, _, value in reader_for(target)(text).run():
        points += [] if kind == "event" else value[1:]
    return points


def executed(command, program):
    """Points and time."""
    ran = subprocess.run([*command, str(program)], capture_output=True, text=True, timeout=600)
    rows = [line.split(",") for line in ran.stdout.split("\n") if re.match(r"[-.\d]", line)]
    if ran.returncode != 0 or not rows:
        raise RuntimeError(f"{shlex.join(command)} ended with {ran.returncode}: {ran.stderr.strip()[-200:]}")
    times = [float(row[0]) for row in rows]
    if times != sorted(times):
        raise RuntimeError("its times go back")
    return [tuple(map(float, row[1:4])) for row in rows], times[-1]


def predicted(batten, program, target, machine):
    ran = subprocess.run([batten, "time", program, "--target", target, "--machine", machine, "--from", "0,0,0", "--json",
                          "-", "--quiet"], capture_output=True, text=True, check=True)
    return json.loads(ran.stdout)["time_s"]


def check(batten, command, target, machine, count, seed):
    """What is wrong."""
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        old, new = pathlib.Path(folder, "old.nc"), pathlib.Path(folder, "new.nc")
        for n in range(count):
            chance = random.Random(f"{seed} {target} {n}")
            style = STYLES[n % len(STYLES)]
            text = PlainPrograms(target, chance).program_of(style)
            old.write_text(text)
            form = chance.choice(["auto", "arcs", "lines"])
            subprocess.run([batten, "smooth", old, "-o", new, "--force", "--quiet", "--target", target, "--machine", machine,
                            "--tolerance", str(TOLERANCE), "--output", form], check=True)
            name = f"{target}, {style} {n}, {form}"
            try:
                path, time = executed(command, new)
                _, time_before = executed(command, old)
            except (RuntimeError, subprocess.TimeoutExpired) as error:
                wrong.append(f"{name}: {error}")
                continue
            if not paths.together(path, moves_of(text, target), TOLERANCE + STEPS_AND_CHORDS):
                wrong.append(f"{name}: what was done leaves the old path by more than {TOLERANCE + STEPS_AND_CHORDS} mm")
            told = predicted(batten, new, target, machine)
            if abs(told - time) > 0.02 * time + 0.02:
                wrong.append(f"{name}: {time:.3f} s, batten time says {told:.3f}")
            if form == "auto" and time > time_before * 1.01 + 0.02:
                wrong.append(f"{name}: {time_before:.3f} s became {time:.3f}")
    return wrong


# --- the checks checked --------------------------------------------------------------------------


def played(batten, target, machine, fault, program):
    """What `batten time` and the readers say, in the documented form, and a fault."""
    path = moves_of(pathlib.Path(program).read_text(), target)
    time = predicted(batten, program, target, machine)
    is_new = pathlib.Path(program).name == "new.nc"
    if fault == "elsewhere" and is_new:
        middle = len(path) // 2
        path = path[:middle] + [tuple(x + 0.3 for x in path[middle])] + path[middle + 1:]
    elif fault == "end-lost" and is_new:
        path = path[:len(path) * 2 // 3]
    elif fault == "other-order" and is_new:
        path = path[:1] + path[:0:-1]
    elif fault == "longer" and is_new:
        time *= 1.05
    elif fault == "refused" and is_new:
        return 1
    lengths = [0.0]
    for p, q in zip(path, path[1:]):
        lengths.append(lengths[-1] + sum((a - b) ** 2 for a, b in zip(p, q)) ** 0.5)
    print("t,x,y,z")
    for p, length in zip(path, lengths):
        print(",".join(f"{x:.6f}" for x in (time * length / lengths[-1], *p)))
    return 0


def self_check(batten):
    wrong = 0
    for _, _, target, machine in FIRMWARES:
        for fault in ("none", "elsewhere", "end-lost", "other-order", "longer", "refused"):
            command = [sys.executable, "-B", __file__, str(batten), "--play", target, machine, fault]
            found = check(batten, command, target, machine, 3, 1)
            if bool(found) != (fault != "none"):
                wrong += 1
                print(f"{target}: {fault}: {found or 'nothing found'}")
    print(f"12 firmwares that are none, {wrong} judged wrong")
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--self-check", action="store_true")
    parser.add_argument("--play", nargs=4, help=argparse.SUPPRESS)
    options = parser.parse_args()
    batten = options.batten.resolve()
    if options.play:
        return played(batten, *options.play)
    if options.self_check:
        return self_check(batten)
    wrong, ran = [], 0
    for variable, machine_variable, target, machine in FIRMWARES:
        if not os.environ.get(variable):
            print(f"{target}: skipped, {variable} is not set")
            continue
        ran += 1
        found = check(batten, shlex.split(os.environ[variable]), target, os.environ.get(machine_variable, machine),
                      options.count, options.seed)
        print("\n".join(found + [f"{target}: {options.count} programs, {len(found)} findings"]))
        wrong += found
    return 1 if wrong else 0 if ran else 77


if __name__ == "__main__":
    sys.exit(main())
