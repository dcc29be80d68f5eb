"""Branch coverage from llvm-cov's export: the union over all programs and all instantiations of a template.

    toolchain/coverage.py ROOT EXPORT... [--rooms ROOM...] [--missed | --page]

A branch is one outcome, true or false, of one condition as it stands in the source. What is decided as the program is
compiled (if constexpr) is none, nor is the head of a switch: the compiler refuses one without a case for every enumerator.
"""
import argparse
import json
import os
import pathlib
import re
import tomllib

ROOMS = ("controller/law", "controller/identify", "controller/design", "controller/stability", "controller/input",
         "hal/include", "hal/canopen", "hal/cia402", "hal/odrive", "hal/ports")
REASONS = pathlib.Path(__file__).with_name("coverage_reasons.toml")
HEAD = """# Branch coverage of controller and hal

Written by `toolchain/coverage.sh --write`: how many outcomes, true and false, of the conditions in each room came when the
tests of controller, hal, firmware and of the reading of descriptions, the closed-loop tests and the fuzzers' corpora were
run once; the campaigns are not counted. Instantiations of a
template count as one; what is decided as the program is compiled is no condition.
"""


def outcomes_of(exports, root):
    """Of every condition by (file, line, column, end line, end column): how often it was true, and false."""
    seen = {}
    for export in exports:
        for function in json.loads(pathlib.Path(export).read_text())["data"][0]["functions"]:
            for branch in function.get("branches", ()):
                file = os.path.normpath(function["filenames"][branch[6]])
                if not file.startswith(f"{root}/"):
                    continue
                place = (file[len(root) + 1:], *branch[:4])
                true, false = seen.get(place, (0, 0))
                seen[place] = true + branch[4], false + branch[5]
    return seen


class Sources:
    """The text of the files below a folder, each read once."""

    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.lines = {}

    def line(self, file, number):
        if file not in self.lines:
            self.lines[file] = (self.root / file).read_text().split("\n")
        return self.lines[file][number - 1]

    def condition(self, place):
        file, line, column, end_line, end_column = place
        text = self.line(file, line)
        return text[column - 1:] if line != end_line else text[column - 1:end_column - 1]

    def is_decided(self, place):
        """By the compiler, or by cases that are conditions of their own, or in a comparison that the compiler writes."""
        line = self.line(place[0], place[1])
        return bool(re.search(r"\bif constexpr\b|static_assert|= default;", line) or
                    re.search(r"\bswitch \($", line[:place[2] - 1]))


def missed_of(seen, sources):
    """[(place, outcome, text)] of each outcome that never came, and the number of all."""
    missed, count = [], 0
    for place, counts in sorted(seen.items()):
        if sources.is_decided(place):
            continue
        # A case is taken or another one is; that it is not is no outcome of its own.
        is_case = re.match(r"case\b|default\b", sources.condition(place)) is not None
        outcomes = (("taken", counts[0]),) if is_case else (("true", counts[0]), ("false", counts[1]))
        count += len(outcomes)
        missed += [(place, name, sources.condition(place)) for name, times in outcomes if times == 0]
    return missed, count


def table_of(seen, sources, rooms):
    """The lines of the table, and all that was missed."""
    lines, all_missed, total = ["| room | branches | never taken | taken |", "|---|---|---|---|"], [], 0
    for room in rooms:
        missed, count = missed_of({p: c for p, c in seen.items() if p[0].startswith(f"{room}/")}, sources)
        if count > 0:
            lines.append(f"| {room} | {count} | {len(missed)} | {100 * (1 - len(missed) / count):.2f} % |")
        all_missed += missed
        total += count
    if total > 0:
        lines.append(f"| all | {total} | {len(all_missed)} | {100 * (1 - len(all_missed) / total):.2f} % |")
    return lines, all_missed


def reason_of(missed, reasons):
    (file, *_), outcome, text = missed
    found = [r["reason"] for r in reasons if file.endswith(r["file"]) and r["condition"] in text and
             r.get("outcome", outcome) == outcome]
    return found[0] if found else "no reason: a test is missing"


def page(lines, missed):
    reasons = tomllib.loads(REASONS.read_text())["unreached"]
    grouped = {}
    for one in missed:
        grouped.setdefault(reason_of(one, reasons), []).append(one)
    text = [HEAD, *lines, "", "## What never came, and why", ""]
    for reason, ones in grouped.items():
        text.append(f"- {reason}:")
        text += [f"  - `{place[0]}:{place[1]}`: `{condition}`, {outcome}" for place, outcome, condition in ones]
    return "\n".join(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root")
    parser.add_argument("exports", nargs="+")
    parser.add_argument("--rooms", nargs="+", default=ROOMS)
    parser.add_argument("--missed", action="store_true", help="list every outcome that never came")
    parser.add_argument("--page", action="store_true", help="the page with the table and a reason for each")
    options = parser.parse_args()
    sources = Sources(options.root)
    lines, missed = table_of(outcomes_of(options.exports, options.root), sources, options.rooms)
    if options.page:
        print(page(lines, missed))
        return
    print("\n".join(lines))
    for place, outcome, text in missed if options.missed else ():
        print(f"{place[0]}:{place[1]}:{place[2]}: never {outcome}: {text}")


if __name__ == "__main__":
    main()
