"""keep_small.py MERGED KEPT: a few of the inputs of MERGED, short ones and long ones, become the content of KEPT."""
import pathlib
import shutil
import sys

MOST_BYTES, MOST_FILES = 12 * 1024, 24


def main(merged, kept):
    shutil.rmtree(kept, ignore_errors=True)
    kept.mkdir(parents=True)
    files = sorted(merged.iterdir(), key=lambda file: (file.stat().st_size, file.name))
    left = MOST_BYTES
    for file in files[-1::-max(len(files) // MOST_FILES, 1)][:MOST_FILES]:
        if file.stat().st_size <= left:
            left -= file.stat().st_size
            shutil.copy(file, kept / file.name)


if __name__ == "__main__":
    main(*map(pathlib.Path, sys.argv[1:]))
