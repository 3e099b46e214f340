#!/usr/bin/env python3
"""compare_binaries.py OLD NEW [--corpus DIR] [--samples DIR] [--targets a,b,..] [--prefer a,b,..]
                       [--threads 1,2] [--tolerance 0.01] [--option WORD]... [--ignore-key KEY]...
                       [--sample N] [--jobs 2] [--cache DIR]

Does NEW smooth as OLD does? Both smooth every program of the samples, of the corpus beside the checkout
(or BATTEN_CORPUS) and two made for it, just below and just above the size from which programs are read
in windows: for each target, preference and number of threads. Output, JSON report, what was said on
standard output and standard error, and exit codes are compared, byte for byte except for keys of the
report that --ignore-key names (always: the version).

One line per difference, with the first line that differs; at the end how many there were, the
processor time of each binary and its greatest memory. Exits with 1 when there is a difference.
With --cache, what OLD gave is kept there, under the hash of the binary, for the next NEW.
"""

import argparse
import collections
import concurrent.futures
import gzip
import hashlib
import itertools
import json
import os
import pathlib
import pickle
import subprocess
import sys
import tempfile
import threading

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE.parent / "corpus"))
from programs import bytes_of, programs_in

TARGETS = "linuxcnc,grbl,fanuc,siemens,heidenhain"
WINDOWS_FROM = 2 << 20  # bytes (docs/long_programs.md)
ALWAYS_IGNORED = ["batten"]
HANGS = 900  # seconds, for programs of some megabytes
SHOWN = 70  # characters of a line that differs

Program = collections.namedtuple("Program", "name suffix data hash")
Setting = collections.namedtuple("Setting", "target prefer threads")
# `output` and `report` are None where no such file was written. `cpu` in seconds, `memory` in bytes:
# at least what Python holds itself, since the system counts from before the program began.
Result = collections.namedtuple("Result", "code output report stdout stderr cpu memory")


def read_options(words=None):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    beside = os.environ.get("BATTEN_CORPUS", ROOT / ".." / "shared" / "corpus")
    listed = lambda text: text.split(",")
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--corpus", type=pathlib.Path, default=beside)
    parser.add_argument("--samples", type=pathlib.Path, default=ROOT / "samples")
    parser.add_argument("--targets", type=listed, default=TARGETS)
    parser.add_argument("--prefer", type=listed, default="time,accuracy,size")
    parser.add_argument("--threads", type=listed, default="1,2")
    parser.add_argument("--tolerance", default="0.01")
    parser.add_argument("--option", action="append", default=[], metavar="WORD",
                        help="given to smooth as well, as in --option=--convert")
    parser.add_argument("--ignore-key", action="append", default=[], metavar="KEY")
    parser.add_argument("--sample", type=int, metavar="N",
                        help="only N programs, evenly from the smallest to the largest")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--cache", type=pathlib.Path)
    return parser.parse_args(words)


# --- the programs ------------------------------------------------------------------------------


def program_of(name, suffix, data):
    return Program(name, suffix, data, hashlib.sha256(data).hexdigest())


def program_in(folder, file):
    suffix = pathlib.Path(file.stem if file.suffix == ".gz" else file.name).suffix
    return program_of(str(file.relative_to(folder)), suffix, bytes_of(file))


def large_programs():
    """Short runs, then a long one, cut at lines just below and just above the bound."""
    with tempfile.TemporaryDirectory(prefix="batten-large-") as folder:
        made = subprocess.run(
            [sys.executable, HERE / "make_large_programs.py", folder, "relief", "spiral",
             "--blocks", "60000"], check=True, capture_output=True, text=True)
        relief, spiral = (pathlib.Path(path).read_bytes() for path in made.stdout.splitlines())
    tail = relief[relief.rindex(b"G0 Z5\n"):]
    lines = (relief.removesuffix(tail) + spiral.partition(b"G94\n")[2]).splitlines(keepends=True)
    sizes = list(itertools.accumulate(map(len, lines)))
    below = sum(size + len(tail) < WINDOWS_FROM for size in sizes)
    return [program_of(f"{where} {WINDOWS_FROM} bytes", ".ngc", b"".join(lines[:count]) + tail)
            for where, count in [("below", below), ("above", below + 1)]]


