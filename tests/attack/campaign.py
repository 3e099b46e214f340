#!/usr/bin/env python3
"""campaign.py BATTEN [--seed 1] [--programs 10000] [--damages 10000] [--jobs 2] [--folder DIR]
                   [--anew] [--targets linuxcnc,siemens] [--corpus DIR]

Is what Batten writes and proves right, and does `verify` find what is wrong? Random programs in ten
styles for many controls, with all between their cuts that programs have (programs.py), are smoothed in
random forms, by random methods, preferences and tolerances. What is written has to do what the old
program did, by readers that share no code with Batten (readers.py, oracle.py) and by LinuxCNC's own
interpreter, where `rs274` is installed and accepts the old program; it has to be proved by `verify`,
too. Then the new program is damaged (damage.py) and given to `verify`, and where there is a
certificate to tools/check_certificate.py: whatever they accept has to be harmless. So has what `verify`
accepts where a weight of the old program is another one than that which was smoothed.

--folder keeps what is found, each program with its command, and the progress: the same call goes on
where it was stopped, unless it says --anew. Prints a line for each finding and a table at the end; exits with 1 when there
was any finding. With --corpus, instead: every program of a folder is smoothed for linuxcnc in each
form and preference, and LinuxCNC has to accept what is written where it accepted the old program, and
to do the same."""

import argparse
import collections
import concurrent.futures
import contextlib
import io
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tools")]
import check_certificate  # noqa: E402
import oracle  # noqa: E402
from damage import WEIGHT, Damage  # noqa: E402
from programs import FORMS, LIKE, STYLES, TARGETS, Programs  # noqa: E402

PROVED, REFUSED, NOT_PROVED = 0, 2, 3
IN_A_PIECE = 10  # programs of a task
CERTIFIED = ("linuxcnc", "grbl", "fanuc", "siemens", "heidenhain")
METHODS = ["best"] * 5 + ["fair", "racing", "naseath", "guo", "ozcan", "none"]


def random_options(target, chance):
    options = ["--tolerance", str(chance.choice([0.002, 0.005, 0.01, 0.01, 0.02, 0.05, 0.1]))]
    smooth = ["--output", chance.choice(["auto", "auto"] + FORMS.get(target, ["arcs", "lines"])),
              "--method", chance.choice(METHODS), "--prefer", chance.choice(["time", "accuracy", "size"])]
    if chance.random() < 0.3:
        smooth += ["--linearize", chance.choice(["minlink", "chord", "ilca", "blca"])]
    if chance.random() < 0.2:
        smooth += ["--keep-corners", str(chance.choice([10, 30, 60]))]
    if chance.random() < 0.1:
        options += ["--side", chance.choice(["left", "right"])]
    return options, smooth


def line_limits(batten):
    """Of each target: how long a line may be."""
    told = subprocess.run([batten, "targets"], capture_output=True, text=True, check=True).stdout
    rows = (line.split() for line in told.split("\n")[1:] if line)
    return {row[0]: int(row[3]) for row in rows}


def held_of(target, line):
    """What the control holds of a line: grbl drops comments and blanks before they come to its buffer, and
    RepRapFirmware comments."""
    if target in ("grbl", "reprapfirmware"):
        line = re.sub(r"\([^)]*\)|;.*", "", line)
    return "".join(line.split()) if target == "grbl" else line


