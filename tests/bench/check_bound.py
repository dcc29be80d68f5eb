"""Fails when a call of AxisController<float>::update takes more instructions than it may.

Usage: check_bound.py STEP_COUNT MOST
Example: check_bound.py build/release/tests/bench/step_count 700
"""
import sys

from callgrind_counts import count

PREFIX = "AxisController float/"


def main(step_count, most):
    counts, _ = count(step_count, "law")
    modes = {label.removeprefix(PREFIX): c for label, c in counts.items() if label.startswith(PREFIX)}
    for mode, c in sorted(modes.items()):
        print(f"{mode:28} {len(c.calls):5} calls, {c.least:4} to {c.most:4} instructions")
    needed = {"approach", "coast", "hold", "kick of one period", "kick of many periods starts", "kick goes on",
              "lost sample"}
    if missing := needed - modes.keys():
        sys.exit(f"the recorded run has no call of: {', '.join(sorted(missing))}")
    if worst := [f"{mode}: {c.most}" for mode, c in modes.items() if c.most > most]:
        sys.exit(f"more than {most} instructions in a step: {', '.join(worst)}")


if __name__ == "__main__":
    if len(sys.argv) != 3 or not sys.argv[2].isdigit():
        sys.exit(__doc__)
    main(sys.argv[1], int(sys.argv[2]))