def all_programs(options):
    found = [program_in(options.samples, f) for f in sorted(options.samples.glob("*/program.*"))]
    if options.corpus.is_dir():
        found += [program_in(options.corpus, f) for f in programs_in(options.corpus)]
    else:
        print(f"no corpus in {options.corpus}", file=sys.stderr)
    found = sorted(found + large_programs(), key=lambda program: len(program.data))
    if options.sample and options.sample < len(found):
        last = max(options.sample - 1, 1)
        found = [found[i * (len(found) - 1) // last] for i in range(options.sample)]
    return found[::-1]  # the longest work first


# --- one run of a binary -----------------------------------------------------------------------


def words_for(options, program, setting):
    return ["smooth", "program" + program.suffix, "-o", "new", "--json", "report.json",
            "--progress", "off", "--tolerance", options.tolerance, "--target", setting.target,
            "--prefer", setting.prefer, "--threads", setting.threads, *options.option]


def run(binary, program, words):
    """In a folder of its own, with names that are the same for every binary."""
    with tempfile.TemporaryDirectory(prefix="batten-compare-") as folder:
        folder = pathlib.Path(folder)
        (folder / words[1]).write_bytes(program.data)
        with open(folder / "stdout", "wb") as out, open(folder / "stderr", "wb") as err:
            process = subprocess.Popen([binary, *words], cwd=folder, stdin=subprocess.DEVNULL,
                                       stdout=out, stderr=err)
            late = threading.Timer(HANGS, process.kill)
            late.start()
            _, status, usage = os.wait4(process.pid, 0)
            late.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        read = lambda name: (folder / name).read_bytes() if (folder / name).exists() else None
        return Result(process.returncode, read("new"), read("report.json"), read("stdout"),
                      read("stderr"), usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


class Cache:
    """What a binary gave, in files under its hash. Nothing is kept without a folder."""

    def __init__(self, folder, binary):
        binary_hash = hashlib.sha256(binary.read_bytes()).hexdigest()
        self.folder = folder / binary_hash if folder else None
        if self.folder:
            self.folder.mkdir(parents=True, exist_ok=True)

    def result(self, binary, program, words):
        """(result, whether it was kept from an earlier comparison)"""
        if not self.folder:
            return run(binary, program, words), False
        key = hashlib.sha256("\0".join([program.hash, *words]).encode()).hexdigest()
        file = self.folder / key
        if file.exists():
            return Result(*pickle.loads(gzip.decompress(file.read_bytes()))), True
        result = run(binary, program, words)
        unfinished = file.with_suffix(f".{os.getpid()}.{threading.get_ident()}")
        unfinished.write_bytes(gzip.compress(pickle.dumps(tuple(result)), 1))
        unfinished.rename(file)
        return result, False


# --- what differs ------------------------------------------------------------------------------


def first_line(old, new):
    """Where two texts differ first, and what stands there in each."""
    if old is None or new is None:
        return "only the {} is there".format("new one" if old is None else "old one")
    pairs = itertools.zip_longest(old.splitlines(keepends=True), new.splitlines(keepends=True))
    for number, (before, after) in enumerate(pairs, 1):
        if before != after:
            show = lambda line: "the end" if line is None else repr(line)[1:][:SHOWN]
            return f"line {number}: {show(before)} became {show(after)}"
    return None


def without(value, keys):
    if isinstance(value, dict):
        return {k: without(v, keys) for k, v in value.items() if k not in keys}
    if isinstance(value, list):
        return [without(v, keys) for v in value]
    return value


def report_text(report, ignored):
    """A report without the keys that do not count, one value a line; as it is where it is no JSON."""
    try:
        return json.dumps(without(json.loads(report), ignored), indent=1).encode()
    except ValueError:
        return report


def differences(old, new, ignored):
    found = []
    if old.code != new.code:
        found.append(f"exit code {old.code} became {new.code}")
    for name in ["output", "report", "stdout", "stderr"]:
        before, after = getattr(old, name), getattr(new, name)
        if name == "report" and before != after and None not in (before, after):
            before, after = report_text(before, ignored), report_text(after, ignored)
        if before != after:
            found.append(f"{name}: {first_line(before, after)}")
    return found


class Comparison:
    def __init__(self, options):
        self.options = options
        self.ignored = {*ALWAYS_IGNORED, *options.ignore_key}
        self.old, self.new = options.old.resolve(), options.new.resolve()
        self.kept = Cache(options.cache, self.old)

    def compare(self, work):
        program, setting = work
        words = words_for(self.options, program, setting)
        old, was_kept = self.kept.result(self.old, program, words)
        new = run(self.new, program, words)
        costs = [(result.cpu, result.memory) for result in (old, new)]
        return work, differences(old, new, self.ignored), was_kept, costs


def main(options):
    settings = list(itertools.starmap(
        Setting, itertools.product(options.targets, options.prefer, options.threads)))
    programs = all_programs(options)
    work = list(itertools.product(programs, settings))
    kinds, differing = collections.Counter(), 0
    seconds, memory, kept = [0.0, 0.0], [0, 0], 0
    comparison = Comparison(options)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for done, found, was_kept, costs in pool.map(comparison.compare, work):
            program, setting = done
            for line in found:
                print(f"{program.name} for {setting.target}, {setting.prefer}, "
                      f"threads {setting.threads}: {line}", flush=True)
                kinds[line.split(":")[0].partition(" code")[0]] += 1
            differing += bool(found)
            kept += was_kept
            for i, (cpu, most) in enumerate(costs):
                seconds[i] += cpu
                memory[i] = max(memory[i], most)
    print(f"{len(programs)} programs, {len(settings)} settings, {len(work)} runs of each binary"
          + (f" ({kept} of the old one from the cache)" if kept else ""))
    print(f"{differing} runs differ"
          + "".join(f", {name}: {count}" for name, count in sorted(kinds.items())))
    print(f"processor time {seconds[0]:.1f} s became {seconds[1]:.1f} s, "
          f"greatest memory {memory[0] / 1e6:.0f} MB became {memory[1] / 1e6:.0f} MB")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main(read_options()))