class Tries:
    """Programs of one task, and what came of them."""

    def __init__(self, batten, limits, folder, keep):
        self.batten, self.limits, self.keep = batten, limits, keep
        self.old, self.new, self.certificate = (folder / name for name in ("old.nc", "new.nc", "new.cert"))
        self.counts, self.findings = collections.Counter(), []

    def run(self, *words):
        try:
            ran = subprocess.run([self.batten, *map(str, words)], capture_output=True, timeout=120)
        except subprocess.TimeoutExpired:
            return -1, "does not end"
        return ran.returncode, (ran.stderr + ran.stdout).decode("latin1")

    def found(self, name, what, command, texts):
        self.keep.mkdir(parents=True, exist_ok=True)
        for suffix, text in texts.items():
            (self.keep / f"{name}.{suffix}").write_text(text, encoding="latin-1")
        (self.keep / f"{name}.txt").write_text(f"{what}\n{' '.join(map(str, command))}\n")
        self.findings.append(f"{name}: {what}")

    def program(self, seed, index, targets, damages):
        chance = random.Random(f"{seed} {index}")
        target = chance.choice(targets)
        text, style = Programs(target, chance).program()
        options, smooth = random_options(target, chance)
        tolerance = float(options[1])
        certified = target in CERTIFIED
        self.old.write_text(text)
        self.count(target, "programs", style)
        self.counts[f"style {style}"] += 1
        self.certificate.unlink(missing_ok=True)
        command = ["smooth", self.old, "-o", self.new, "--force", "--quiet", "--threads", "1", "--target", target,
                   *options, *smooth] + (["--certificate", self.certificate] if certified else [])
        code, said = self.run(*command)
        name = f"{seed}-{index}-{target}"
        if code == REFUSED:
            return self.count(target, "refused")
        if code != PROVED:
            return self.found(name, f"smooth ended with {code}: {said.strip()[-300:]}", command, {"old": text})
        new = self.new.read_text(encoding="latin-1")
        texts = {"old": text, "new": new}
        verify = ["verify", self.old, self.new, "--target", target, *options]
        old = oracle.OldProgram(text, target)
        canon = oracle.Canon(text) if target in oracle.LIKE_LINUXCNC and oracle.rs274_is_there() else None
        if canon and not canon.complaint:
            self.count(target, "by rs274")
        if new == text:
            self.count(target, "unchanged")
        else:
            self.count(target, "rewritten")
            harm = self.harm(old, canon, new, tolerance) or self.too_long(target, text, new)
            if harm:
                self.found(name, harm, command, texts)
            code, said = self.run(*verify)
            if code != PROVED:
                self.found(name, f"verify ended with {code} for what smooth wrote: {said.strip()[-300:]}", verify, texts)
        proof = self.certificate.read_text() if self.certificate.exists() else None
        if proof is not None and new != text:
            accepted, why = self.checked(target, tolerance)
            self.count(target, "certified" if accepted else "not certified")
            if not accepted:
                why = re.sub(r"'[^']*'|\d+", "..", why.split("\n")[1].split(":", 1)[1].strip())
                self.counts[f"not certified: {why}"] += 1
                proof = None
        for n in range(damages):
            if WEIGHT.search(text) and chance.random() < 0.4:
                self.other_weight(f"{name}-{n}", target, new, text, tolerance, verify, chance)
                continue
            self.damaged(f"{name}-{n}", target, new, text, old, canon, tolerance, verify, proof, chance)

    def count(self, target, *what):
        self.counts[f"{target} {what[0]}"] += 1

    def harm(self, old, canon, new, tolerance, of_parts=True):
        harm = old.harm(new, tolerance, of_parts)
        if not harm and canon:
            harm = oracle.harm_in_linuxcnc(canon, new, tolerance)
        return harm

    def too_long(self, target, old, new):
        known = set(old.split("\n"))
        long = [line for line in new.split("\n")
                if len(held_of(target, line)) > self.limits[target] and line not in known]
        return f"a line of {len(held_of(target, long[0]))} characters" if long else ""

    def checked(self, target, tolerance):
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            code = check_certificate.main([str(self.old), str(self.new), str(self.certificate), "--control", target,
                                           "--tolerance", str(tolerance)])
        return code == 0, said.getvalue()

    def other_weight(self, name, target, new, text, tolerance, verify, chance):
        """The new program is one of an old one that has another weight."""
        broken = "\n".join(Damage(False, "", chance).damage_other_weight(text.split("\n"), 0))
        self.old.write_text(broken)
        self.new.write_bytes(new.encode("latin1"))
        self.count(target, "damaged")
        code, said = self.run(*verify)
        harm = oracle.OldProgram(broken, target).harm(new, tolerance) if code == PROVED else ""
        self.count(target, "damaged, proved" if code == PROVED else "weights damaged, not proved")
        if code not in (PROVED, NOT_PROVED, REFUSED):
            harm = f"verify ended with {code}: {said.strip()[-200:]}"
        if harm:
            self.found(name, f"other weight in the old program: {harm}", verify, {"old": broken, "new": new, "undamaged": text})
        self.old.write_text(text)

    def damaged(self, name, target, new, text, old, canon, tolerance, verify, proof, chance):
        like = LIKE.get(target, target)
        damage = Damage(like == "heidenhain", "." if like == "fanuc" else "", chance).of(new)
        if damage is None:
            return
        kind, broken = damage
        self.new.write_bytes(broken.encode("latin1"))
        self.count(target, "damaged")
        code, said = self.run(*verify)
        if code not in (PROVED, NOT_PROVED, REFUSED):
            self.found(name, f"{kind}: verify ended with {code}: {said.strip()[-200:]}", verify,
                       {"old": text, "new": broken})
        accepted = proof is not None and self.checked(target, tolerance)[0]
        if proof is not None:
            self.count(target, "certificates damaged")
        if code != PROVED and not accepted:
            return
        # A certificate has one tolerance for all.
        harm = self.harm(old, canon, broken, tolerance, of_parts=code == PROVED)
        if code == PROVED:
            self.count(target, "damaged, proved")
            if harm:
                self.found(name, f"{kind}: proved: {harm}", verify, {"old": text, "new": broken, "undamaged": new})
        if accepted:
            self.count(target, "damaged, certified")
            harm = harm and self.harm(old, canon, broken, tolerance, of_parts=False)
            if harm:
                self.found(name, f"{kind}: certified: {harm}", ["check_certificate", target, tolerance],
                           {"old": text, "new": broken, "undamaged": new, "cert": proof})


