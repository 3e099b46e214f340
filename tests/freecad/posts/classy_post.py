"""A post as they are from FreeCAD 1.0 on: a class that reads the arguments of its job."""

import argparse
import pathlib
import shlex
import sys

from Path.Post.Processor import PostProcessor

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import wave_program as wave  # noqa: E402
sys.path.pop(0)


class Classy(PostProcessor):
    def __init__(self, job):
        super().__init__(job, tooltip="", tooltipargs="", units="G21")
        self.parser = argparse.ArgumentParser(prog="classy", add_help=False)
        self.parser.add_argument("--precision", type=int, default=3)

    @property
    def tooltip(self):
        return "writes a wave"

    def export(self):
        args = self.parser.parse_args(shlex.split(self._job.PostProcessorArgs))
        chosen = self._operations if self._operations is not None else ["all"]
        return [(part, f"({part}: {' '.join(chosen)})\n" + wave.gcode(places=args.precision))
                for part, _ in self._buildPostList()]
