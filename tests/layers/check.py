#!/usr/bin/env python3
"""check.py [ROOT]: do the includes keep the layers that docs/ARCHITECTURE.md tells?

Its table of layers has a row for each folder of sources: what it is about, and which folders it may
include. A folder may include only folders of rows above its own, so the table itself has no cycle. Asked are
all headers and sources. Besides: no two headers with their sources include each other, over any number of
steps; CGAL and CLI11 are included where the table's notes say; nothing is included by a relative path.

Ends with 1 and a line for each violation, or for each way in which the table cannot be read."""
import pathlib
import re
import sys

TOPS = ("geometry", "gcode", "postproc")
BEGIN = "## Layers"
ROW = re.compile(r"^\| `([\w/]+)/` \|[^|]*\|([^|]*)\|$")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)[">]', re.MULTILINE)
# Which library is included where, so that it can be replaced in one place.
ONLY_IN = {
    "CGAL/": re.compile(r"^geometry/(distance|band)/[^/]+\.cpp$"),
    "CLI/": re.compile(r"^postproc/cli/cli[^/]*\.cpp$"),
}


def layers_of(document, violations):
    """Folder -> folders that it may include, in the order of the table. A row may name a folder with all
    below it: `geometry/..`."""
    layers = {}
    _, found, text = document.partition(BEGIN)
    for line in text.split("\n## ")[0].splitlines() if found else []:
        if not (row := ROW.match(line)):
            continue
        folder, allowed = row.group(1), set()
        for name in re.findall(r"`([\w/]+(?:\.\.)?)`", row.group(2)):
            if name.endswith("/.."):
                named = {f for f in layers if (f + "/").startswith(name[:-2])}
            else:
                named = {name.rstrip("/")} & set(layers)
            if not named:
                violations.append(f"docs/ARCHITECTURE.md: {folder} may include {name}, which is no row above it")
            allowed |= named
        layers[folder] = allowed
    if not layers:
        violations.append(f"docs/ARCHITECTURE.md: no table of layers under '{BEGIN}'")
    return layers


def sources_of(root):
    for top in TOPS:
        for file in sorted((root / top).rglob("*")):
            if file.suffix in (".h", ".cpp") or file.name.endswith(".cpp.in"):
                yield file


def judge_include(file, folder, quote, header, layers):
    """What is wrong with one include, or nothing."""
    for library, where in ONLY_IN.items():
        if header.startswith(library) and not where.match(file):
            return f"{library[:-1]} is included only by {where.pattern}"
    ours = header.startswith(tuple(top + "/" for top in TOPS))
    if quote == "<":
        return "our own headers stand in quotes" if ours else None
    if not ours:
        return "headers are named from the root"
    other = header.rpartition("/")[0]
    if other != folder and other not in layers[folder]:
        return f"{folder}/ may not include {other}/ (docs/ARCHITECTURE.md, Layers)"
    return None


def pair_cycles(graph):
    """Sets of pairs that reach each other (Tarjan 1972), each as sorted names."""
    order, low, stack, on_stack, found = {}, {}, [], set(), []

    def visit(pair):
        order[pair] = low[pair] = len(order)
        stack.append(pair)
        on_stack.add(pair)
        for other in graph[pair]:
            if other not in order:
                visit(other)
                low[pair] = min(low[pair], low[other])
            elif other in on_stack:
                low[pair] = min(low[pair], order[other])
        if low[pair] == order[pair]:
            cycle = stack[stack.index(pair):]
            del stack[stack.index(pair):]
            on_stack.difference_update(cycle)
            if len(cycle) > 1:
                found.append(sorted(cycle))

    for pair in graph:
        if pair not in order:
            visit(pair)
    return found


def pair_of(file):
    return file.partition(".")[0]


def check(root):
    violations = []
    document = root / "docs/ARCHITECTURE.md"
    layers = layers_of(document.read_text(encoding="utf-8") if document.is_file() else "", violations)
    graph, files = {}, 0
    for path in sources_of(root):
        files += 1
        file = path.relative_to(root).as_posix()
        folder = file.rpartition("/")[0]
        if folder not in layers:
            violations.append(f"{file}: {folder}/ is no row of the table of layers")
            continue
        others = graph.setdefault(pair_of(file), set())
        for quote, header in INCLUDE.findall(path.read_text(encoding="utf-8")):
            if complaint := judge_include(file, folder, quote, header, layers):
                violations.append(f"{file}: {header}: {complaint}")
            elif quote == '"' and pair_of(header) != pair_of(file):
                others.add(pair_of(header))
    for others in list(graph.values()):
        for other in others:
            graph.setdefault(other, set())
    violations += [f"include each other: {', '.join(cycle)}" for cycle in pair_cycles(graph)]
    if files == 0:
        violations.append(f"no sources below {root}")
    return violations, files


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__ + "/../../..").resolve()
    violations, files = check(root)
    for violation in violations:
        print(violation)
    if not violations:
        print(f"layers kept by {files} files")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.setrecursionlimit(10000)
    sys.exit(main())
