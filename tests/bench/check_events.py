"""Fails when a segment of event-driven motion takes more instructions than it may, or a size that is read at run time
more than 1.3 times those of a compiled one.

Usage: check_events.py STEP_COUNT MOST
Example: check_events.py build/release/tests/bench/step_count 5000
"""
import sys

from callgrind_counts import count


def main(step_count, most):
    counts, facts = count(step_count, "events")
    compiled, any_size = (counts[size].mean / int(facts[f"{size}/segments"]) for size in ("compiled size", "any size"))
    print(f"{compiled:.0f} instructions a segment, {any_size:.0f} at a size that is read at run time")
    if compiled > most:
        sys.exit(f"more than {most} instructions a segment")
    if any_size > 1.3 * compiled:
        sys.exit("more than 1.3 times those of the compiled size")


if __name__ == "__main__":
    if len(sys.argv) != 3 or not sys.argv[2].isdigit():
        sys.exit(__doc__)
    main(sys.argv[1], int(sys.argv[2]))
