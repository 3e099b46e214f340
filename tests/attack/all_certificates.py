#!/usr/bin/env python3
"""all_certificates.py BATTEN FOLDER.. [--most-lines 20000] [--targets linuxcnc,grbl,fanuc,siemens,heidenhain] [--jobs 1]

Is everything that Batten rewrites certified by the checker that needs no Batten? Every program below
the folders is smoothed for each target in each form that it has, at 0.01 mm, and checked with
tools/check_certificate.py. Of longer programs the first --most-lines lines are taken. Programs that
are in no language of the target are refused by Batten and are counted as such.

Prints how many were certified for each target and form, and each that was not with the reason; exits
with 1 where there was one, or a certificate larger than the new program."""

import argparse
import collections
import concurrent.futures
import contextlib
import io
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import check_certificate  # noqa: E402

TOLERANCE = "0.01"
FORMS = {"linuxcnc": ["auto", "arcs", "lines", "curves"], "grbl": ["auto", "arcs", "lines"],
         "fanuc": ["auto", "arcs", "lines", "curves"], "siemens": ["auto", "arcs", "lines", "curves"],
         "heidenhain": ["auto", "arcs", "lines"]}
SUFFIXES = {".ngc", ".nc", ".tap", ".gcode", ".mpf", ".eia", ".h", ".txt", ".cnc"}


def one(batten, path, target, most_lines):
    """For each form: (form, what came of it, reason)."""
    results = []
    with tempfile.TemporaryDirectory() as folder:
        old, new, proof = (pathlib.Path(folder, name) for name in ("old.nc", "new.nc", "new.cert"))
        lines = path.read_bytes().split(b"\n")
        old.write_bytes(path.read_bytes() if len(lines) <= most_lines else b"\n".join(lines[:most_lines]) + b"\n")
        units = []
        for form in FORMS[target]:
            command = [batten, "smooth", old, "-o", new, "--certificate", proof, "--force", "--quiet", "--threads", "1",
                       "--target", target, "--tolerance", TOLERANCE, "--output", form]
            ran = subprocess.run([*map(str, command), *units], capture_output=True, text=True, errors="replace")
            if ran.returncode == 2 and "--units" in ran.stderr and not units:
                units = ["--units", "mm"]
                ran = subprocess.run([*map(str, command), *units], capture_output=True, text=True, errors="replace")
            if ran.returncode == 2:
                return [(form, "refused", "") for form in FORMS[target]]
            if ran.returncode != 0:
                results.append((form, "failed", ran.stderr[-200:].strip()))
            elif new.read_bytes() == old.read_bytes():
                results.append((form, "unchanged", ""))
            else:
                results.append((form, *checked(old, new, proof, target, units)))
    return results


def checked(old, new, proof, target, units):
    if not proof.exists():
        return "no certificate", ""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        code = check_certificate.main([str(old), str(new), str(proof), "--control", target, "--tolerance", TOLERANCE, *units])
    if code != 0:
        return "not certified", said.getvalue().split("\n")[1].strip()
    if proof.stat().st_size > new.stat().st_size:
        return "certificate too large", f"{proof.stat().st_size} bytes, program {new.stat().st_size}"
    return "certified", ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("folders", type=pathlib.Path, nargs="+")
    parser.add_argument("--most-lines", type=int, default=20000)
    parser.add_argument("--targets", type=lambda text: text.split(","), default=list(FORMS))
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    paths = [p for folder in options.folders for p in sorted(folder.rglob("*"))
             if p.suffix.lower() in SUFFIXES and p.is_file()]
    counts, wrong = collections.Counter(), 0
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as workers:
        jobs = {(path, target): workers.submit(one, options.batten.resolve(), path, target, options.most_lines)
                for path in paths for target in options.targets}
        for (path, target), job in jobs.items():
            for form, what, why in job.result():
                counts[target, form, what] += 1
                if what not in ("certified", "unchanged", "refused"):
                    wrong += 1
                    print(f"{path.parent.name}/{path.name} {target} {form}: {what}: {why}", flush=True)
    whats = sorted({what for _, _, what in counts})
    print(f"{len(paths)} programs\n| target | form | " + " | ".join(whats) + " |\n" + "|---" * (len(whats) + 2) + "|")
    for target in options.targets:
        for form in FORMS[target]:
            print(f"| {target} | {form} | " + " | ".join(str(counts[target, form, what]) for what in whats) + " |")
    print(f"{wrong} not certified")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
