#!/usr/bin/env python3
"""batches.py MOST FILE...

Which sources may be compiled as one: a line per batch of at most MOST files, separated by ';'.

What a source says in an anonymous namespace is its own only as long as it is compiled alone. So two
sources share a batch only where no such name of the one occurs anywhere in the other."""
import pathlib
import re
import sys

NAME = re.compile(r"[A-Za-z_]\w*")
NOT_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}", re.DOTALL | re.MULTILINE)
# At the begin of a line: what is not indented there is said for the whole file.
DECLARED = re.compile(r"^(?:using (\w+) =|(?:class|struct|enum class|enum|union) (\w+)|"
                      r"(?!using |namespace )[^\s#}].*?(?<!::)\b(\w+)\s*[({=;[])", re.MULTILINE)


def own_names(code):
    """Names that the file keeps for itself; some that are none do no harm."""
    names = set()
    for part in ANONYMOUS.findall(code):
        for found in DECLARED.finditer(part):
            names.update(name for name in found.groups() if name)
    return names


def batches_of(files, most):
    own, said = {}, {}
    for file in files:
        code = NOT_CODE.sub(" ", pathlib.Path(file).read_text())
        said[file] = set(NAME.findall(code))
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
