"""A post as grbl, rrf and marlin of 0.20 are: writes its file, even one named "-", returns nothing."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import wave_program as wave  # noqa: E402
sys.path.pop(0)


def export(objectslist, filename, argstring):
    with open(filename, "w") as file:
        file.write(wave.gcode())
