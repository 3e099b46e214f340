#!/usr/bin/env python3
"""batches.py MOST FILE...

Which sources may be compiled as one: a line per batch of at most MOST files, separated by ';'.

What a source says in an anonymous namespace is its own only as long as it is compiled alone. So two
sources share a batch only where no such name of the one occurs anywhere in the other, nor is declared
by a header that the other includes."""
import functools
import pathlib
import re
import sys

NAME = re.compile(r"[A-Za-z_]\w*")
NOT_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
# What is asked of a value or of the standard library is never found in an anonymous namespace.
ELSEWHERE = re.compile(r"(?:\.|->|\bstd::)\s*[A-Za-z_]\w*")
ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDED = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
OF_OTHERS = re.compile(r"^#include <([^>]+)>", re.MULTILINE)
END_OF_ANONYMOUS = re.compile(r"^\}  // namespace$", re.MULTILINE)  # clang-format sees to the comment
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}end\b", re.DOTALL | re.MULTILINE)
# At the begin of a line: what is not indented there is said for the whole file.
DECLARATION = re.compile(r"^(?!using namespace |namespace )[^\s#}].*", re.MULTILINE)
TYPE = re.compile(r"using (\w+) =|(?:class|struct|enum class|enum|union) (\w+)")
NAMED = re.compile(r"(::)?\b(\w+)\s*[({=;[]")

KEYWORDS = {"alignas", "const", "decltype", "explicit", "noexcept", "operator", "override", "requires",
            "sizeof", "static_assert", "void"}
# Every test says these; PrintTo says them of a type, which has a name of its own.
GOOGLE_TEST = {"TEST", "TEST_F", "TEST_P", "TYPED_TEST", "TYPED_TEST_SUITE", "INSTANTIATE_TEST_SUITE_P",
               "PrintTo"}


def name_in(declaration):
    """The name that a line declares for its file; nothing where it is a member's or a test's."""
    if found := TYPE.match(declaration):
        return found.group(1) or found.group(2)
    for found in NAMED.finditer(declaration):
        if found.group(2) not in KEYWORDS:
            return None if found.group(1) or found.group(2) in GOOGLE_TEST else found.group(2)
    return None


def declared_in(code):
    """Names that are declared at the begin of lines; some that are none do no harm."""
    return {name for line in DECLARATION.findall(code) if (name := name_in(line))}


def own_names(code):
    """Names that the file keeps for itself."""
    return set().union(*(declared_in(part) for part in ANONYMOUS.findall(code)))


def headers_of(file, text):
    """The project's headers that a file names: from the root, or from its own folder."""
    for name in INCLUDED.findall(text):
        for folder in (ROOT, file.parent):
            if (folder / name).is_file():
                yield (folder / name).resolve()
                break


@functools.cache
def declared_by(header):
    """Names that are known behind the header: its own, and those of the headers that it includes."""
    text = header.read_text()
    names = declared_in(NOT_CODE.sub(" ", text))
    return names.union(*(declared_by(other) for other in headers_of(header, text)))


def rivals_of(files):
    """For each file those that it must not share a batch with."""
    own, said = {}, {}
    for file in files:
        text = END_OF_ANONYMOUS.sub("}end", pathlib.Path(file).read_text())
        code = NOT_CODE.sub(" ", text)
        headers = headers_of(pathlib.Path(file), text)
        own[file] = own_names(code)
        said[file] = own[file].union(NAME.findall(ELSEWHERE.sub(" ", code)),
                                     *(declared_by(header) for header in headers))
    return {file: {other for other in files if other != file and
                   (own[file] & said[other] or own[other] & said[file])} for file in files}


@functools.cache
def library_headers(file):
    """The headers of other libraries behind a file: to read them takes most of the time."""
    text = file.read_text()
    return set(OF_OTHERS.findall(text)).union(*(library_headers(own) for own in headers_of(file, text)))


class Batch:
    def __init__(self):
        self.files = []
        self.headers = set()

    def add(self, file):
        self.files.append(file)
        self.headers |= library_headers(pathlib.Path(file))

    def knows(self, file):
        """How many of the file's headers are read anyway."""
        return len(self.headers & library_headers(pathlib.Path(file)))


def batches_of(files, most):
    rivals = rivals_of(files)
    batches = []
    # Those that fit with few others first, while there is room.
    for file in sorted(files, key=lambda file: (-len(rivals[file]), file)):
        free = [batch for batch in batches
                if len(batch.files) < most and rivals[file].isdisjoint(batch.files)]
        if not free:
            free = [Batch()]
            batches += free
        max(free, key=lambda batch: batch.knows(file)).add(file)
    return [sorted(batch.files) for batch in batches]


if __name__ == "__main__":
    for batch in batches_of(sys.argv[2:], int(sys.argv[1])):
        print(";".join(batch))
