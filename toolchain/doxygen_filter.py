"""Prints a C++ header with its plain comments as Doxygen's, so that they need no marks of their own in the source.

Comments above a declaration become `///`, those behind one `///<`, and those at the head of the file describe the file. What is
indented in a comment is code or a table and stays as it is; everything else is text, in which no character is a command.

Example: python3 doxygen_filter.py hal/include/breakaway/hal/can_port.hpp
"""

import pathlib
import re
import sys

BESIDE = re.compile(r'^(?P<code>(?:[^"/]|/(?!/)|"(?:[^"\\]|\\.)*")*?\S)\s*// (?P<text>.*)$')
MEMBER = re.compile(r"[;,]$|^\s*\w+$|^\s*\w+ = [^;]*$")  # behind these a comment describes them; elsewhere it is the code's
SPECIAL = re.compile(r"[\\@#<>&%\"*_`~^$]")


def escaped(text):
    return SPECIAL.sub(lambda character: f"&#{ord(character.group())};", text)


def block(indent, lines):
    """A comment above something."""
    printed, verbatim = [], False
    for line in lines:
        code = line.startswith("   ") or (verbatim and not line)
        if code != verbatim:
            printed.append("@verbatim" if code else "@endverbatim")
            verbatim = code
        printed.append(line if code else escaped(line.strip()))
    if verbatim:
        printed.append("@endverbatim")
    return [f"{indent}/// {line}".rstrip() for line in printed]


def converted(source):
    printed, lines, at_head = [], source.splitlines(), True
    place = 0
    while place < len(lines):
        comment = re.match(r"^(\s*)//(.*)$", lines[place])
        if comment:
            indent, body = comment.group(1), []
            while place < len(lines) and (found := re.match(r"^\s*//(.*)$", lines[place])):
                body.append(found.group(1))
                place += 1
            body = [line for line in body if not line.startswith(" clang-format")]
            printed += ["/// @file", "///"] if at_head else []
            printed += block(indent, body)
            printed += [""] if at_head else []
            at_head = False
            continue
        beside = BESIDE.match(lines[place])
        if beside and MEMBER.search(beside["code"]):
            printed.append(f"{beside['code']}  ///< {escaped(beside['text'])}")
        else:
            printed.append(lines[place])
        place += 1
    return "\n".join(printed)


if __name__ == "__main__":
    print(converted(pathlib.Path(sys.argv[1]).read_text()))
