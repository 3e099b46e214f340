#!/usr/bin/env python3
"""tuning_mutants.py [--only STRUCT,..] [--factor 2] [--jobs 1] [--scratch DIR] [--slow 2] [--seconds 60]
                     [--table]

Which test holds each threshold? The numbers of the structs `*Tuning` are changed one at a time, and the
tests that may notice are run until one fails.

A copy of the checkout is built in the scratch folder (build/tuning_mutants), where each number can be set
from outside. Each gets two mutants, by --factor below and above. What is near to 1 gets half and double
its distance to 1 instead, what counts as rounding a thousandth and a thousandfold; whole numbers change
by one at least. Numbers that the compiler has to know are only listed.

The tests are those of the folders from which the struct's own folder is reached, the nearest first, but
for those that take more than --slow seconds, and in the end the figures (tests/figures). A mutant that
takes more than --seconds of processor time fails. Results are added to results.jsonl in the scratch
folder, and what is there is not run again.

At the end comes a table: number, value, mutant, test that fails. With --table that is all.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import types

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SOURCES = ("geometry", "postproc")
CONSTANTS = {"FeatureTuning.most_beside_kink"}  # and what is static: sizes of arrays
PROGRAMS = ("geometry", "properties", "postproc")  # in the order in which they are tried
FARTHEST = 2  # includes from a test's folder to the struct's: beyond, tests are about other things
FIGURES = "tests/figures/check.py"  # the last test: it looks at every number in use
HEADER = "geometry/basic/tuning_mutant.h"
HEADER_TEXT = """#pragma once
#include <cstdlib>
#include <sstream>
#include <string>

template <class T>
T tuning_mutant(const std::string& name, T value) {
  const char* chosen = std::getenv("BATTEN_MUTANT");
  if (!chosen || !std::string(chosen).starts_with(name + "=")) return value;
  std::istringstream(chosen + name.size() + 1) >> value;
  return value;
}
"""
STRUCT = re.compile(r"^struct (\w+Tuning) \{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
MEMBER = re.compile(r"^  (static constexpr )?([\w:<>, ]+?) (\w+)(\[\d+\])? =\s*([^;]+);", re.MULTILINE)
COMMENT = re.compile(r"\n? *//.*")  # left out: nothing is compiled anew for other words
INCLUDED = re.compile(r'#include "(\w[\w/]*)/\w+\.h"')

Number = collections.namedtuple("Number", "struct name folder value whole")


def read_options():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", type=lambda text: text.split(","))
    parser.add_argument("--factor", type=float, default=2)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--scratch", type=pathlib.Path, default=ROOT / "build" / "tuning_mutants")
    parser.add_argument("--slow", type=float, default=2)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--table", action="store_true")
    return parser.parse_args()


# --- the copy in which numbers can be set -------------------------------------------------------


def mutable(folder, text, numbers, constants):
    """The text of a source in which the numbers of its structs can be set; these are added to `numbers`."""
    known = {"kPi": 3.141592653589793}
    known["geometry"] = types.SimpleNamespace(**known)

    def member(struct, match):
        fixed, kind, name, array, expression = match.groups()
        parts = [part for part in re.split(r",\s*", expression.strip("{} \n")) if part]
        keys = [f"{struct}.{name}" + (f"[{i}]" if len(parts) > 1 else "") for i in range(len(parts))]
        values = [float(eval(part.replace("::", "."), known)) for part in parts]
        known[name] = values[0]
        if fixed or keys[0] in CONSTANTS:
            constants.extend(keys)
            return f"  static constexpr {kind} {name} = {expression};"
        inner = re.sub(r"std::array<(\w+),.*", r"\1", kind)
        numbers.extend(Number(struct, key, folder, *each, inner != "double") for key, *each in zip(keys, values))
        calls = ", ".join(f'tuning_mutant<{inner}>("{key}", {part})' for key, part in zip(keys, parts))
        return f"  {kind} {name}{array or ''} = " + (f"{{{calls}}};" if len(keys) > 1 else f"{calls};")

    def struct(match):
        name, body = match.groups()
        return f"struct {name} {{\n{MEMBER.sub(lambda m: member(name, m), COMMENT.sub('', body))}}};"

    changed = STRUCT.sub(struct, text)
    if changed != text:
        changed = f'#include "{HEADER}"\n' + changed
    changed = re.sub(r"\bconstexpr (\w+Tuning k\w+)", r"const \1", changed)
    said = "|".join([r"k\w+Tuning", *re.findall(r"\w+Tuning (k\w+)", changed)])
    # Static: a lambda may name it without capturing it.
    return re.sub(rf"\bconstexpr (\w[\w:]* \w+ = [^;]*\b({said})\.)", r"static const \1", changed)


def copy_checkout(to, write):
    """Copies what git tracks, with all numbers made mutable; gives these, and the names of those that are
    constants. What has not changed is not written, so that it is not compiled again."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files"], check=True, capture_output=True, text=True)
    files = {path: (ROOT / path).read_bytes() for path in map(pathlib.Path, listed.stdout.splitlines())
             if (ROOT / path).is_file()}
    sources = [path for path in files if path.parts[0] in SOURCES and path.suffix in (".h", ".cpp")]
    numbers, constants = [], []
    for path in sources:
        files[path] = mutable(path.parent.as_posix(), files[path].decode(), numbers, constants).encode()
    files[pathlib.Path(HEADER)] = HEADER_TEXT.encode()
    for path, data in files.items() if write else ():
        file = to / path
        if not file.is_file() or file.read_bytes() != data:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)
            file.chmod((ROOT / path).stat().st_mode if (ROOT / path).exists() else 0o644)
    return numbers, constants


