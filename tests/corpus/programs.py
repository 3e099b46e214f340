"""The programs of a folder that were not made for Batten, packed or not."""

import gzip

NOT_PROGRAMS = {".md", ".txt", ".json"}


def programs_in(folder):
    return sorted(f for f in folder.rglob("*")
                  if f.is_file() and f.suffix.lower() not in NOT_PROGRAMS)


def bytes_of(file):
    data = file.read_bytes()
    return gzip.decompress(data) if file.suffix == ".gz" else data
