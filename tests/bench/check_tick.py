"""Fails when a tick of the can_axis scenario takes more instructions than it may: bus, drive, axis and controller.

Usage: check_tick.py STEP_COUNT MOST
Example: check_tick.py build/release/tests/bench/step_count 20000
"""
import sys

from callgrind_counts import count


def main(step_count, most):
    counts, facts = count(step_count, "tick")
    whole, shortest = (counts[f"scenario/{name} run"].mean for name in ("whole", "shortest"))
    a_tick = (whole - shortest) / int(facts["scenario/ticks"])
    print(f"{a_tick:.0f} instructions a tick")
    if a_tick > most:
        sys.exit(f"more than {most} instructions a tick")


if __name__ == "__main__":
    if len(sys.argv) != 3 or not sys.argv[2].isdigit():
        sys.exit(__doc__)
    main(sys.argv[1], int(sys.argv[2]))
