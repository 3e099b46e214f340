"""The code by which an installed LinuxCNC runs a filter program, taken out of its own files and run
as it stands there; only windows, clocks and the status channel around it are ours.

Two ways: `axis_call` is AXIS, `qtvcp_call` is QtVCP. Each returns a Filtered."""

import ast
import dataclasses
import os
import pathlib
import re
import select
import subprocess
import sys
import time

AXIS = pathlib.Path("/usr/bin/axis")
QTVCP = pathlib.Path("/usr/lib/python3/dist-packages/qtvcp/qt_action.py")
TICK = 0.1  # s, between two looks of QtVCP at the filter


@dataclasses.dataclass
class Filtered:
    exit_code: int
    text: bytes = b""
    messages: str = ""  # what the user would read in the dialog after an exit code other than 0
    progress: list = dataclasses.field(default_factory=list)
    loaded: bool = False
    looks: int = 2  # QtVCP's, one each TICK; a filter that is done before the second shows nothing


def definitions(file, names, space):
    """Runs the top-level definitions of these names of a Python file in `space`."""
    found = [node for node in ast.parse(file.read_text()).body
             if getattr(node, "name", None) in names
             or isinstance(node, ast.Assign) and getattr(node.targets[0], "id", None) in names]
    if len(found) != len(names):
        raise LookupError(f"{file}: not all of {names}")
    exec(compile(ast.Module(found, []), str(file), "exec"), space)
    return space


class Shown:
    """Stands for the progress bar."""

    def __init__(self, seen):
        self.seen = seen

    def update(self, count, _=0):
        self.seen.append(count)

    def set_text(self, _):
        pass

    def done(self):
        pass


class Quiet:
    """Stands for the terminal that the window was started from, and for the window itself."""

    def write(self, _):
        pass

    def update(self):
        pass


def system(seen):
    quiet_sys = type("sys", (), {"stderr": Quiet()})
    return {"os": os, "re": re, "select": select, "subprocess": subprocess, "sys": quiet_sys,
            "_": str, "t": Quiet(), "Progress": lambda *_: Shown(seen)}


def ini_of_the_page(root, batten, folder):
    """The [FILTER] section that docs/linuxcnc_filter.md shows, with this program, as LinuxCNC reads it."""
    import linuxcnc
    page = (root / "docs/linuxcnc_filter.md").read_text()
    text = next(b for b in re.findall(r"```ini\n(.*?)```", page, re.DOTALL) if "[FILTER]" in b)
    if "/usr/bin/batten" not in text:
        raise LookupError("the page does not name the program with its full path")
    file = folder / "machine.ini"
    file.write_text(text.replace("/usr/bin/batten", batten))
    return linuxcnc.ini(str(file))


def axis_filter_for(ini, program):
    space = definitions(AXIS, ["get_filter"], {"os": os, "inifile": ini})
    return space["get_filter"](str(program))


def axis_call(ini, program, result):
    seen = []
    space = definitions(AXIS, ["progress_re", "filter_program"], system(seen))
    code, messages = space["filter_program"](axis_filter_for(ini, program), str(program),
                                             str(result))
    return Filtered(code, result.read_bytes(), messages, seen, code == 0)


def qtvcp_call(ini, program, result):
    seen, ticks, loaded = [], [], []

    class Status:
        def connect(self, _, call):
            ticks.append(call)
            return 0

        def disconnect(self, _):
            ticks.clear()

    space = system(seen) | {"STATUS": Status()}
    definitions(QTVCP, ["progress_re", "FilterProgram"], space)
    told = Filtered(0)

    class WithoutDialog(space["FilterProgram"]):
        def error(self, exitcode, stderr):
            told.exit_code, told.messages = exitcode, stderr

    WithoutDialog(axis_filter_for(ini, program), str(program), str(result),
                  lambda code: code or loaded.append(True))
    told.looks = 0
    while ticks:
        time.sleep(TICK)
        told.looks += 1
        ticks[0](None)
    told.text, told.progress, told.loaded = result.read_bytes(), seen, bool(loaded)
    return told


def missing():
    """Why this LinuxCNC cannot be asked; empty when it can."""
    for file in (AXIS, QTVCP):
        if not file.exists():
            return f"no {file}"
    try:
        import linuxcnc  # noqa: F401
    except ImportError:
        return f"no module linuxcnc in {sys.executable}"
    return ""