def piece(batten, limits, keep, seed, first, count, targets, damages):
    with tempfile.TemporaryDirectory() as folder:
        tries = Tries(batten, limits, pathlib.Path(folder), keep)
        for index in range(first, first + count):
            here = (index + 1) * damages[0] // damages[1] - index * damages[0] // damages[1]
            try:
                tries.program(seed, index, targets, here)
            except Exception as error:  # of a reader or of the checker: a finding, and no end of the attack
                tries.findings.append(f"{seed}-{index}: {error!r}")
    return first, dict(tries.counts), tries.findings


COLUMNS = ("programs", "refused", "unchanged", "rewritten", "by rs274", "damaged", "damaged, proved", "certified",
           "not certified", "certificates damaged", "damaged, certified")


def table(counts):
    targets = sorted({key.split(" ")[0] for key in counts if key.endswith(" programs")})
    rows = [("", *COLUMNS)] + [(t, *(counts[f"{t} {c}"] for c in COLUMNS)) for t in targets]
    rows.append(("all", *(sum(counts[f"{t} {c}"] for t in targets) for c in COLUMNS)))
    lines = ["| " + " | ".join(map(str, row)) + " |" for row in rows]
    lines.insert(1, "|---" * len(rows[0]) + "|")
    lines.append("styles: " + ", ".join(f"{style} {counts[f'style {style}']}" for style in STYLES))
    lines += [f"{key}: {counts[key]}" for key in sorted(counts) if key.startswith("not certified: ")]
    return "\n".join(lines)


