"""Compares what an emulated target replayed with what the host did, and reports what a step costs.

Usage: report.py TARGET FOLDER IMAGES_FOLDER

FOLDER/<scenario> holds the host's results, and FOLDER/emulated/<scenario> the target's with its counts. Leaves what was
counted and measured in FOLDER/costs.json for costs.py. Exit codes: 0 all bits are equal and no step, nor the coordination
of eight axes, takes more than its bound; 1 not so.
toolchain/emulate.sh calls it.
"""
import argparse
import glob
import json
import os
import statistics
import struct
import sys
from dataclasses import dataclass

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path += [os.path.join(ROOT, "toolchain"), os.path.join(ROOT, "tests", "bench")]
from check_image import examine  # noqa: E402

KINDS = ["approach", "coast", "hold", "kick of one period", "kick of many periods starts", "kick goes on", "lost sample",
         "fault"]
AXES = {"can_axis": "coast pd", "braked_axis": "coast brake", "move_axis": "move",
        "fine_axis": "fine stage", "presliding_axis": "pre-sliding", "belt_axis": "coast work"}  # by scenario
WORK, MOST_OF_WORK = "belt_axis", 330  # instructions of a step under the coast "work", on either core
PID = "can_axis/pid"
RUNS = [f"{axis}/{tape}" for axis in AXES for tape in ("axis", "hostile")] + [PID]  # by axis in the order of its image
RESULT = struct.Struct("<ffIBBBB")

# Eight axes under their coordinator, by the phase in which a period begins.
COORDINATED = "coordinated"
COORDINATED_RUNS = [f"{COORDINATED}/{tape}" for tape in ("axis", "hostile")]
COORDINATED_AXES = 8
PHASES = ["gather", "approach", "release", "choice", "pulse", "coast", "rest", "hold", "fault"]
APPROACH = PHASES.index("approach")
MOST_FOR_COORDINATION = 200  # instructions of a period beyond the own steps of its axes, that is their PD of the approach


@dataclass
class Target:
    core: str
    core_Hz: float
    most_instructions: int  # of a step of the law in float
    axes: int  # of the node that is run
    pieces: int  # in which a period of the node is counted
    cycles_per_instruction = 2  # a cautious mean
    period_s = 1e-3
    most_share = 0.05  # of the period, for the worst step of the whole node

    def share(self, instructions):
        return instructions * self.cycles_per_instruction / (self.core_Hz * self.period_s)


TARGETS = {"stm32f405": Target("M4F", 168e6, 540, 1, 1), "zynqmp_r5": Target("R5F", 500e6, 540, 2, 2)}


def read_results(path):
    with open(path, "rb") as file:
        return [RESULT.unpack(piece) for piece in iter(lambda: file.read(RESULT.size), b"")], open(path, "rb").read()


def compare(folder):
    """Steps that differ, by run; prints the first of each."""
    different = 0
    for name in RUNS + COORDINATED_RUNS:
        host, host_bytes = read_results(f"{folder}/{name}.results")
        target, target_bytes = read_results(f"{folder}/emulated/{name}.results")
        steps = [i for i in range(len(host)) if host_bytes[16 * i:16 * i + 16] != target_bytes[16 * i:16 * i + 16]]
        print(f"{name}: {len(host)} steps, {len(steps)} differ from the host's")
        if len(host) != len(target):
            sys.exit(f"{name}: the target replayed {len(target)} steps")
        if steps:
            print(f"  first at step {steps[0]}: host {host[steps[0]]}, target {target[steps[0]]}")
        different += len(steps)
    return different


def read_counts(path):
    with open(path, encoding="utf-8") as file:
        return [int(line) for line in file]


def target_counts(folder):
    """Instructions by run and kind, each less the count of an empty pair of marks."""
    by_kind = {}
    for axis in AXES:
        empty, *counts = read_counts(f"{folder}/emulated/{axis}/replay.counts")
        for name in (name for name in RUNS if name.startswith(f"{axis}/")):
            results, _ = read_results(f"{folder}/{name}.results")
            for result, instructions in zip(results, counts):
                by_kind.setdefault(f"{name}/{result[-1]}", []).append(instructions - empty)
            counts = counts[len(results):]
        if counts:
            sys.exit(f"{axis}: {len(counts)} counts belong to no step")
    return by_kind


