"""Checks that no source file includes, and no target links, a room that its own room may not use.

The rooms and their arrows stand in arrows.txt. `includes` looks at a tree of sources, `links` at a file of lines `room room...`: a
target and what it links. `selftest` adds each forbidden include and link in turn to what is good otherwise, and expects it to be named: a guard
that has never been seen to fail guards nothing.

Example: python3 arrows.py includes /path/to/breakaway
"""

import pathlib
import re
import sys
import tempfile

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]breakaway/(\w+)/')
PRODUCT = ("controller", "hal", "firmware", "sim")
EXEMPT = ("firmware/examples",)  # these show the whole to a user, from outside


def read_rooms(table):
    """Folder -> (name, rooms it may use), the longest folder first so that an inner room hides the outer one."""
    rooms = {}
    for line in table.read_text().splitlines():
        words = line.split("#")[0].split()
        if words:
            folder, name, *uses = words
            rooms[folder] = (name, set(uses) | {name})
    return dict(sorted(rooms.items(), key=lambda room: -len(room[0])))


def room_of(path, rooms):
    return next((folder for folder in rooms if path.startswith(folder + "/")), None)


def wrong_names(rooms):
    names = {name for name, _ in rooms.values()}
    return [f"arrows.txt: {folder} uses {use}, which is no room" for folder, (_, uses) in rooms.items() for use in uses - names]


def cycles(rooms):
    """An arrow back, stated in the table itself."""
    uses = {name: rooms_used - {name} for name, rooms_used in rooms.values() if name != "-"}

    def reaches(start, goal, seen):
        return any(
            use == goal or (use not in seen and not seen.add(use) and reaches(use, goal, seen)) for use in uses.get(start, ())
        )

    return [f"arrows.txt: {name} is reached from itself" for name in uses if reaches(name, name, set())]


def check_text(path, text, rooms, names):
    folder = room_of(path, rooms)
    if folder is None:
        return [f"{path}: stands in no room of arrows.txt"]
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        include = INCLUDE.match(line)
        if not include:
            continue
        other = include.group(1)
        if other not in names:
            found.append(f"{path}:{number}: breakaway/{other} is no room of arrows.txt")
        elif other not in rooms[folder][1]:
            found.append(f"{path}:{number}: {folder} may not use {other}")
    return found


def check_includes(root, rooms):
    names = {name for name, _ in rooms.values()}
    found = wrong_names(rooms) + cycles(rooms)
    for top in PRODUCT:
        for path in sorted((root / top).rglob("*.?pp")):
            relative = path.relative_to(root).as_posix()
            if not relative.startswith(EXEMPT):
                found += check_text(relative, path.read_text(), rooms, names)
    return found


def check_links(lines, rooms):
    allowed = {name: uses for name, uses in rooms.values()}
    found = []
    for line in lines:
        target, *linked = line.split()
        found += [f"{target} may not link {other}" for other in linked if other not in allowed.get(target, ())]
    return found


def selftest(rooms):
    """The number of forbidden arrows that were tried, and those that went unnoticed."""
    names = {name for name, _ in rooms.values()} - {"-"}
    tried, missed = 0, []
    for folder, (_, uses) in rooms.items():
        for other in sorted(names - uses):
            with tempfile.TemporaryDirectory() as scratch:
                root = pathlib.Path(scratch)
                for suffix, include in (("hpp", f'#include "breakaway/{other}/any.hpp"'), ("cpp", f"#  include <breakaway/{other}/any.hpp>")):
                    file = root / folder / f"added.{suffix}"
                    file.parent.mkdir(parents=True, exist_ok=True)
                    file.write_text(include + "\n")
                    tried += 1
                    if check_includes(root, rooms) != [f"{folder}/added.{suffix}:1: {folder} may not use {other}"]:
                        missed.append(f"{folder} -> {other} in a .{suffix}")
                    file.unlink()
            own = rooms[folder][0]
            if own != "-":
                tried += 1
                if check_links([f"{own} {other}"], rooms) != [f"{own} may not link {other}"]:
                    missed.append(f"{own} links {other}")
    return tried, missed


def main():
    rooms = read_rooms(pathlib.Path(__file__).with_name("arrows.txt"))
    command, *path = sys.argv[1:]
    if command == "selftest":
        tried, found = selftest(rooms)
        print(f"{tried} forbidden arrows tried, {len(found)} unnoticed")
    elif command == "links":
        lines = pathlib.Path(path[0]).read_text().splitlines()
        found = check_links(lines, rooms)
        print(f"{len(lines)} targets, {len(found)} arrows back")
    else:
        found = check_includes(pathlib.Path(path[0]), rooms)
        print(f"{len(rooms)} rooms, {len(found)} arrows back")
    print(*found, sep="\n")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
