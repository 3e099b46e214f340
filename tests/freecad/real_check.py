"""real_check.py BATTEN ROOT   From a fresh home to a smoothed program, with the installed FreeCAD.

`batten freecad install` asks freecadcmd for the place, freecadcmd makes and posts the job of
real_job.py. Exits with 77 where there is no freecadcmd, or one of 1.0 or later (its posts are asked
by other means)."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
TOLERANCE = "0.01"
SAME_TIME = 0.005  # what smooth itself takes for no slower: the error of its estimate
HANGS = 300  # s
# Every post of FreeCAD 0.20 and the target that its program is for, or one that can read it.
POSTS = {
    "linuxcnc": "linuxcnc", "grbl": "grbl", "jtech": "grbl", "marlin": "marlin",
    "rrf": "reprapfirmware", "smoothie": "smoothieware", "mach3_mach4": "mach3", "uccnc": "uccnc",
    "KineticNCBeamicon2": "linuxcnc", "dynapath": "fanuc", "centroid": "centroid", "fanuc": "fanuc",
    "philips": "philips", "heidenhain": "heidenhain", "fablin": "grbl", "nccad": "fanuc",
    "comparams": "grbl", "dxf": "grbl", "opensbp": "grbl", "rml": "grbl"}
# Its post of 0.20 writes feeds in mm/s as if they were mm/min: no path is faster.
OPTIONS = {"heidenhain": "--prefer size"}
# Two name no unit; the others write no G-code.
REFUSED = {"fablin": "units-missing", "nccad": "units-missing", "dxf": "not-a-program",
           "opensbp": "not-a-program", "rml": "not-a-program"}
LEFT_ALONE = ("comparams",)
wrong = []


def expect(truth, what, *details):
    if not truth:
        wrong.append(what)
        print("WRONG:", what, *(str(d)[-1500:] for d in details))


def rs274_accepts(program, folder):
    (folder / "tool.tbl").write_text("".join(f"T{i} P{i} D6 Z0\n" for i in range(1, 10)))
    (folder / "parameters.var").write_text("")
    done = subprocess.run(["rs274", "-g", "-n", "2", "-t", "tool.tbl", "-v", "parameters.var",
                           program], cwd=folder, env={**os.environ, "HOME": str(folder)},
                          stdin=subprocess.DEVNULL, capture_output=True)
    return done.returncode == 0 and not [line for line in done.stderr.splitlines()
                                         if line.strip() != b"executing"]


def run_freecad(home, script, **environment):
    return subprocess.run(["freecadcmd", script], env={**home, **environment}, timeout=HANGS,
                          stdin=subprocess.DEVNULL, capture_output=True, text=True)


def check(batten, root, folder):
    home = {k: v for k, v in os.environ.items() if not k.startswith(("XDG_", "FREECAD"))}
    home.update(HOME=str(folder / "home"), QT_QPA_PLATFORM="offscreen")
    (folder / "home").mkdir()
    out = folder / "out"
    (out / "old").mkdir(parents=True)
    installed = subprocess.run([batten, "freecad", "install"], env=home, capture_output=True,
                               text=True)
    expect(installed.returncode == 0, "installed", installed.stderr)
    print(installed.stderr.splitlines()[0])
    posts = list((folder / "home").rglob("batten_post.py"))
    expect(len(posts) == 1, "one post", posts)
    expect(not [p for p in (folder / "home").rglob("Mod")], "no Mod folder of the user's")

    run = run_freecad(home, str(root / "tests/freecad/real_job.py"), REAL_JOB=str(out),
                      REAL_JOB_POSTS=json.dumps([[post, target, OPTIONS.get(post, "")]
                                                 for post, target in POSTS.items()]),
                      REAL_JOB_ARGUMENTS="--target linuxcnc --machine linuxcnc-fast "
                                         f"--tolerance {TOLERANCE} --json {out}/report.json --force")
    told = out / "told.txt"
    expect(not told.exists(), "job made and posted", told.exists() and told.read_text(), run.stdout)
    if wrong:
        return
    check_programs(batten, out)
    check_each_post(batten, out)
    expect(not (out / "refused.nc").exists(), "nothing is written after a refusal")
    expect("there is no 'nonesuch'" in (out / "refusal.txt").read_text(), "the reason is told")


def figures(report):
    return [report[side]["blocks"] for side in ("input", "output")], \
           [report["time_before_s"], report["time_after_s"]]


def smoothed(batten, out, name, *options):
    """Blocks and cutting seconds, before and after, of one of the programs with other options."""
    done = subprocess.run([batten, "smooth", out / name, "--tolerance", TOLERANCE, "--dry-run",
                           "--json", out / "other.json", "--force", *options],
                          capture_output=True, text=True)
    expect(done.returncode == 0, f"{options}: smoothed", done.stderr)
    return figures(json.loads((out / "other.json").read_text()))


def check_other_forms(batten, out):
    """At the feed of the job the time is length over feed; where it can be less, it is."""
    blocks, seconds = smoothed(batten, out, "old.nc", "--target", "linuxcnc", "--machine",
                               "linuxcnc-fast", "--output", "arcs")
    print(f"--output arcs: {blocks[0]} -> {blocks[1]} blocks, {seconds[0]:.2f} -> {seconds[1]:.2f} s")
    expect(blocks[1] < 0.75 * blocks[0], "a quarter fewer blocks as arcs", blocks)
    expect(seconds[1] < (1 + SAME_TIME) * seconds[0], "no more time as arcs", seconds)
    (out / "fast.nc").write_text((out / "old.nc").read_text().replace("F1500", "F6000"))
    blocks, seconds = smoothed(batten, out, "fast.nc", "--target", "grbl", "--machine",
                               "router-unrounded")
    print(f"F6000, grbl: {blocks[0]} -> {blocks[1]} blocks, {seconds[0]:.2f} -> {seconds[1]:.2f} s")
    expect(seconds[1] < 0.95 * seconds[0], "less time at a higher feed", seconds)


def check_programs(batten, out):
    verified = subprocess.run([batten, "verify", out / "old.nc", out / "new.nc", "--tolerance",
                               TOLERANCE], capture_output=True, text=True)
    expect(verified.returncode == 0, "proved", verified.stderr)
    report = json.loads((out / "report.json").read_text())
    rewritten = [run for run in report["runs"] if run["status"] == "rewritten"]
    expect(rewritten, "runs are rewritten")
    blocks, seconds = figures(report)
    expect(blocks[1] < blocks[0], "fewer blocks", blocks)
    expect(seconds[1] < (1 + SAME_TIME) * seconds[0], "no more time", seconds)
    if shutil.which("rs274"):
        expect(rs274_accepts("old.nc", out), "rs274 takes FreeCAD's program")
        expect(rs274_accepts("new.nc", out), "rs274 takes the smoothed program")
    print(f"FreeCAD {(out / 'version.txt').read_text()}: {len(rewritten)} of {len(report['runs'])} runs "
          f"rewritten, {blocks[0]} -> {blocks[1]} blocks, "
          f"{seconds[0]:.2f} -> {seconds[1]:.2f} s of cutting, within {report['deviation_mm']:.4f} mm")
    check_other_forms(batten, out)


def check_each_post(batten, out):
    """Prints the table of docs/freecad.md: the job without its pocket, at F6000."""
    names = (out / "posts.txt").read_text().split()
    expect(set(names) - {"batten"} == set(POSTS), "every installed post is tried", names)
    print("| post | target | runs rewritten | blocks | cutting time |\n|---|---|---|---|---|")
    for post, target in POSTS.items():
        why = out / f"{post}.txt"
        expect(why.exists() == (post in REFUSED), f"{post}: posted", why.exists() and why.read_text())
        if why.exists():
            expect(REFUSED[post] in why.read_text(), f"{post}: refused for", why.read_text())
            continue
        report = json.loads((out / f"{post}.json").read_text())
        rewritten = [run for run in report["runs"] if run["status"] == "rewritten"]
        expect(bool(rewritten) != (post in LEFT_ALONE), f"{post}: runs rewritten", report["runs"])
        blocks, seconds = figures(report)
        if rewritten:
            done = subprocess.run([batten, "verify", out / "old" / f"{post}.nc", out / f"{post}.nc",
                                   "--target", target, "--units", "mm"], capture_output=True, text=True)
            expect(done.returncode == 0, f"{post}: proved", done.stderr)
        print(f"| `{post}` | `{target}` | {len(rewritten)} of {len(report['runs'])} | "
              f"{blocks[0]} -> {blocks[1]} | {seconds[0]:.2f} s -> {seconds[1]:.2f} s |")


def main(batten, root):
    if shutil.which("freecadcmd") is None:
        print("FreeCAD is not installed")
        return SKIPPED
    with tempfile.TemporaryDirectory(prefix="batten-real-freecad-") as folder:
        check(batten, root, pathlib.Path(folder))
    return 1 if wrong else 0


if len(sys.argv) != 3:
    sys.exit(__doc__)
sys.exit(main(str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()))
