#!/usr/bin/env python3
"""compare_with_linuxcnc.py [--bench DIR] [--batten PATH] [--corpus DIR] [FILE...]

Predicted against measured times of whole programs on the real LinuxCNC, as Markdown tables:
seconds predicted / measured and the difference in per cent, a row for each program.

Predicted is the time_s of `batten time`, measured the cycle time of the bench's lcnc_time.sh:
cuts, rapids and dwells, from the first motion to the last. Every program runs in every path mode
(its own G61 and G64 words are replaced) under every pair of limits.

  --bench    the folder of the headless LinuxCNC bench (lcnc_time.sh, samples/); default: the
             environment's LINUXCNC_BENCH
  --batten   the program; default: the environment's BATTEN, or the newest in build/*/batten
  --corpus   a folder of more programs; default: the environment's BATTEN_CORPUS; may be missing
  --feeds    each program at these multiples of its feeds, as 1,4,10; default: as it is
  --modes    path modes, as 'G61;G64 P0.01'; `own`: the words of the program
  --smooth   also the programs that `batten smooth` makes of these files; default: some of the
             bench's samples. --smooth none: no such rows
  FILE       programs in place of the default ones

  --recorded take the measured times of the bench's samples from its results.tsv (two feeds, 400
             mm/s, 4000 mm/s2) instead of running LinuxCNC, which need not be there then

The measured times are kept in --cache FILE (JSON, by the bytes of the program, mode and limits), so
that a second call only predicts.

Exit status 1 when fewer than 90 % of the differences are within 4 % or one is above 10 %, or with
--within PERCENT when one is above that. A program that LinuxCNC refuses, or that `batten time` says
to have timed in part only, is left out and said. 77
when the bench or LinuxCNC is not there, so that a test can skip."""
import argparse
import csv
import glob
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
SKIP = 77
MODES = ["G61", "G64", "G64 P0.01 Q0", "G64 P0.01", "G64 P0.05"]
LIMITS = [(400, 4000), (120, 900), (120, 900, 25)]  # mm/s, mm/s2, mm/s of Z where it is slower
RECORDED_FEEDS = ["6000", "15000"]
# What `batten time` says that it does not time.
NOT_TIMED = ["program-flow", "spline", "foreign-words", "lathe-program", "state-unknown",
             "feed-unknown"]
TOOL_CHANGE_S = 0.25  # that the bench takes to answer
WITHIN, SHARE, ALL_WITHIN = 4.0, 0.9, 10.0  # per cent, share of the cases, per cent

# Of the bench's samples, at the feed they carry. Splines are not read as motions.
SAMPLES = ["butterfly_g1_cam", "butterfly_g1_noisy", "butterfly_arc_5um", "circle_g1_005",
           "wavy_g1_cam", "wavy_arc_g18"]
SMOOTHED = ["butterfly_g1_noisy", "wavy_g1_fine"]
# Of make_shapes.py: slots, helices, random chains, arcs that meet at small angles.
SHAPES = ["slots", "helix", "random_lines", "kinked_arcs"]
# Of a corpus: whole programs of CAM systems with rapids, tools, arcs, helices and drilling, of a
# minute or two.
CORPUS = ["freecad/profile_window_dogbone_linuxcnc.ngc", "freecad/profile_naca2412_linuxcnc_mm.ngc",
          "freecad/waterline_boss_dropcutter_linuxcnc.ngc",
          "freecad/holes_drill_helix_thread_linuxcnc.ngc", "generated/gcodetools_bezier_biarc.ngc"]

PATH_WORD = re.compile(r"(?i)G0*6(?:1(?:\.1)?|4)(?![.\d])((?:\s*[PQ]\s*[\d.]+)*)")


def newest_batten():
    found = glob.glob(os.path.join(ROOT, "build", "*", "batten"))
    return max(found, key=os.path.getmtime) if found else None


def with_feeds(text, multiple):
    """The program at so many times its feeds; comments stay as they are."""
    def faster(word):
        return "%s%.10g" % (word[1], float(word[2]) * multiple)
    if multiple == 1:
        return text
    parts = re.split(r"(\([^)\n]*\)|;[^\n]*)", text)
    return "".join(part if i % 2 else re.sub(r"(?i)(F\s*)([\d.]+)", faster, part)
                   for i, part in enumerate(parts))


def with_mode(text, mode):
    """The program under one path mode, from its first line on, in millimetres."""
    if mode == "own":
        return text
    text = PATH_WORD.sub("", text)
    head, rest = re.match(r"(\s*%[^\n]*\n)?((?s:.*))", text).groups()
    return (head or "") + "G21 " + mode + "\n" + rest


