#!/usr/bin/env python3
"""check.py BATTEN ROOT [KEPT]: is every JSON report what docs/report.schema.json says?

Runs every command over the samples and over programs that it cannot do, and checks all that they write; and the
reports that the tests of the command line have left in the folder KEPT, which it then removes (those older than
BATTEN unread). The schema lets no field pass that it does not name, so that it is the whole truth: what checks a
report with an unknown, missing or wrong field is checked first. Ends with 77 where Python's jsonschema is missing.
"""

import copy
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("skipped: no python3-jsonschema here")
    sys.exit(77)

# Of `part.nc`, which any command can do, and others; each with --json -.
COMMANDS = """
smooth part.nc -t linuxcnc --dry-run
smooth part.nc -t linuxcnc --dry-run --tolerance-kind band --method best
smooth part.nc -t linuxcnc --dry-run --side left --tolerance 0.0005in --keep-corners 20
smooth part.nc -t fanuc --dry-run --output curves --decimals explicit
smooth part.nc -t linuxcnc --dry-run --tolerance 2 --strict
smooth part.nc --profile mine.toml --dry-run
smooth part.nc --config options.toml --dry-run
smooth part.nc -t itnc530 --convert --dry-run
smooth part.nc -t grbl --dry-run --drop G64
smooth words.nc -t linuxcnc --dry-run --word "M501 = keeps state"
smooth part.nc -t linuxcnc --tolerance wide
smooth open.nc -t grbl
smooth none.nc -t grbl
smooth calls.nc -t linuxcnc --dry-run
explore part.nc -t grbl --tolerance 0.01 --output lines
explore open.nc -t grbl
verify part.nc part.nc
verify part.nc other.nc
verify part.nc other.nc --drop G64
verify calls.nc other.nc
inspect calls.nc
time calls.nc --machine mill
verify part.nc part.nc --word "M501 = keeps state" --tolerance-kind band
verify open.nc part.nc
inspect part.nc
inspect words.nc
inspect open.nc
inspect words.nc --word "M501 = keeps state"
time part.nc --machine mill
time words.nc --machine router --target grbl
time part.nc --machine nothing
time none.nc --machine mill
setup -t grbl -o kept.toml
setup -t grbl -o part.nc
freecad install --folder .
freecad uninstall --folder .
freecad uninstall --folder .
freecad
targets
targets --show grbl
machines
machines --show mill
machines --show nothing
methods
explain
nonsense
""".strip().splitlines()


def wave():
    lines = ["G21 G90 G17 G94", "T1 M6", "S8000 M3", "G0 X0 Y0 Z5", "G1 Z-1 F300"]
    for i in range(1, 121):
        lines.append(f"X{i / 5:.1f} Y{(i % 20 if i % 40 < 20 else 20 - i % 20) / 10:.1f} F2000")
    return "\n".join([*lines, "G4 P0.5", "G0 Z5", "M2", ""])


def put_programs(folder):
    (folder / "part.nc").write_text(wave())
    (folder / "other.nc").write_text(wave().replace("X12.0", "X12.5"))
    (folder / "words.nc").write_text(wave().replace("X12.0", "M501\nX12.0").replace("X20.0", "G41 D1\nX20.0"))
    (folder / "calls.nc").write_text(wave().replace("X12.0", "O<part> call\nM98 P1234\nX12.0"))
    (folder / "O1234.nc").write_text("O1234\nG0 Z9.\nM99\n")
    (folder / "open.nc").write_text(wave().replace("G21 ", ""))
    (folder / "mine.toml").write_text('based-on = "linuxcnc"\n[words]\nheader = ["(smoothed)"]\n')
    (folder / "options.toml").write_text('target = "linuxcnc"\ntolerance = 0.02\n')


class Checked:
    """All reports that were found, and what is wrong with them."""

    def __init__(self, schema):
        jsonschema.Draft202012Validator.check_schema(schema)
        self.validator = jsonschema.Draft202012Validator(schema)
        self.by_kind = {}
        self.failures = []

    def problems(self, report):
        """The innermost ones, with their places."""
        found = []
        for error in self.validator.iter_errors(report):
            while error.context:
                error = min(error.context, key=lambda each: -len(each.absolute_path))
            place = "/".join(map(str, error.absolute_path))
            found.append(f"{place or 'the report'}: {error.message[:300]}")
        return found

    def check(self, text, where):
        report = json.loads(text)
        self.by_kind.setdefault(report.get("kind"), []).append(report)
        self.failures += [f"{where}: {problem}" for problem in self.problems(report)]


