#!/usr/bin/env python3
"""make_cam_programs_check.py BATTEN: a random program of each style of make_cam_programs.py has the same
bytes each time it is made, is smoothed, and what comes out is accepted by `verify`."""

import pathlib
import subprocess
import sys
import tempfile

from make_cam_programs import STYLES, text_of

SEED = 7
TOLERANCE = "0.01"
LEAST_REWRITTEN = 7  # there is nothing to win on zigzags, and little among much noise


def main():
    batten = pathlib.Path(sys.argv[1]).resolve()
    wrong = []
    rewritten = 0
    with tempfile.TemporaryDirectory(prefix="batten-cam-") as name:
        before, after = pathlib.Path(name) / "before.nc", pathlib.Path(name) / "after.nc"
        for number in range(len(STYLES)):
            text, style = text_of(number, SEED)
            if text_of(number, SEED)[0] != text:
                wrong.append(f"{style}: other bytes the second time")
            before.write_text(text)
            for command in (["smooth", before, "-o", after, "--force"], ["verify", before, after]):
                done = subprocess.run([batten, *command, "--target", "linuxcnc", "--tolerance", TOLERANCE],
                                      capture_output=True, text=True)
                if done.returncode != 0:
                    wrong.append(f"{style}: {command[0]} ended with {done.returncode}: {done.stderr}")
            rewritten += after.read_text() != text
        if rewritten < LEAST_REWRITTEN:
            wrong.append(f"{rewritten} of {len(STYLES)} styles rewritten")
    print("\n".join(wrong) or f"{len(STYLES)} styles: made again alike, smoothed and verified")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
