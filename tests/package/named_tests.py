"""Checks that every test that a page of the tree names is in the tree: `Suite.Name`, where * stands for any part of it.

Example: python3 named_tests.py /path/to/breakaway
"""

import fnmatch
import pathlib
import re
import sys

ROOMS = ("controller", "hal", "firmware", "sim", "tests")
DEFINED = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)|\bTYPED_TEST\(\s*(\w+),\s*(\w+)\s*\)")
NAMED = re.compile(r"`([A-Z][a-z]\w*\.[A-Z][a-z][\w*]*)`")


def defined(root):
    for room in ROOMS:
        for source in (root / room).rglob("*.cpp"):
            for groups in DEFINED.findall(source.read_text()):
                yield ".".join(word for word in groups if word)


def pages(root):
    yield from (page for page in (root / "README.md", root / "CHANGELOG.md") if page.exists())
    for room in ROOMS:
        yield from sorted((root / room).rglob("*.md"))


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    tests = set(defined(root))
    named = [(page.relative_to(root), name) for page in pages(root) for name in NAMED.findall(page.read_text())]
    wrong = [f"{page}: {name} is no test" for page, name in named if not fnmatch.filter(tests, name)]
    print(f"{len(tests)} tests, {len(named)} of them named, {len(wrong)} wrongly", *wrong, sep="\n")
    return 1 if wrong or len(named) < 30 else 0


if __name__ == "__main__":
    sys.exit(main())
