"""Compares what an emulated target replayed with what the host did, and reports what a step costs.

Usage: report.py FOLDER HOST_REPLAY IMAGES_FOLDER [--costs COSTS.md]

FOLDER holds the host's results, and in FOLDER/emulated the target's with its counts. With --costs the counts on this
host are taken as well, by callgrind, and everything is written to a page. Exit codes: 0 all bits are equal and no step
of the law takes more than its bound; 1 not so. toolchain/emulate.sh calls it.
"""
import argparse
import datetime
import glob
import os
import statistics
import struct
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path += [os.path.join(ROOT, "toolchain"), os.path.join(ROOT, "tests", "bench")]
from callgrind_counts import Counts, count  # noqa: E402
from check_image import examine  # noqa: E402

MOST_INSTRUCTIONS = 600  # of a step of the law in float on a Cortex-M4F
CORE_HZ, PERIOD_S, CYCLES = 168e6, 1e-3, 2
KINDS = ["approach", "coast", "hold", "kick of one period", "kick of many periods starts", "kick goes on", "lost sample",
         "fault"]
RUNS = [("axis", "AxisController"), ("hostile", "hostile"), ("pid", "PidController")]  # in the order of the image
RESULT = struct.Struct("<ffIBBBB")


def read_results(path):
    with open(path, "rb") as file:
        return [RESULT.unpack(piece) for piece in iter(lambda: file.read(RESULT.size), b"")], open(path, "rb").read()


def compare(folder):
    """Steps that differ, by run; prints the first of each."""
    different = 0
    for name, _ in RUNS:
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
    empty, *counts = read_counts(f"{folder}/emulated/replay.counts")
    by_kind = {}
    for name, label in RUNS:
        results, _ = read_results(f"{folder}/{name}.results")
        for result, instructions in zip(results, counts):
            by_kind.setdefault(f"{label}/{result[-1]}", Counts([])).calls.append(instructions - empty)
        counts = counts[len(results):]
    return by_kind


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" + "|---:" * (len(head) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def spread(c):
    return (c.least, c.typical, c.most) if c else ("", "", "")


def share(instructions):
    return f"{100 * instructions * CYCLES / (CORE_HZ * PERIOD_S):.2f} %"


def steps_table(target, host):
    rows = []
    for kind, name in enumerate(KINDS):
        here = target.get(f"AxisController/{kind}")
        hostile = target.get(f"hostile/{kind}")
        rows.append((f"AxisController, {name}", *spread(here), hostile.most if hostile else "",
                     *spread(host.get(f"AxisController/{kind}"))))
    pid = [c for label, counts in target.items() if label == "PidController/0" for c in counts.calls]
    rows.append(("PidController, step", *spread(Counts(pid)), "", *spread(host.get("PidController/0"))))
    return table(["", "M4F: least", "typical", "most", "most, hostile", "x86: least", "typical", "most"], rows)


def page(target, host, loop, images):
    worst = max(c.most for label, c in target.items() if not label.startswith("PidController"))
    compiler = subprocess.run(["arm-none-eabi-g++", "--version"], check=True, stdout=subprocess.PIPE, text=True)
    sizes = [(f"`{name}`", f["flash"], f["ram"], f["stack"], f["stack_reserved"]) for name, f in images]
    node = Counts(loop)
    return f"""# What the image costs

Written by `toolchain/emulate.sh stm32f405 --costs`; do not edit. {datetime.date.today()},
{compiler.stdout.splitlines()[0]}, `-O2`.

## Instructions per control step, in float

Counted by a plugin of QEMU on the Cortex-M4F, by callgrind on x86-64 (`-O3`): exact, and the same in every run. One call
of `update`, less an empty one. 5000 steps of `sim/scenarios/can_axis.toml` in closed loop, one sample in 97 lost; PID on the
same samples. "Hostile" are 20000 samples that no axis would give, to look for the worst. Typical is the median.

{steps_table(target, host)}

The worst is {worst}; `toolchain/emulate.sh` fails above {MOST_INSTRUCTIONS}. The results of all steps, hostile ones included, are equal
to the host's bit for bit.

## Instructions per step of the whole node

Receive, supervise, control and queue what is to be sent, one axis: {node.least} least, {node.typical} typical, {node.most} most, over
{len(loop)} periods from power-on to the last target.

## Share of a period of 1 ms at 168 MHz

An instruction takes one cycle or a few (a division or square root 14), and the flash may make it wait; {CYCLES} cycles an
instruction is a cautious mean. Law, worst step: {share(worst)}. Whole node, worst step: {share(node.most)}, and on slcan the time
in which the serial line takes the characters on top (22 at 1 Mbaud: 220 us).

## Memory, in bytes

Flash and RAM as linked; RAM holds the reserved stack. The stack's bound is that of the longest chain of calls, with an
interrupt on top (`toolchain/check_image.py`).

{table(["image", "flash", "RAM", "stack at most", "stack reserved"], sizes)}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("host_replay")
    parser.add_argument("images")
    parser.add_argument("--costs")
    a = parser.parse_args()
    different = compare(a.folder)
    target = target_counts(a.folder)
    worst = max((c.most, label) for label, c in target.items() if not label.startswith("PidController"))
    for label, c in sorted(target.items()):
        run, kind = label.split("/")
        print(f"  {run + ', ' + KINDS[int(kind)]:45} {len(c.calls):6} steps, {c.least:4} to {c.most:4} instructions")
    loop = read_counts(f"{a.folder}/emulated/lockstep.counts")
    print(f"  whole node: {min(loop)} to {max(loop)} instructions, median {statistics.median_low(loop)}")
    if a.costs:
        host, _ = count(a.host_replay, a.folder)
        images = [(os.path.basename(path), examine(path)) for path in sorted(glob.glob(f"{a.images}/*.elf"))]
        with open(a.costs, "w", encoding="utf-8") as file:
            file.write(page(target, host, loop, images))
        print(f"wrote {a.costs}")
    if different or worst[0] > MOST_INSTRUCTIONS:
        sys.exit(f"FAIL: {different} steps differ; the worst step takes {worst[0]} of {MOST_INSTRUCTIONS} instructions")


if __name__ == "__main__":
    main()
