#!/usr/bin/python3
"""filter_check.py BATTEN ROOT   Batten as a filter program, run by the installed LinuxCNC's own code.

The [FILTER] section is the one that docs/linuxcnc_filter.md shows, read by LinuxCNC's own INI reader.
Programs: ROOT/samples, and those of the folder that BATTEN_CORPUS names, up to MOST_BYTES each.
Exits with 77 where LinuxCNC is not installed."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import installed_filters

SKIPPED = 77
TOLERANCE = "0.01"      # mm, as on the page
MOST_BYTES = 400_000    # larger programs are the corpus test's
wrong = []


def expect(truth, what, *details):
    if not truth:
        wrong.append(what)
        print("WRONG:", what, *(str(d)[:500] for d in details))


def rs274_accepts(program, folder):
    (folder / "tool.tbl").write_text("".join(f"T{i} P{i} D0.2 Z0\n" for i in range(1, 10)))
    (folder / "parameters.var").write_text("")
    # Its exit code is 0 even after some errors.
    done = subprocess.run(["rs274", "-g", "-n", "2", "-t", "tool.tbl", "-v", "parameters.var",
                           program.name], cwd=folder, env={**os.environ, "HOME": str(folder)},
                          stdin=subprocess.DEVNULL, capture_output=True)
    told = [line for line in done.stderr.splitlines() if line.strip() != b"executing"]
    return done.returncode == 0 and not told


class Check:
    def __init__(self, batten, root, folder):
        self.batten, self.folder = batten, folder
        self.ini = installed_filters.ini_of_the_page(root, batten, folder)
        self.rewritten = 0

    def ask(self, call, program):
        name = call.__name__
        result = self.folder / f"{name}-result.ngc"
        return name, result, call(self.ini, program, result)

    def put(self, name, data):
        program = self.folder / name
        program.write_bytes(data)
        return program

    def good(self, source, call=installed_filters.axis_call):
        program = self.put("it's a part." + "ngc", source.read_bytes())
        name, result, done = self.ask(call, program)
        what = f"{source.parent.name}/{source.name} by {name}"
        expect(done.exit_code == 0 and done.loaded, f"{what}: loaded", done.messages)
        shown = done.progress or done.looks < 2
        expect(shown and all(percent <= 100 for percent in done.progress)
               and done.progress == sorted(set(done.progress)), f"{what}: progress goes up",
               (done.progress, done.looks))
        same = done.text == program.read_bytes()
        self.rewritten += not same
        verified = subprocess.run([self.batten, "verify", program, result, "--tolerance",
                                   TOLERANCE, "--units", "mm"], capture_output=True)
        expect(verified.returncode == 0, f"{what}: proved", verified.stderr)
        if rs274_accepts(program, self.folder):
            expect(rs274_accepts(result, self.folder), f"{what}: taken by rs274")
        print(f"{what}: {'as it was' if same else 'rewritten'}, "
              f"{program.stat().st_size} -> {len(done.text)} bytes")
        return done

    def refused(self, name, data, message):
        """Nothing is loaded, and the dialog says why."""
        for call in (installed_filters.axis_call, installed_filters.qtvcp_call):
            way, _, done = self.ask(call, self.put(name, data))
            expect(done.exit_code == 2 and not done.loaded, f"{name!r} is refused by {way}")
            expect(message in done.messages, f"{name!r}: {way} says why", done.messages)
            expect("FILTER_PROGRESS" not in done.messages, f"{way}: only messages in the dialog")
            expect(done.text == b"", f"{name!r}: nothing on standard output")


def programs(root):
    named = os.environ.get("BATTEN_CORPUS")
    found = sorted((root / "samples").glob("*/*.ngc"))
    if named:
        found += sorted(f for f in pathlib.Path(named).rglob("*")
                        if f.suffix in (".ngc", ".nc", ".tap"))
    return [f for f in found if f.stat().st_size <= MOST_BYTES]


def main(batten, root):
    why = installed_filters.missing() or ("" if shutil.which("rs274") else "no rs274")
    if why:
        print("LinuxCNC is not installed:", why)
        return SKIPPED
    with tempfile.TemporaryDirectory(prefix="batten-filter-") as folder:
        check = Check(batten, root, pathlib.Path(folder))
        sources = programs(root)
        for source in sources:
            check.good(source)
        expect(check.rewritten >= 5, "samples are rewritten", check.rewritten)
        one = root / "samples/noisy_line_arc/program.ngc"
        by_axis, by_qtvcp = check.good(one), check.good(one, installed_filters.qtvcp_call)
        expect(by_axis.text == by_qtvcp.text, "AXIS and QtVCP get the same program")
        subprocess.run([sys.executable, "-B", root / "tests/bench/make_large_programs.py", folder,
                        "raster3d", "--blocks", "50000"], check=True, capture_output=True)
        long = next(pathlib.Path(folder).glob("raster3d*"))
        expect(check.good(long, installed_filters.qtvcp_call).progress, "QtVCP shows progress")
        check.refused("klartext.ngc", b"BEGIN PGM 1 MM\nL X+1 Y+2\nEND PGM 1 MM\n",
                      "foreign-language")
        latin1 = os.fsdecode(b"Fr\xe4sen.ngc")
        check.refused(latin1, b"BEGIN PGM 1 MM\nL X+1 Y+2\nEND PGM 1 MM\n", "foreign-language")
    print(f"{len(sources)} programs, {check.rewritten} rewritten, {len(wrong)} wrong")
    return 1 if wrong else 0


if len(sys.argv) != 3:
    sys.exit(__doc__)
sys.exit(main(str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()))
