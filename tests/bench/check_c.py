"""Fails when a step of the law takes more instructions through its C interface than by the class, by more than it may.

Usage: check_c.py STEP_COUNT MOST_MORE
Example: check_c.py build/release/tests/bench/step_count 5
"""
import sys

from callgrind_counts import count


def main(step_count, most_more):
    counts, _ = count(step_count, "c")
    steps = len(counts) // 2
    more = [counts[f"C {i}"].most - counts[f"C++ {i}"].most for i in range(steps)]
    print(f"{steps} steps: {min(more)} to {max(more)} instructions more, {sum(more) / steps:.1f} in the mean")
    if max(more) > most_more:
        sys.exit(f"more than {most_more} instructions more in a step")


if __name__ == "__main__":
    if len(sys.argv) != 3 or not sys.argv[2].isdigit():
        sys.exit(__doc__)
    main(sys.argv[1], int(sys.argv[2]))
