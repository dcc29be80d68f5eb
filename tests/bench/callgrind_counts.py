"""Runs step_count under callgrind and reads what it counted."""
import os
import re
import statistics
import subprocess
import tempfile
from dataclasses import dataclass

EMPTY = "empty"  # the label of an empty call: what counting itself costs


@dataclass
class Counts:
    """Instructions of every call with one label, in order of the calls."""

    calls: list

    @property
    def least(self):
        return min(self.calls)

    @property
    def typical(self):
        return int(statistics.median_low(self.calls))

    @property
    def most(self):
        return max(self.calls)

    @property
    def mean(self):
        return statistics.fmean(self.calls)


def read_counts(lines):
    """Counts by label from a callgrind file of combined dumps, each less the count of an empty call."""
    raw, label, empty = {}, None, None
    for line in lines:
        if line.startswith("desc: Trigger: Client Request: "):
            label = line.split(": ", 3)[3].strip()
        elif line.startswith("totals: ") and label is not None:
            total = int(line.split()[1])
            if label == EMPTY:
                empty = total
            elif empty is None:
                raise ValueError(f"'{label}' was counted before an empty call")
            else:
                raw.setdefault(label, []).append(total - empty)
            label = None
    return {name: Counts(calls) for name, calls in raw.items()}


def count(step_count, part):
    """Counts of one part of step_count, and the facts that it prints ("fact NAME VALUE")."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "callgrind.out")
        run = subprocess.run(
            ["valgrind", "--quiet", "--tool=callgrind", "--instr-atstart=no", "--combine-dumps=yes",
             f"--callgrind-out-file={out}", step_count, part],
            check=True, stdout=subprocess.PIPE, text=True)
        with open(out, encoding="utf-8") as file:
            counts = read_counts(file)
    if not counts:
        raise ValueError(f"callgrind counted nothing in '{part}'")
    return counts, dict(re.findall(r"^fact (.+) (\S+)$", run.stdout, re.MULTILINE))