def machine_file(folder, limits):
    name = os.path.join(folder, "machine_%s.toml" % "_".join("%g" % x for x in limits))
    with open(name, "w") as f:
        f.write('based-on = "linuxcnc"\nname = "bench"\nmax-velocity = %g\nmax-acceleration = %g\n'
                'rapid-velocity = %g\npath-feed = %g\n' % (limits[:2] + limits[:1] * 2))
        f.write("blend-tolerance = 0.0254\nnaive-cam-tolerance = 0\n"  # as LinuxCNC starts
                "tool-change-time = %g\n" % TOOL_CHANGE_S)
        if limits[2:]:
            f.write("[axis.z]\nvelocity = %g\nrapid-velocity = %g\n" % (limits[2:] * 2))
    return name


class Bench:
    def __init__(self, args, folder):
        self.args = args
        self.folder = folder
        self.machines = {limits: machine_file(folder, limits) for limits in args.limits}
        self.cache = {}
        if args.cache and os.path.exists(args.cache):
            with open(args.cache) as f:
                self.cache = json.load(f)

    def key(self, text, limits):
        return hashlib.sha256(" ".join([text, *map(str, limits)]).encode()).hexdigest()

    def file_of(self, text, limits):
        name = os.path.join(self.folder, self.key(text, limits)[:24] + ".ngc")
        if not os.path.exists(name):
            part = "%s.%d" % (name, threading.get_ident())
            with open(part, "w", newline="") as f:
                f.write(text)
            os.replace(part, name)
        return name

    def predicted(self, text, limits):
        r = subprocess.run([self.args.batten, "time", self.file_of(text, limits), "--machine",
                            self.machines[limits], "--from", "0,0,0", "--units", "mm", "--json", "-"],
                           capture_output=True, text=True)
        if r.returncode:
            return {"error": r.stderr.strip()}
        return json.loads(r.stdout)

    def record(self, text, limits, cycle_s):
        self.cache[self.key(text, limits)] = {"cycle_s": cycle_s}

    def measured(self, text, limits):
        key = self.key(text, limits)
        if key not in self.cache:
            self.cache[key] = self.run_bench(self.file_of(text, limits), limits)
            self.keep()
        return self.cache[key]

    def run_bench(self, file, limits):
        command = [os.path.join(self.args.bench, "lcnc_time.sh"), file, "--json",
                   "--vmax", "%g" % limits[0], "--amax", "%g" % limits[1],
                   *(["--vz", "%g" % limits[2]] if limits[2:] else [])]
        try:
            r = subprocess.run(command, capture_output=True, text=True, timeout=self.args.patience)
            return json.loads(r.stdout)
        except subprocess.TimeoutExpired:  # as for G33 without a spindle that turns
            return {"errors": ["no end within %g s" % self.args.patience]}
        except ValueError:
            return {"errors": [(r.stderr or r.stdout).strip()[-300:]]}

    def keep(self):
        if not self.args.cache:
            return
        with open(self.args.cache + ".part", "w") as f:
            json.dump(dict(self.cache), f)
        os.replace(self.args.cache + ".part", self.args.cache)


def default_programs(args, folder):
    """Name and text of each program."""
    programs = []
    for name in SAMPLES:
        programs.append((name, os.path.join(args.bench, "samples", name + ".ngc")))
    subprocess.run([sys.executable, os.path.join(HERE, "make_shapes.py"),
                    os.path.join(folder, "shapes")], check=True)
    for name in SHAPES:
        programs.append((name, os.path.join(folder, "shapes", name + ".ngc")))
    if args.corpus:
        for name in CORPUS:
            programs.append((os.path.basename(name), os.path.join(args.corpus, name)))
    return [(name, read(file)) for name, file in programs if os.path.isfile(file)]


def read(file):
    with open(file, newline="", encoding="latin-1") as f:
        return f.read()


def recorded_programs(bench):
    """The bench's samples as its own table has them: name, text by mode."""
    programs = {}
    with open(os.path.join(bench.args.bench, "results.tsv")) as f:
        for row in csv.DictReader(f, delimiter="\t"):
            file = os.path.join(bench.args.bench, "samples", row["name"] + ".ngc")
            if row["errors"] or row["mode"] not in MODES or row["feed"] not in RECORDED_FEEDS:
                continue
            text = re.sub(r"(?m)^G64.*$", row["mode"], read(file), count=1)
            text = re.sub(r"(?m)^F[0-9.]+$", "F" + row["feed"], text, count=1)
            if re.search(r"(?m)^G5[. ]", text):
                continue  # splines are not read as motions
            bench.record(text, LIMITS[0], float(row["cycle_s"]))
            name = "%s, F%s" % (row["name"], row["feed"])
            programs.setdefault(name, {})[row["mode"]] = text
    return sorted(programs.items())


def smoothed_programs(args, folder):
    if args.smooth == ["none"]:
        return []
    files = args.smooth or [os.path.join(args.bench, "samples", n + ".ngc") for n in SMOOTHED]
    programs = []
    for file in files:
        out = os.path.join(folder, "smooth_" + os.path.basename(file))
        r = subprocess.run([args.batten, "smooth", file, "-o", out, "--target", "linuxcnc",
                            "--machine", "linuxcnc-fast", "--tolerance", "0.01", "--force"], capture_output=True, text=True)
        if r.returncode == 0:
            programs.append((os.path.splitext(os.path.basename(file))[0] + ", smoothed", read(out)))
        else:
            print("not smoothed: %s: %s" % (file, r.stderr.strip()[-200:]), file=sys.stderr)
    return programs


