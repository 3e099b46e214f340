#!/usr/bin/env python3
"""Does the check of the layers see what it is there for? Plants one include after the other in a small tree of
its own."""
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import check  # noqa: E402

TABLE = """# How it is built

## Layers

| folder | is about | may include |
|---|---|---|
| `geometry/basic/` | points | |
| `geometry/distance/` | bounds | `geometry/basic/` |
| `geometry/band/` | bands | `geometry/..` |
| `gcode/text/` | text | `geometry/..` |
| `postproc/cli/` | command line | `gcode/..` |

## Another chapter
"""
TREE = {
    "geometry/basic/point.h": "#pragma once\n#include <vector>\n",
    "geometry/distance/bounds.h": '#include "geometry/basic/point.h"\n',
    "gcode/text/number.h": "",
    "postproc/cli/values.h": "",
}
# What is planted (file, include), and a part of the complaint; none: it is kept.
PLANTED = [
    ("geometry/distance/more.cpp", '"geometry/basic/point.h"', ""),
    ("geometry/band/band.cpp", '"geometry/distance/bounds.h"', ""),
    ("geometry/distance/more.cpp", "<CGAL/Lazy_exact_nt.h>", ""),
    ("geometry/band/band.cpp", "<CGAL/Lazy_exact_nt.h>", ""),
    ("postproc/cli/cli_smooth.cpp", "<CLI/CLI.hpp>", ""),
    ("postproc/cli/cli.cpp", '"gcode/text/number.h"', ""),
    ("geometry/basic/point.h", '"geometry/distance/bounds.h"', "may not include geometry/distance/"),
    ("geometry/basic/point.cpp", '"gcode/text/number.h"', "may not include gcode/text/"),
    ("gcode/text/number.cpp", '"postproc/cli/values.h"', "may not include postproc/cli/"),
    ("gcode/text/number.cpp", '"../../geometry/basic/point.h"', "from the root"),
    ("gcode/text/number.cpp", '"number.h"', "from the root"),
    ("gcode/text/number.cpp", "<geometry/basic/point.h>", "in quotes"),
    ("geometry/distance/bounds.h", "<CGAL/Lazy_exact_nt.h>", "CGAL is included only"),
    ("gcode/text/number.cpp", "<CGAL/Lazy_exact_nt.h>", "CGAL is included only"),
    ("postproc/cli/cli.h", "<CLI/CLI.hpp>", "CLI is included only"),
    ("gcode/other/word.h", "<vector>", "no row of the table"),
    ("gcode/loose.h", "<vector>", "no row of the table"),
]


def complaints(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        return check.check(root)[0]


def main():
    wrong = []

    def expect(what, files, complaint):
        said = complaints(files)
        if not complaint and said or complaint and not any(complaint in line for line in said):
            wrong.append(f"{what}: expected {complaint or 'nothing'}, but: {said}")

    tree = {"docs/ARCHITECTURE.md": TABLE, **TREE}
    expect("the tree itself", tree, "")
    for file, include, complaint in PLANTED:
        expect(f"{file} with {include}", {**tree, file: f"// planted\n#include {include}\n"}, complaint)
    cycle = {"geometry/basic/a.h": '#include "geometry/basic/b.h"\n', "geometry/basic/b.h": "",
             "geometry/basic/b.cpp": '#include "geometry/basic/a.h"\n'}
    expect("pairs in a circle", {**tree, **cycle}, "include each other: geometry/basic/a, geometry/basic/b")
    expect("a row that looks down", {**tree, "docs/ARCHITECTURE.md": TABLE.replace(
        "| points | |", "| points | `geometry/band/` |")}, "no row above it")
    expect("no table", {**tree, "docs/ARCHITECTURE.md": "# Nothing\n"}, "no table of layers")
    expect("no sources", {"docs/ARCHITECTURE.md": TABLE}, "no sources")
    for line in wrong:
        print(line)
    print(f"{len(PLANTED) + 5} trees, {len(wrong)} judged wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
