"""The program that the posts of the tests write: a wave in short lines."""

import math


def gcode(units="G21", end="\n", places=3):
    lines = [f"{units} G90 G17", "G0 X0 Y0 Z5", "G1 Z-1 F300"]
    for i in range(1, 201):
        x = i * 0.25
        lines.append(f"G1 X{x:.{places}f} Y{4 * math.sin(x / 8):.{places}f} F1200")
    return end.join(lines + ["G0 Z5", "M2", ""])