def coordinated_counts(folder):
    """Instructions of whole periods by run and phase, and of the own steps of single axes: the PD of their approach."""
    empty, *counts = read_counts(f"{folder}/emulated/{COORDINATED}/replay.counts")
    periods, own = {}, []
    for name in COORDINATED_RUNS:
        phases = [result[-1] for result in read_results(f"{folder}/{name}.results")[0]]
        steps, counts = [count - empty for count in counts[:len(phases)]], counts[len(phases):]
        for first in range(0, len(phases), COORDINATED_AXES):
            axes = steps[first:first + COORDINATED_AXES]
            periods.setdefault(f"{name}/{phases[first]}", []).append(sum(axes))
            if name == COORDINATED_RUNS[0] and phases[first] == APPROACH:
                own += axes[:-1]  # the last axis closes the period, too
    if counts:
        sys.exit(f"{COORDINATED}: {len(counts)} counts belong to no step")
    return periods, own


def coordination(periods, own):
    """The most that a period takes beyond the own steps of its axes."""
    return max(max(calls) for calls in periods.values()) - COORDINATED_AXES * statistics.median_low(own)


def in_words(label):
    """<scenario>/<tape>/<kind> as a reader knows it."""
    axis, tape, kind = label.split("/")
    if axis == COORDINATED:
        return f"KickCoordinator, {COORDINATED_AXES} axes, {PHASES[int(kind)]}" + (", hostile" if tape == "hostile" else "")
    controller = "PidController" if f"{axis}/{tape}" == PID else f"AxisController, {AXES[axis]}"
    return f"{controller}, {KINDS[int(kind)]}" + (", hostile" if tape == "hostile" else "")


def worst_of_law(steps, axis=""):
    """Of one axis, or of all."""
    return max(max(calls) for label, calls in steps.items() if label.startswith(axis) and not label.startswith(f"{PID}/"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("target", choices=TARGETS)
    parser.add_argument("folder")
    parser.add_argument("images")
    a = parser.parse_args()
    target = TARGETS[a.target]
    different = compare(a.folder)
    steps = target_counts(a.folder)
    for label, calls in sorted(steps.items()):
        print(f"  {in_words(label):66} {len(calls):6} steps, {min(calls):4} to {max(calls):4} instructions")
    periods, own = coordinated_counts(a.folder)
    for label, calls in sorted(periods.items()):
        print(f"  {in_words(label):66} {len(calls):6} periods, {min(calls):4} to {max(calls):4} instructions")
    beyond = coordination(periods, own)
    print(f"  an axis' own step takes {statistics.median_low(own)}, and a period of {COORDINATED_AXES} at most {beyond} more than theirs")
    pieces = iter(read_counts(f"{a.folder}/emulated/node.counts"))
    node = [sum(period) for period in zip(*[pieces] * target.pieces)]
    print(f"  whole node, {target.axes} {'axis' if target.axes == 1 else 'axes'}: {min(node)} to {max(node)} instructions, "
          f"mean {statistics.fmean(node):.0f}; worst {target.share(max(node)):.2%} of 1 ms at "
          f"{target.core_Hz / 1e6:.0f} MHz and {target.cycles_per_instruction} cycles an instruction")
    images = {os.path.basename(path): examine(path) for path in sorted(glob.glob(f"{a.images}/*.elf"))}
    with open(f"{a.folder}/costs.json", "w", encoding="utf-8") as file:
        json.dump({"steps": steps, "coordinated": periods, "own": own, "node": node, "images": images}, file)
    worst, worst_of_work = worst_of_law(steps), worst_of_law(steps, f"{WORK}/")
    if (different or worst > target.most_instructions or worst_of_work > MOST_OF_WORK or beyond > MOST_FOR_COORDINATION
            or target.share(max(node)) > target.most_share):
        sys.exit(f"FAIL: {different} steps differ; the law's worst step takes {worst} of {target.most_instructions} "
                 f"instructions, that of the coast \"work\" {worst_of_work} of {MOST_OF_WORK}, coordination {beyond} of "
                 f"{MOST_FOR_COORDINATION}, the node's worst step "
                 f"{target.share(max(node)):.2%} of {target.most_share:.0%} of the period")


if __name__ == "__main__":
    main()