def cell(bench, text, limits, differences, left_out, name):
    guess = bench.predicted(text, limits)
    real = bench.measured(text, limits)
    # A message that the program itself shows is no error.
    errors = [e for e in real.get("errors", []) if e.strip() not in text]
    why = guess.get("error") or "; ".join(errors)
    if not why and not real["cycle_s"] > 0:
        why = "nothing moves"
    not_timed = [part for part in guess.get("not_timed", []) if part["id"] in NOT_TIMED]
    if not why and not_timed:
        why = "%s, line %d" % (not_timed[0]["text"], not_timed[0]["first_line"])
    if why:
        left_out.append("%s: %s" % (name, why))
        return "-"
    difference = 100 * (guess["time_s"] / real["cycle_s"] - 1)
    differences.append((abs(difference), name))
    return "%.3f / %.3f %+.1f" % (guess["time_s"], real["cycle_s"], difference)


def table(bench, programs, limits, pool, differences, left_out):
    slow_z = ", Z %g mm/s" % limits[2] if limits[2:] else ""
    print("\n%g mm/s and %g mm/s2 on every axis%s:\n" % (*limits[:2], slow_z))
    print("| program | " + " | ".join(bench.args.modes) + " |")
    print("|---" * (1 + len(bench.args.modes)) + "|", flush=True)
    rows = [(name, [pool.submit(cell, bench, texts[mode], limits, differences, left_out,
                                "%s, %s, %s" % (name, mode, "/".join("%g" % x for x in limits)))
                    for mode in bench.args.modes]) for name, texts in programs]
    for name, cells in rows:
        print("| %s | %s |" % (name, " | ".join(c.result() for c in cells)), flush=True)


def verdict(differences, all_within):
    differences.sort()
    sizes = [d for d, _ in differences]
    within = sum(d <= WITHIN for d in sizes) / len(sizes)
    print("\n%d times: %.1f %% of them within %g %%, greatest difference %.1f %% (%s), "
          "median %.2f %%" % (len(sizes), 100 * within, WITHIN, sizes[-1], differences[-1][1],
                              sizes[len(sizes) // 2]))
    if all_within:
        return 0 if sizes[-1] <= all_within else 1
    return 0 if within >= SHARE and sizes[-1] <= ALL_WITHIN else 1


def limits_of(text):
    return [tuple(float(x) for x in pair.split("/")) for pair in text.split(",")]


def main():
    p = argparse.ArgumentParser(description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("files", nargs="*")
    p.add_argument("--bench", default=os.environ.get("LINUXCNC_BENCH"))
    p.add_argument("--batten", default=os.environ.get("BATTEN") or newest_batten())
    p.add_argument("--corpus", default=os.environ.get("BATTEN_CORPUS"))
    p.add_argument("--smooth", action="append")
    p.add_argument("--modes", type=lambda t: t.split(";"), default=MODES)
    p.add_argument("--feeds", type=lambda t: [float(x) for x in t.split(",")], default=[1])
    p.add_argument("--limits", type=limits_of, default=LIMITS, help="as '400/4000,120/900/25'")
    p.add_argument("--recorded", action="store_true")
    p.add_argument("--cache")
    p.add_argument("--within", type=float, help="per cent, that no difference may be above")
    p.add_argument("--jobs", type=int, default=2)
    p.add_argument("--patience", type=float, default=600, help="seconds for one run of the bench")
    args = p.parse_intermixed_args()
    if not args.bench or not os.path.isfile(os.path.join(args.bench, "lcnc_time.sh")):
        print("no bench: --bench DIR or LINUXCNC_BENCH", file=sys.stderr)
        return SKIP
    if not args.recorded and not shutil.which("linuxcncsvr"):
        print("LinuxCNC is not installed", file=sys.stderr)
        return SKIP
    if not args.batten:
        print("no batten: --batten PATH or BATTEN", file=sys.stderr)
        return SKIP

    differences, left_out = [], []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(args.jobs) as pool:
        bench = Bench(args, folder)
        if args.recorded:
            table(bench, recorded_programs(bench), LIMITS[0], pool, differences, left_out)
            args.limits = []
        elif args.files:
            programs = [(os.path.basename(f), read(f)) for f in args.files]
        else:
            programs = default_programs(args, folder) + smoothed_programs(args, folder)
        for limits in args.limits:
            in_modes = [("%s, F x %g" % (name, feed) if feed != 1 else name,
                         {mode: with_mode(with_feeds(text, feed), mode) for mode in args.modes})
                        for name, text in programs for feed in args.feeds]
            table(bench, in_modes, limits, pool, differences, left_out)
    for line in left_out:
        print("left out: " + line)
    if not differences:
        print("nothing to compare", file=sys.stderr)
        return SKIP
    return verdict(differences, args.within)


if __name__ == "__main__":
    sys.exit(main())
