"""Checks that every link from a page of the tree to another place of the tree leads there, heading included.

Example: python3 links.py /path/to/breakaway
"""

import pathlib
import re
import sys

LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)


def anchors(page):
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in HEADING.findall(page.read_text())}


def wrong_links(root, page):
    for link in LINK.findall(page.read_text()):
        if "://" in link:
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists():
            yield f"{page.relative_to(root)}: {link} leads nowhere"
        elif anchor and anchor not in anchors(target):
            yield f"{page.relative_to(root)}: {link} has no such heading"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    pages = [root / "README.md", root / "CHANGELOG.md", *root.glob(".github/*.md")]
    for room in ("controller", "hal", "firmware", "sim", "tests"):
        pages += sorted((root / room).rglob("*.md"))
    found = [wrong for page in pages for wrong in wrong_links(root, page)]
    print(f"{len(pages)} pages, {len(found)} wrong links", *found, sep="\n")
    return 1 if found or len(pages) < 15 else 0


if __name__ == "__main__":
    sys.exit(main())
