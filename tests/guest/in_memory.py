"""What the cases start, for toolchain/guest.sh --in-memory: a line for each program, module and folder.

    in_memory.py BUILD FOLDER...

Run by the Python that the guest has. bench.py refuses to start other programs than these.
"""
import os
import shutil
import sys

import can  # noqa: F401: peers/ask.py starts with it

import linux_node  # noqa: F401: brings what the cases use
import slcan_adapter  # noqa: F401
from bench import BUILT, PROGRAMS


def modules():
    """The source of each module that was loaded to get here, and what Python compiled of it."""
    places = [getattr(module, name, None) for module in list(sys.modules.values()) for name in ("__file__", "__cached__")]
    return [place for place in places if place and os.path.exists(place)]


def main(build, folders):
    missing = [program for program in PROGRAMS if not shutil.which(program)]
    if missing:
        sys.exit(f"in_memory.py: not installed: {', '.join(missing)}")
    places = [shutil.which(program) for program in PROGRAMS] + [f"{build}/{program}" for program in BUILT]
    print("\n".join([*places, *modules(), *folders]))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
