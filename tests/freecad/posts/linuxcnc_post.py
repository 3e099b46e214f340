"""A post as they are up to FreeCAD 1.1: a script with its own parser of arguments."""

import argparse
import pathlib
import shlex
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import wave_program as wave  # noqa: E402
sys.path.pop(0)

TOOLTIP = "writes a wave"

parser = argparse.ArgumentParser(prog="linuxcnc", add_help=False)
parser.add_argument("--no-show-editor", action="store_true")
parser.add_argument("--precision", type=int, default=3)
parser.add_argument("--no-units", action="store_true")
parser.add_argument("--crlf", action="store_true")
parser.add_argument("--keep-line-ends", action="store_true")


def export(objectslist, filename, argstring):
    args = parser.parse_args(shlex.split(argstring))
    if not args.no_show_editor:
        raise RuntimeError("an editor would open")
    text = wave.gcode("" if args.no_units else "G21", "\r\n" if args.crlf else "\n", args.precision)
    text = f"({' '.join(objectslist)})\n" + text
    if args.keep_line_ends:
        text = "\n\n" + text
    if filename != "-":
        with open(filename, "w") as file:
            file.write(text)
    return text
