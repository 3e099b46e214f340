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
ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDED = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
END_OF_ANONYMOUS = re.compile(r"^\}  // namespace$", re.MULTILINE)  # clang-format sees to the comment
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}end\b", re.DOTALL | re.MULTILINE)
# At the begin of a line: what is not indented there is said for the whole file.
DECLARED = re.compile(r"^(?:using (\w+) =|(?:class|struct|enum class|enum|union) (\w+)|"
                      r"(?!using |namespace )[^\s#}].*?(?<!::)\b(\w+)\s*[({=;[])", re.MULTILINE)


# Every test says these.
GOOGLE_TEST = {"TEST", "TEST_F", "TEST_P", "TYPED_TEST", "TYPED_TEST_SUITE", "INSTANTIATE_TEST_SUITE_P"}


def own_names(code):
    """Names that the file keeps for itself; some that are none do no harm."""
    names = set()
    for part in ANONYMOUS.findall(code):
        for found in DECLARED.finditer(part):
            names.update(name for name in found.groups() if name)
    return names - GOOGLE_TEST


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
    names = {name for found in DECLARED.finditer(NOT_CODE.sub(" ", text)) for name in found.groups() if name}
    return names.union(*(declared_by(other) for other in headers_of(header, text)))


def batches_of(files, most):
    own, said = {}, {}
    for file in files:
        text = END_OF_ANONYMOUS.sub("}end", pathlib.Path(file).read_text())
        code = NOT_CODE.sub(" ", text)
        headers = headers_of(pathlib.Path(file), text)
        said[file] = set(NAME.findall(code)).union(*(declared_by(header) for header in headers))
        own[file] = own_names(code)
    batches = []
    for file in files:
        for batch in batches:
            if len(batch) < most and not any(
                    own[file] & said[other] or own[other] & said[file]
                    for other in batch):
                batch.append(file)
                break
        else:
            batches.append([file])
    return batches


for batch in batches_of(sys.argv[2:], int(sys.argv[1])):
    print(";".join(batch))
