"""A post that writes its file and returns the name of it, as nccad does."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import wave_program as wave  # noqa: E402
sys.path.pop(0)


def export(objectslist, filename, argstring):
    if filename != "-":
        with open(filename, "w") as file:
            file.write(wave.gcode())
    return filename