def attack(options, folder):
    batten = options.batten.resolve()
    log = folder / "progress.jsonl"
    if options.anew:
        log.unlink(missing_ok=True)
    call = [options.seed, options.programs, options.damages, ",".join(options.targets)]
    done, counts, findings = set(), collections.Counter(), []
    for line in log.read_text().split("\n")[:-1] if log.exists() else []:
        entry = json.loads(line)
        if entry["call"] == call:
            done.add(entry["first"])
            counts.update(entry["counts"])
            findings += entry["findings"]
    pieces = [n for n in range(0, options.programs, IN_A_PIECE) if n not in done]
    limits = line_limits(batten)
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as workers:
        jobs = [workers.submit(piece, batten, limits, folder / "found", options.seed, first,
                               min(IN_A_PIECE, options.programs - first), options.targets,
                               (options.damages, options.programs)) for first in pieces]
        for number, job in enumerate(concurrent.futures.as_completed(jobs), 1):
            first, more, found = job.result()
            counts.update(more)
            findings += found
            with open(log, "a") as file:
                file.write(json.dumps({"call": call, "first": first, "counts": more, "findings": found}) + "\n")
            for line in found:
                print(line, flush=True)
            if number % 20 == 0:
                print(f"{len(done) + number} of {len(done) + len(pieces)} pieces, {len(findings)} findings",
                      file=sys.stderr, flush=True)
    print(table(counts))
    return findings


CORPUS_OPTIONS = (["--prefer", "time"], ["--prefer", "accuracy"], ["--prefer", "size"], ["--output", "arcs"],
                  ["--output", "lines"], ["--output", "curves"])


def corpus_program(batten, path):
    """What LinuxCNC says of one program in all forms: counts by outcome, findings."""
    counts, findings, canon = collections.Counter(), [], None
    text = path.read_text(encoding="latin-1")
    with tempfile.TemporaryDirectory() as folder:
        new = pathlib.Path(folder, "new.ngc")
        for words in CORPUS_OPTIONS:
            command = [batten, "smooth", path, "-o", new, "--force", "--quiet", "--threads", "1", "--target", "linuxcnc",
                       "--tolerance", "0.01", *words]
            ran = subprocess.run(list(map(str, command)), capture_output=True, text=True)
            if ran.returncode == REFUSED and "--units" in ran.stderr:
                ran = subprocess.run([*map(str, command), "--units", "mm"], capture_output=True, text=True)
            if ran.returncode != PROVED:
                counts["refused by Batten"] += 1
                continue
            written = new.read_text(encoding="latin-1")
            if written == text:
                counts["unchanged"] += 1
                continue
            counts["rewritten"] += 1
            canon = canon or oracle.Canon(text)
            if canon.complaint:
                counts["old program not accepted by LinuxCNC"] += 1
                continue
            harm = oracle.harm_in_linuxcnc(canon, written, 0.01)
            counts["curves, accepted" if harm is None else "accepted"] += not harm
            if harm:
                findings.append(f"{path.name} {' '.join(words)}: {harm}")
    return counts, findings


def corpus(options):
    """Whether LinuxCNC takes the new text where it took the old one."""
    counts, findings = collections.Counter(), []
    paths = sorted(p for p in options.corpus.rglob("*") if p.is_file())
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        asked = [pool.submit(corpus_program, options.batten.resolve(), path) for path in paths]
        for done, result in enumerate(concurrent.futures.as_completed(asked), 1):
            found, wrong = result.result()
            counts += found
            findings += wrong
            print("\n".join([*wrong, f"{done} of {len(paths)} programs, {len(findings)} findings"]), flush=True)
    print(", ".join(f"{what}: {count}" for what, count in sorted(counts.items())))
    return findings


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--programs", type=int, default=10000)
    parser.add_argument("--damages", type=int, default=10000)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--targets", type=lambda text: text.split(","), default=TARGETS)
    parser.add_argument("--folder", type=pathlib.Path)
    parser.add_argument("--anew", action="store_true")
    parser.add_argument("--corpus", type=pathlib.Path)
    options = parser.parse_args()
    folder = (options.folder or pathlib.Path(tempfile.mkdtemp(prefix="batten-campaign-"))).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    findings = corpus(options) if options.corpus else attack(options, folder)
    print(f"{len(findings)} findings" + (f", kept in {folder}/found" if findings and not options.corpus else ""))
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