def build(scratch):
    place = scratch / "build" / "steps"
    if not (place / "build.ninja").exists():
        subprocess.run(["cmake", "-S", scratch, "-B", place, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None",
                        "-DCMAKE_CXX_FLAGS=-O1 -D_GLIBCXX_ASSERTIONS -Wno-shadow"], check=True)
    subprocess.run(["cmake", "--build", place, "--target", "batten", *(f"{p}_tests" for p in PROGRAMS)], check=True)
    return place / "tests"


# --- the tests that may notice ------------------------------------------------------------------


class Tests:
    """Names of the tests that pass and are quick, with their folders."""

    def __init__(self, place, scratch, slow):
        self.place, self.scratch = place, scratch
        self.users = collections.defaultdict(set)  # folder -> those whose sources include its headers
        for file in (file for top in SOURCES for file in (scratch / top).rglob("*.[hc]*")):
            for included in INCLUDED.findall(file.read_text()):
                self.users[included].add(file.parent.relative_to(scratch).as_posix())
        self.all = {program: self.passing(program, slow) for program in PROGRAMS}

    def passing(self, program, slow):
        binary, listing = self.place / f"{program}_tests", self.scratch / f"{program}.json"
        if not listing.exists() or listing.stat().st_mtime < binary.stat().st_mtime:
            subprocess.run([binary, f"--gtest_output=json:{listing}"], cwd=self.scratch, check=False,
                           capture_output=True)
        found = []
        for suite in json.loads(listing.read_text())["testsuites"]:
            for test in suite["testsuite"]:
                if "failures" not in test and float(test["time"].rstrip("s")) <= slow:
                    file = pathlib.Path(test["file"].rsplit("/tests/")[-1])
                    text = (self.scratch / "tests" / file).read_text() if program == "properties" else ""
                    folders = {file.parent.as_posix(), *INCLUDED.findall(text)}
                    found.append((f'{suite["name"]}.{test["name"]}', folders))
        return found

    def stages(self, folder):
        """(program, names of tests): those of the folder, then those of folders from which it is reached."""
        far = {folder: 0}
        for steps in range(1, FARTHEST + 1):
            far = {user: steps for known in far for user in self.users[known]} | far
        for program in PROGRAMS:
            stages = [[], []]
            for name, folders in self.all[program]:
                if reached := [far[each] for each in folders if each in far]:
                    stages[min(1, *reached)].append(name)
            yield from ((program, names) for names in stages if names)


# --- mutants ------------------------------------------------------------------------------------


def mutants(number, factor):
    value = number.value
    if number.whole:
        low, high = sorted((int(value / factor), int(value * factor)))
        return [min(low, int(value) - 1), max(high, int(value) + 1)]
    is_share = 0.5 < value <= 1.2 and value != 1
    size = abs(value - 1) if is_share else abs(value)
    by = 1000 if size <= 1e-5 or size > 1e5 else factor
    return sorted(1 + (value - 1) * each if is_share else value * each for each in (1 / by, by))


def outcome(tests, number, value, seconds):
    """The first test that fails with the mutant, or 'survives'."""

    def limit():
        os.nice(10)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))

    def run(*words):
        return subprocess.run(words, cwd=tests.scratch, preexec_fn=limit, capture_output=True, text=True,
                              env={**os.environ, "BATTEN_MUTANT": f"{number.name}={value!r}"})

    for program, names in tests.stages(number.folder):
        done = run(tests.place / f"{program}_tests", "--gtest_fail_fast", "--gtest_filter=" + ":".join(names))
        if done.returncode != 0:
            failed = re.findall(r"^\[  FAILED  \] ([\w./]+)", done.stdout, re.MULTILINE)
            begun = re.findall(r"^\[ RUN      \] ([\w./]+)", done.stdout, re.MULTILINE)
            return failed[0] if failed else f"{[program, *begun][-1]} (ends with {done.returncode})"
    figures = run(sys.executable, tests.scratch / FIGURES, tests.place.parent / "batten")
    return "survives" if figures.returncode == 0 else "Figures"


def main():
    options = read_options()
    scratch = options.scratch.resolve()
    numbers, constants = copy_checkout(scratch, not options.table)
    is_wanted = lambda name: options.only is None or name.split(".")[0] in options.only
    wanted = [(number, value) for number in numbers if is_wanted(number.name)
              for value in mutants(number, options.factor)]
    file = scratch / "results.jsonl"
    lines = file.read_text().splitlines() if file.exists() else []
    known = {(name, value): result for name, value, result in map(json.loads, lines)}
    if not options.table:
        tests = Tests(build(scratch), scratch, options.slow)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool, file.open("a") as added:
            runs = {pool.submit(outcome, tests, number, value, options.seconds): (number.name, value)
                    for number, value in wanted if (number.name, value) not in known}
            for run in concurrent.futures.as_completed(runs):
                known[runs[run]] = run.result()
                print(json.dumps([*runs[run], run.result()]), file=added, flush=True)
    for number, value in wanted:
        print(f"{number.name:42} {number.value:<12g} {value:<12g} {known.get((number.name, value), '-')}")
    for name in filter(is_wanted, constants):
        print(f"{name:42} has to be known when it is compiled")


if __name__ == "__main__":
    sys.exit(main())