def places(value, path=()):
    """Of all objects in it, but those whose fields are names of options."""
    if isinstance(value, dict):
        if path[-1:] != ("options_from",):
            yield path
        for key, each in value.items():
            yield from places(each, (*path, key))
    elif isinstance(value, list):
        for i, each in enumerate(value[:1]):
            yield from places(each, (*path, i))


def at(report, path):
    for step in path:
        report = report[step]
    return report


def unnoticed_damage(checked):
    """Planted in one report of each kind: a field more in each object, one less, one of another type."""
    for kind, reports in checked.by_kind.items():
        report = max(reports, key=lambda each: len(json.dumps(each)))
        for path in places(report):
            damaged = copy.deepcopy(report)
            at(damaged, path)["more"] = 1
            if not checked.problems(damaged):
                yield f"{kind}: a field more in {path or 'the report'}"
        for name in report:
            damaged = copy.deepcopy(report)
            del damaged[name]
            if name not in ("profile", "dropped", "called") and not checked.problems(damaged):
                yield f"{kind}: {name} is missing"
            damaged[name] = {"of": "another type"} if not isinstance(report[name], dict) else "text"
            if not checked.problems(damaged):
                yield f"{kind}: {name} has another type"


def run_all(batten, root, folder, checked):
    put_programs(folder)

    def run(words, where):
        done = subprocess.run([batten, *words, "--json", "-"], cwd=folder, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=False, env={"HOME": str(folder / "home")})
        if not done.stdout.startswith("{"):
            checked.failures.append(f"{where}: no JSON, exit code {done.returncode}: {done.stderr[:200]}")
            return
        checked.check(done.stdout, where)
        if json.loads(done.stdout).get("exit_code") != done.returncode:
            checked.failures.append(f"{where}: exit code {done.returncode}, not the one in the report")

    for command in COMMANDS:
        run(shlex.split(command), command)
    tree = folder / "tree"
    for sample in sorted((root / "samples").glob("*/program.ngc")):
        name = sample.parent.name
        (tree / name).mkdir(parents=True)
        (tree / name / "program.nc").write_bytes(sample.read_bytes())
        words = shlex.split((sample.parent / "command").read_text().replace("\\\n", " "))
        run(["smooth", str(sample), "--dry-run", *words[3:]], f"sample {name}")
        run(["inspect", str(sample)], f"inspect {name}")
    (tree / "open.nc").write_bytes((folder / "open.nc").read_bytes())
    run(["batch", "tree", "out", "-t", "linuxcnc", "--jobs", "2"], "batch")
    batch = folder / "out" / "batten-batch"
    for file in [batch / "summary.json", *sorted((batch / "reports").rglob("*.json"))]:
        checked.check(file.read_text(), file.relative_to(folder))


def main():
    batten, root = (pathlib.Path(each).resolve() for each in sys.argv[1:3])
    checked = Checked(json.loads((root / "docs" / "report.schema.json").read_text()))
    with tempfile.TemporaryDirectory() as folder:
        run_all(batten, root, pathlib.Path(folder), checked)
    own = sum(map(len, checked.by_kind.values()))
    missed = [] if checked.failures else list(unnoticed_damage(checked))
    kept = 0
    for file in sorted(pathlib.Path(sys.argv[3]).glob("*.json")) if len(sys.argv) > 3 else []:
        if file.stat().st_mtime > batten.stat().st_mtime:
            checked.check(file.read_text(), f"a report of the tests, {file.name}")
            kept += 1
        file.unlink()
    for problem in [*checked.failures[:40], *(f"the schema lets pass: {each}" for each in missed)]:
        print(problem)
    kinds = set(checked.validator.schema["$defs"]["kinds"]["enum"])
    for kind in sorted(kinds ^ set(checked.by_kind), key=str):
        print(f"{kind}: no report of this kind was seen, or the schema has none")
    print(f"{own} reports, and {kept} of the tests")
    return 1 if checked.failures or missed or kinds ^ set(checked.by_kind) else 0


if __name__ == "__main__":
    sys.exit(main())
