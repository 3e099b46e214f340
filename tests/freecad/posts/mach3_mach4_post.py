"""A post that can only return its text: it writes text to a file for bytes, as jtech of 0.20 does."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import wave_program as wave  # noqa: E402
sys.path.pop(0)


def export(objectslist, filename, argstring):
    text = wave.gcode()
    if filename != "-":
        with open(filename, "wb") as file:
            file.write(text)
    return text
