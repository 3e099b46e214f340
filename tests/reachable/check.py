#!/usr/bin/env python3
"""check.py BUILD [NM]: is every object of the libraries on the way of a user?

From the objects of the program's `main` and of the library's public functions on, an object is reached when
one that is reached names a symbol that it defines. What is not reached only tests can use: it belongs to
tests/support/ or nowhere.

Ends with 1 and a line for each violation; with 77 (skipped) where objects hold many sources each (unity builds)."""
import collections
import pathlib
import subprocess
import sys

ROOTS = ("postproc/main.cpp", "api/batten.cpp")
LIBRARIES = ("geometry", "gcode", "postproc")
SKIPPED = 77


def objects_of(root, build):
    """Source as from the root -> its object, FOLDER/CMakeFiles/TARGET.dir/SOURCE.o, but those left of sources that
    are gone."""
    objects = {}
    for folder in (*LIBRARIES, "api"):
        for path in sorted((build / folder / "CMakeFiles").rglob("*.o")):
            name = path.relative_to(build / folder / "CMakeFiles").as_posix().partition(".dir/")[2]
            source = f"{folder}/{name.removesuffix('.o')}"
            if "/Unity/" in source or (root / source).is_file() or (build / source).is_file():
                objects[source] = path
    return objects


def symbols_of(objects, nm="nm"):
    """Source -> the symbols that it defines and those that it names and does not define."""
    symbols = {}
    for source, path in objects.items():
        defined, wanted = set(), set()
        listed = subprocess.run([nm, "--format=posix", str(path)], check=True, capture_output=True, text=True)
        for line in listed.stdout.splitlines():
            name, kind = line.split()[:2]
            if kind == "U":
                wanted.add(name)
            elif kind.isupper() or kind == "u":
                defined.add(name)
        symbols[source] = (defined, wanted)
    return symbols


def reached_from(roots, symbols):
    holders = collections.defaultdict(list)
    for source, (defined, _) in symbols.items():
        for name in defined:
            holders[name].append(source)
    reached, waiting = set(roots), list(roots)
    while waiting:
        for name in symbols[waiting.pop()][1]:
            for source in holders[name]:
                if source not in reached:
                    reached.add(source)
                    waiting.append(source)
    return reached


def judge(symbols):
    """A line for each violation."""
    missing = [f"no object of {root}" for root in ROOTS if root not in symbols]
    ours = [source for source in symbols if source not in ROOTS]
    missing += [f"no objects of {top}/" for top in LIBRARIES if not any(s.startswith(top + "/") for s in ours)]
    if missing:
        return missing
    reached = reached_from(ROOTS, symbols)
    return [f"{source}: neither the program nor the library reaches it (tests/reachable/check.py)"
            for source in ours if source not in reached]


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    objects = objects_of(root, pathlib.Path(sys.argv[1]))
    if any("/Unity/" in source for source in objects):
        print("skipped: objects of this build hold many sources each")
        return SKIPPED
    violations = judge(symbols_of(objects, *sys.argv[2:3]))
    for violation in violations:
        print(violation)
    if not violations:
        print(f"{len(objects)} objects, all reached")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
