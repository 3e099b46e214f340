#!/usr/bin/env python3
"""linuxcnc_waits.py --bench BENCH

Which words in each block end blending on the real LinuxCNC, and what that costs: a circle of 300
lines, F6000, G64 P0.01 Q0.01, with each of them. BENCH is the folder of the headless LinuxCNC bench
(lcnc_time.sh in it; 400 mm/s and 4000 mm/s2 an axis). Prints the seconds that the control took.
The tests of the model hold the one of S (MeasuredTime, CircleWithSpeeds)."""

import argparse
import math
import os
import pathlib
import re
import subprocess
import tempfile

WORDS = ["", "F6000", "G17", "G21", "G54", "G90", "G97", "M48", "T1", "S8000", "M3", "M8", "G49", "(MSG,a)",
         "M62 P1", "M67 E0 Q1"]
LINES = 300


def program(word):
    turns = [2 * math.pi * i / LINES for i in range(1, LINES + 1)]
    cuts = [f"G1 X{20 * math.cos(a) - 20:.6f} Y{20 * math.sin(a):.6f} {word if i else ''}" for i, a in enumerate(turns)]
    return "\n".join(["G17 G21 G90 G94 G40 G49", "G64 P0.01 Q0.01", "T1", "M3 S8000", "F6000", *cuts, "M2", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bench", type=pathlib.Path, default=os.environ.get("LINUXCNC_BENCH"))
    options = parser.parse_args()
    if options.bench is None:
        parser.error("--bench: no folder given, nor by LINUXCNC_BENCH")
    print("| in each block | s |\n|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        part = pathlib.Path(folder, "part.ngc")
        for word in WORDS:
            part.write_text(program(word))
            said = subprocess.run(["bash", options.bench / "lcnc_time.sh", part], capture_output=True, text=True).stdout
            time = re.search(r"cycle time +([\d.]+) s", said)
            print(f"| {word or 'nothing more'} | {time[1] if time else 'refused'} |", flush=True)


if __name__ == "__main__":
    main()
