"""Writes RESULTS.md from the counts of step_count and one run of breakaway_bench.

Usage: write_results.py STEP_COUNT BENCHMARK_JSON COMPILER RESULTS.md
toolchain/bench.sh calls it.
"""
import datetime
import json
import os
import platform
import sys

from callgrind_counts import Counts, count

COMMAND = "toolchain/bench.sh"
KINDS = ["approach", "coast", "hold", "kick of one period", "kick of many periods starts", "kick goes on",
         "lost sample"]
DRIVE_PARTS = ["on_frame, its feedback", "on_frame, another drive's feedback", "update", "feedback",
               "command and next_command_frame", "next_acyclic_frame"]
AXES = [1, 2, 4, 8]


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" + "|---:" * (len(head) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def spread(name, c):
    return name, c.least, c.typical, c.most


def steps_table(counts):
    def pair(name, label):
        single, double = counts[f"{label[0]} float/{label[1]}"], counts[f"{label[0]} double/{label[1]}"]
        return *spread(name, single), len(single.calls), *spread(name, double)[1:]

    everything = {real: Counts(sum((counts[f"AxisController {real}/{k}"].calls for k in KINDS), []))
                  for real in ("float", "double")}
    rows = [pair(f"AxisController, {kind}", ("AxisController", kind)) for kind in KINDS]
    rows.append((*spread("**AxisController, all steps of the run**", everything["float"]),
                 len(everything["float"].calls), *spread("", everything["double"])[1:]))
    rows.append(pair("**PidController, step**", ("PidController", "step")))
    rows.append(pair("PidController, lost sample", ("PidController", "lost sample")))
    return table(["", "float: least", "typical", "most", "calls", "double: least", "typical", "most"], rows)


def loop_table(counts, facts):
    rows = []
    for n in AXES:
        running = counts[f"ControlLoop {n}/running"]
        rows.append((n, facts[f"ControlLoop {n}/period_us"], *spread("", running)[1:], round(running.typical / n),
                     counts[f"ControlLoop {n}/set-up"].most))
    return table(["axes", "period in us", "least", "typical", "most", "typical per axis", "most, in set-up"], rows)


def k3_table(counts, facts):
    rows = [(*spread(name, counts[name]), facts[f"{name}/bytes"], facts.get(f"{name}/proved error", bound))
            for name, bound in [("K3Table float", ""), ("K3Table double", ""), ("K3 double", "1e-14")]]
    return table(["", "least", "typical", "most", "bytes", "relative error at most"], rows)


def simulation_table(counts, facts, loop_mean):
    ticks = int(facts["scenario/ticks"])
    whole = (counts["scenario/whole run"].most - counts["scenario/shortest run"].most) / ticks
    friction = "plant, friction of can_axis"
    moving, resting = counts[f"{friction}/moving"], counts[f"{friction}/resting"]
    plant = Counts(moving.calls + resting.calls).mean
    emulated = counts["scenario/plant and drive emulator"].mean
    parts = [("plant", plant), ("drive emulator", emulated - plant), ("control loop (flashed)", loop_mean),
             ("bus and bookkeeping (the rest)", whole - emulated - loop_mean), ("**whole scenario**", whole)]
    return table(["a tick of can_axis", "instructions, mean", "share"],
                 [(name, f"{n:.0f}", f"{100 * n / whole:.0f} %") for name, n in parts])


def plant_table(counts):
    labels = [f"plant, {friction}/{state}" for friction in ("constant friction", "friction of can_axis")
              for state in ("moving", "resting")]
    return table(["a tick of the plant", "least", "typical", "most"],
                 [spread(label.removeprefix("plant, ").replace("/", ", "), counts[label]) for label in labels])


def ratios_table(times):
    pid = times["PidController float/all steps"]
    copy = times["AxisController float/copy"]
    rows = [(name.replace("/", ", "), f"{times[name] / pid:.2f}") for name in
            ("PidController float/all steps", "PidController double/all steps", "AxisController float/all steps",
             "AxisController double/all steps")]
    rows += [(f"AxisController float, {kind}", f"{(times[f'AxisController float/{kind}'] - copy) / pid:.2f}")
             for kind in KINDS]
    rows += [(name, f"{times[name] / pid:.2f}") for name in ("K3Table float", "K3Table double", "K3 double")]
    rows += [(f"ControlLoop float, {n} {'axis' if n == 1 else 'axes'}", f"{times[f'ControlLoop {n}'] / pid:.1f}") for n in AXES]
    rows += [(name, f"{times[name] / pid:.1f}") for name in
             ("plant, constant friction", "plant, friction of can_axis", "whole scenario, with its set-up")]
    return table(["time of one step, call or tick", "in steps of the PID in float"], rows)


def read_times(path):
    """Time of one step by benchmark: the median of its repetitions."""
    with open(path, encoding="utf-8") as file:
        runs = json.load(file)["benchmarks"]
    return {run["run_name"]: run["each"] for run in runs if run.get("aggregate_name") == "median"}


def main(step_count, benchmark_json, compiler, results):
    counts, facts = {}, {}
    for part in ("law", "k3", "drive", "loop", "simulation"):
        part_counts, part_facts = count(step_count, part)
        counts |= part_counts
        facts |= part_facts
    page = f"""# What a step costs

Written by `{COMMAND}`; do not edit. {datetime.date.today()}, {compiler}, {platform.machine()}, `-O3`.

Counts are instructions by callgrind: the same in every run of the same binary under any load (a processor with other
vector instructions may get other variants of the C library's functions). A count is of one call as compiled, less an empty
call. The axis is that of `sim/scenarios/can_axis.toml`, started at rest and sent
over a tour of five targets from 4 m down to 20 um; one sample in 97 is lost. All parts are counted on the recorded input
that they had in that closed loop. Typical is the median.

## Instructions per control step

{steps_table(counts)}

A step does bounded work, whatever came before it: the test `bench.step_work_is_bounded` (`ctest -L bench`) fails when a
step of AxisController in float takes more instructions than the bound that it states.

## Instructions per step of the whole loop, in float

Receive, supervise, control and send, with the CANopen and CiA 402 side of all drives; without the bus and the drives
themselves. Every period is the shortest in whole milliseconds that fits the bus of 1 Mbit/s.

{loop_table(counts, facts)}

A drive is handed the frames of its own node only, so the cost grows with the number of axes and no faster.
The parts of one drive:

{table(["cia402::Drive", "least", "typical", "most"], [spread(p, counts[f"Drive/{p}"]) for p in DRIVE_PARTS])}

## Evaluators of k3

Instructions of one impulse_Ns, over 200 position errors from a millionth of the stick set to all of it. The error of a
table is the one proved when it is built, that of the exact law the one that its tests hold it to.

{k3_table(counts, facts)}

## What simulation costs

Instructions per simulated tick of 1 ms, over the approach and the kicks to the first target. The whole scenario is what
`breakaway simulate` runs, less a scenario that ends at once, so that set-up does not count.

{simulation_table(counts, facts, counts["ControlLoop 1/running"].mean)}

{plant_table(counts)}

## Ratios in one run

Times of Google Benchmark, each divided by the time of a PID step in float in the same run: the only form in which times
say something beyond the machine that they were taken on, and still the softest figures here. Medians of interleaved
repetitions. The kinds of step run on copies of the controller, and the time of the copy is taken off.

{ratios_table(read_times(benchmark_json))}

## To renew this page

    {COMMAND}
"""
    partial = results + ".partial"
    with open(partial, "w", encoding="utf-8") as file:
        file.write(page)
    os.replace(partial, results)


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
