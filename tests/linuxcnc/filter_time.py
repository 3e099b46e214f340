#!/usr/bin/python3
"""filter_time.py BATTEN ROOT --bench DIR [--feed 15000] [--modes "G61;G64 P0.01 Q0;G64 P0.01"] FILE...

What the filter is worth on LinuxCNC itself: each program is loaded as it is, and as AXIS loads it with
the INI section of docs/linuxcnc_filter.md; both run on a headless LinuxCNC. A Markdown table of blocks,
seconds, and how far the commanded path is from the old program (mm; that is the control's blending too).

  --bench   folder of the bench, with lcnc_time.sh (FILE --json --ref OLD); needs root
  --feed    mm/min; stands for the first F word that is a line of its own
  --modes   path modes; each stands for the program's G64 or G61 line
  --vmax, --amax   limits of every axis, mm/s and mm/s2 (400, 4000)

Exits with 77 where LinuxCNC or the bench is not installed, 1 where a program is refused."""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import installed_filters

SKIPPED = 77
BLOCK = re.compile(r"(?mi)^(N\d+ *)?[GXYZ]")


def with_mode(text, mode, feed):
    text = re.sub(r"(?mi)^G6[14].*$", mode, text, count=1)
    return re.sub(r"(?mi)^F[0-9.]+$", f"F{feed:g}", text, count=1)


def measured(options, program, old):
    done = subprocess.run(["sh", options.bench / "lcnc_time.sh", program, "--json", "--ref", old,
                           "--vmax", str(options.vmax), "--amax", str(options.amax)],
                          capture_output=True, text=True)
    try:
        return json.loads(done.stdout)
    except ValueError:
        raise RuntimeError(f"{program}: {(done.stderr or done.stdout).strip()[-300:]}") from None


def row(options, ini, folder, source, mode):
    old, new = folder / "old.ngc", folder / "new.ngc"
    old.write_text(with_mode(source.read_text(), mode, options.feed))
    done = installed_filters.axis_call(ini, old, new)
    if not done.loaded:
        raise RuntimeError(f"{source}: refused: {done.messages}")
    figures = [(len(BLOCK.findall(each.read_text())), measured(options, each, old))
               for each in (old, new)]
    (blocks, before), (blocks_now, now) = figures
    change = 100 * (now["cycle_s"] / before["cycle_s"] - 1)
    return (f"| {source.stem} | {mode} | {blocks} -> {blocks_now} | {before['cycle_s']:.3f} -> "
            f"{now['cycle_s']:.3f} | {change:+.1f} % | {before['dev_max']:.4f} -> {now['dev_max']:.4f} |")


def main():
    words = argparse.ArgumentParser(description=__doc__,
                                    formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("batten", type=lambda name: str(pathlib.Path(name).resolve()))
    words.add_argument("root", type=pathlib.Path)
    words.add_argument("files", type=pathlib.Path, nargs="+")
    words.add_argument("--bench", type=pathlib.Path, required=True)
    words.add_argument("--feed", type=float, default=15000)
    words.add_argument("--modes", default="G61;G64 P0.01 Q0;G64 P0.01")
    words.add_argument("--vmax", type=float, default=400)
    words.add_argument("--amax", type=float, default=4000)
    options = words.parse_args()
    why = installed_filters.missing() or ("" if (options.bench / "lcnc_time.sh").exists() else "no bench")
    if why:
        print("not to be measured here:", why)
        return SKIPPED
    print("| program | mode | blocks | cycle s | | off the old program, mm |\n|---|---|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory(prefix="batten-filter-time-") as folder:
        ini = installed_filters.ini_of_the_page(options.root.resolve(), options.batten,
                                                pathlib.Path(folder))
        for source in options.files:
            for mode in options.modes.split(";"):
                print(row(options, ini, pathlib.Path(folder), source, mode), flush=True)
    return 0


try:
    sys.exit(main())
except RuntimeError as trouble:
    sys.exit(str(trouble))
