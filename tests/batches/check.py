#!/usr/bin/env python3
"""Which sources cmake/batches.py lets share a batch, asked of small ones that are made for it."""
import pathlib
import subprocess
import sys
import tempfile

BATCHES = pathlib.Path(__file__).resolve().parent.parent.parent / "cmake" / "batches.py"

ALONE = "namespace {\n\n%s\n\n}  // namespace\n"
# What it is about, two sources, and whether they may be compiled as one.
CASES = [
    ("names of their own", ALONE % "int one() { return 1; }", ALONE % "int two() { return 2; }", True),
    ("the same function", ALONE % "int one() { return 1; }", ALONE % "double one() { return 1; }", False),
    ("the same type", ALONE % "struct One {};", ALONE % "using One = int;", False),
    ("the same constant", ALONE % "constexpr int kOne = 1;", ALONE % "constexpr double kOne{1};", False),
    ("a function that the other calls", ALONE % "int one() { return 1; }", "int two() { return one(); }", False),
    ("a function with a name of the library", ALONE % "int max() { return 1; }",
     "int two() { return std::max(1, 2); }", True),
    ("a function with a member's name", ALONE % "int size() { return 1; }",
     "int two(List& a, List* b) { return a.size() + b->size(); }", True),
    ("a name that is said in text only", ALONE % "int one() { return 1; }", 'auto two = "one"; // one', True),
    ("members out of their class", ALONE % "struct A {};\nint A::get() const { return 1; }",
     ALONE % "struct B {};\nint B::get() const { return 1; }", True),
    ("a function after a keyword", ALONE % "alignas(8) int one() { return 1; }",
     ALONE % "int two() { return one(); }", False),
    ("tests of one line", ALONE % "TEST(A, IsOne) { EXPECT_EQ(one(), 1); }",
     ALONE % "TEST(B, IsTwo) { EXPECT_EQ(two(), 2); }", True),
]


def batches(most, sources):
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for number, text in enumerate(sources):
            files.append(pathlib.Path(folder) / f"{number}.cpp")
            files[-1].write_text(text)
        said = subprocess.run([sys.executable, "-B", BATCHES, str(most), *files], check=True,
                              capture_output=True, text=True).stdout
        return [[int(pathlib.Path(file).stem) for file in line.split(";")] for line in said.splitlines()]


failed = [about for about, one, other, together in CASES
          if batches(16, [one, other]) != ([[0, 1]] if together else [[0], [1]])]
own = [ALONE % f"int f{number}() {{ return 1; }}" for number in range(5)]
if sorted(map(len, batches(2, own))) != [1, 2, 2]:
    failed.append("no more than two in a batch")
if sorted(sum(batches(2, own), [])) != [0, 1, 2, 3, 4]:
    failed.append("every source once")
heavy = ["#include <heavy>\n" + text for text in own[:2]]
rivals = [ALONE % "int same() { return 1; }", "#include <heavy>\n" + ALONE % "int same() { return 2; }"]
if [1, 2, 3] not in batches(3, [rivals[0], rivals[1], *heavy]):
    failed.append("sources that read the same headers of a library")
for about in failed:
    print("not as it should be:", about)
sys.exit(len(failed) > 0)
