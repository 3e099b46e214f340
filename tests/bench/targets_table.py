#!/usr/bin/env python3
"""targets_table.py BATTEN FOLDER [--targets a,b,..] [--forms auto,arcs,lines] [--tolerance 0.01]
                    [--largest BYTES] [--convert] [--via TARGET] [--allow a,b,..] [--json FILE]

Every program of FOLDER smoothed for some targets in each form: a table of blocks and bytes by target
and form. Each result is verified once more by `batten verify`. Exits with 1 when one is not proved.
With --via each program is first converted for that target, unsmoothed, and the table is about those
that it takes.
Why programs were refused stands behind the table, with their first block that cannot be said.
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "corpus"))
import programs

TARGETS = "fanuc,siemens,itnc530,grbl,linuxcnc,haas"
FORMS = "auto,curves,arcs,lines"
HANGS = 900  # seconds, for programs of some megabytes


def read_options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("batten")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--targets", default=TARGETS)
    parser.add_argument("--forms", default=FORMS)
    parser.add_argument("--tolerance", default="0.01")
    parser.add_argument("--largest", type=int, default=1 << 20, help="bytes; larger ones are left out")
    parser.add_argument("--convert", action="store_true",
                        help="programs of other families too, where every block can be said")
    parser.add_argument("--via", help="the target for which programs are converted first")
    parser.add_argument("--allow", default="", help="reason ids, as for batten smooth")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--json", help="all rows, one per program, target and form")
    return parser.parse_args()


def programs_in(folder, largest):
    for file in programs.programs_in(folder):
        data = programs.bytes_of(file)
        if len(data) <= largest:
            yield file.name, data


def run(options, command, folder, *arguments):
    return subprocess.run([options.batten, command, *arguments, "--tolerance", options.tolerance],
                          cwd=folder, capture_output=True, timeout=HANGS)


def allowances(options):
    return [f"--allow={reason}" for reason in options.allow.split(",") if reason]


# The program for the target of --via; nothing where it is not taken there, or is one already.
def converted(options, data):
    with tempfile.TemporaryDirectory(prefix="batten-targets-") as folder:
        folder = pathlib.Path(folder)
        (folder / "old.nc").write_bytes(data)
        done = run(options, "smooth", folder, "old.nc", "-o", "new.nc", "--target", options.via,
                   "--method", "none", "--convert", *allowances(options))
        new = (folder / "new.nc").read_bytes() if done.returncode == 0 else data
        return new if new != data else None


def row_of(options, name, data, target, form):
    with tempfile.TemporaryDirectory(prefix="batten-targets-") as folder:
        folder = pathlib.Path(folder)
        (folder / "old.nc").write_bytes(data)
        done = run(options, "smooth", folder, "old.nc", "-o", "new.nc", "--target", target,
                   "--output", form, "--threads", "1", "--json", "report.json",
                   *(["--convert"] if options.convert else []),
                   *allowances(options))
        row = {"program": name, "target": target, "form": form, "exit": done.returncode}
        if done.returncode == 2:
            errors = [line for line in done.stderr.decode(errors="replace").splitlines()
                      if ": error: " in line]
            row["refused"] = errors[0].split(": error: ")[1].split(":")[0] if errors else "?"
            row["told"] = errors[0].removeprefix("old.nc:") if errors else "?"
            row["errors"] = len(errors)
            return row
        if done.returncode == 1 and b"; possible: " in done.stderr:
            return row | {"refused": "no such form", "told": "no such form", "errors": 1}
        if done.returncode != 0:
            row["wrong"] = done.stderr.decode(errors="replace")[-300:]
            return row
        report = json.loads((folder / "report.json").read_text())
        new = (folder / "new.nc").read_bytes()
        row |= {"blocks_in": report["input"]["blocks"], "blocks_out": report["output"]["blocks"],
                "bytes_in": len(data), "bytes_out": len(new),
                "rewritten": sum(r["status"] == "rewritten" for r in report["runs"]),
                "deviation_mm": report["deviation_mm"]}
        proof = run(options, "verify", folder, "old.nc", "new.nc", "--target", target)
        # Programs that are not understood come out as they were.
        same = new == data
        if not same and (proof.returncode != 0 or report["proved"] is not True):
            row["wrong"] = "not proved: " + proof.stderr.decode(errors="replace")[-300:]
        return row


def summed(rows, target, form):
    mine = [r for r in rows if r["target"] == target and r["form"] == form]
    done = [r for r in mine if "blocks_in" in r]
    smoothed = [r for r in done if r["rewritten"]]
    total = lambda key: sum(r[key] for r in smoothed)
    return {"target": target, "form": form, "programs": len(mine), "refused": len(mine) - len(done),
            "smoothed": len(smoothed), "blocks_in": total("blocks_in"),
            "blocks_out": total("blocks_out"), "bytes_in": total("bytes_in"),
            "bytes_out": total("bytes_out"), "wrong": sum("wrong" in r for r in mine)}


def main(options):
    options.batten = str(pathlib.Path(options.batten).resolve())  # runs in folders of its own
    chosen = list(programs_in(options.folder, options.largest))
    if options.via:
        print(f"{len(chosen)} programs", end=", ")
        chosen = [(name, converted(options, data)) for name, data in chosen]
        chosen = [(name, data) for name, data in chosen if data is not None]
        print(f"{len(chosen)} of them converted for {options.via}")
    if not chosen:
        print("no programs")
        return 77
    work = [(name, data, target, form) for name, data in chosen
            for target in options.targets.split(",") for form in options.forms.split(",")]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        rows = list(pool.map(lambda one: row_of(options, *one), work))
    if options.json:
        pathlib.Path(options.json).write_text(json.dumps(rows, indent=1))
    print("| target | form | programs | refused | smoothed | blocks | | bytes | | not proved |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for target in options.targets.split(","):
        for form in options.forms.split(","):
            s = summed(rows, target, form)
            part = lambda key: (f"{s[key + '_out'] / s[key + '_in']:.0%}" if s[key + "_in"] else "-")
            print(f"| {target} | {form} | {s['programs']} | {s['refused']} | {s['smoothed']} "
                  f"| {s['blocks_in']} -> {s['blocks_out']} | {part('blocks')} "
                  f"| {s['bytes_in']} -> {s['bytes_out']} | {part('bytes')} | {s['wrong']} |")
    for row in rows:
        if "wrong" in row:
            print(f"{row['program']} for {row['target']}, {row['form']}: {row['wrong']}",
                  file=sys.stderr)
    refusals = {}
    for row in rows:
        if "refused" in row:
            key = (row["target"], row["refused"])
            refusals.setdefault(key, set()).add(row["program"])
    for (target, why), names in sorted(refusals.items()):
        print(f"{target}: {why}: {len(names)} programs", file=sys.stderr)
    told = {(row["target"], row["program"]): row for row in rows if "refused" in row}
    for (target, program), row in sorted(told.items()):
        print(f"{target}: {program}: {row['errors']} errors, the first: {row['told']}", file=sys.stderr)
    return 1 if any("wrong" in row for row in rows) else 0


sys.exit(main(read_options()))
