"""The files of guest.sh --in-memory: what programs and folders consist of.

    guest_files.py PATH...

Prints each file and each link on the way to it, ended by NUL, as `cpio -0` takes them. A program has its libraries with it,
and a folder everything below it.
"""
import os
import re
import subprocess
import sys


def libraries_of(path):
    """What the loader maps besides the program; nothing of a file that is none."""
    with open(path, "rb") as file:
        if file.read(4) != b"\x7fELF":
            return []
    # It ends with an error for a program without libraries.
    shown = subprocess.run(["ldd", path], capture_output=True, text=True, check=False).stdout
    return re.findall(r"(/\S+) \(0x", shown)


def files_below(path):
    if not os.path.isdir(path):
        return [path]
    return [os.path.join(folder, name) for folder, _, names in os.walk(path) for name in names]


def on_the_way(path):
    """The links that the path goes through, and the file that it leads to."""
    found, done, rest = [], "/", os.path.abspath(path).split("/")[1:]
    while rest:
        part = rest.pop(0)
        place = os.path.normpath(os.path.join(done, part))
        if os.path.islink(place):
            found.append(place)
            target = os.readlink(place)
            rest = target.split("/") + rest
            done = "/" if target.startswith("/") else done
        else:
            done = place
    return [*found, done]


def main(paths):
    listed = {}
    for path in paths:
        if not os.path.exists(path):
            sys.exit(f"guest_files.py: {path} is not there")
        for file in files_below(path):
            if os.path.exists(file):
                listed |= dict.fromkeys(place for needed in (file, *libraries_of(file)) for place in on_the_way(needed))
    sys.stdout.write("".join(f"{place}\0" for place in listed if not os.path.isdir(place) or os.path.islink(place)))


if __name__ == "__main__":
    main(sys.argv[1:])
