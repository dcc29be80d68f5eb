"""Writes what the images cost, of all targets beside this host, to one page.

Usage: costs.py HOST_REPLAY TAPES PAGE.md BUILD_FOLDER

Reads what report.py left in BUILD_FOLDER/TARGET/run, and takes the counts on this host by callgrind.
toolchain/emulate.sh calls it.
"""
import argparse
import datetime
import json
import subprocess

from report import (AXES, COORDINATED, COORDINATED_AXES, KINDS, MOST_FOR_COORDINATION, MOST_OF_WORK, PHASES, PID, TARGETS,
                    coordination, in_words, worst_of_law)

from callgrind_counts import Counts, count  # report.py knows where it is


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" + "|---:" * (len(head) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def spread(calls):
    if not calls:
        return ("",) * 3
    c = Counts(calls)
    return (c.least, c.typical, c.most)


def steps_table(costs, host, counted, pairs):
    head = [""]
    for name in costs:
        core = TARGETS[name].core
        head += [f"{core}: least", "typical", "most", "most, hostile"]
    head += ["x86-64: least", "typical", "most"]
    rows = []
    for label, hostile_label in occurring(costs, counted, pairs):
        row = [in_words(label)]
        for cost in costs.values():
            hostile = cost[counted].get(hostile_label)
            row += [*spread(cost[counted].get(label, [])), max(hostile) if hostile else ""]
        here = host.get(label)
        rows.append(row + list(spread(here.calls if here else [])))
    return table(head, rows)


def occurring(costs, counted, pairs):
    return [pair for pair in pairs if any(label in cost[counted] for cost in costs.values() for label in pair)]


def steps():
    """Labels of the steps of the laws, each with that of the hostile ones of its kind."""
    pairs = [(f"{axis}/axis/{kind}", f"{axis}/hostile/{kind}") for axis in AXES for kind in range(len(KINDS))]
    return pairs + [(f"{PID}/{kind}", None) for kind in range(len(KINDS))]


def periods():
    """The same of the periods of the coordinator."""
    return [(f"{COORDINATED}/axis/{phase}", f"{COORDINATED}/hostile/{phase}") for phase in range(len(PHASES))]


def own_steps(costs):
    """In words, of each core: what an axis' own step takes, and the most of a period beyond those of its axes."""
    return "; ".join(f"on the {TARGETS[name].core} {Counts(cost['own']).typical} and "
                     f"{coordination(cost['coordinated'], cost['own'])}" for name, cost in costs.items())


def node_table(costs):
    rows = []
    for name, cost in costs.items():
        target, node = TARGETS[name], Counts(cost["node"])
        rows.append((f"{name}, {target.core} at {target.core_Hz / 1e6:.0f} MHz", target.axes, len(node.calls), node.least, f"{node.mean:.0f}",
                     node.most, f"{target.share(worst_of_law(cost['steps'])):.2%}", f"{target.share(node.most):.2%}"))
    return table(["", "axes", "periods", "least", "mean", "most", "worst of the law / period", "worst of the node / period"], rows)


def sizes_table(costs):
    return table(["image", "code", "RAM", "stack at most", "stack reserved"],
                 [(f"{name}, `{image}`", f["code"], f["ram"], f["stack"], f["stack_reserved"])
                  for name, cost in costs.items() for image, f in cost["images"].items()])


def page(costs, host):
    compiler = subprocess.run(["arm-none-eabi-g++", "--version"], check=True, stdout=subprocess.PIPE, text=True)
    bounds = ", ".join(f"{t.most_instructions} on the {t.core}" for t in (TARGETS[name] for name in costs))
    return f"""# What the images cost

Written by `toolchain/emulate.sh {" ".join(costs)} --costs`; do not edit. {datetime.date.today()},
{compiler.stdout.splitlines()[0]}, `-O2`.

## Instructions per control step, in float

Counted by a plugin of QEMU on the emulated cores, by callgrind on x86-64 (`-O3`): exact, and the same in every run. One call
of `update`, less an empty one. 5000 steps in closed loop, one sample in 97 lost: "coast pd" of `sim/scenarios/can_axis.toml`,
"coast brake" of `braked_axis.toml`, "move" of `move_axis.toml`, whose jerk is limited, "fine stage" of `fine_axis.toml`, "pre-sliding" of
`presliding_axis.toml`, "coast work" of `belt_axis.toml`, a load on a spring with the encoder on the motor (on the load it has no
meter, and less work); PID on the samples of the first.
"Hostile" are 20000 samples that no axis would give, to look for the worst. Typical is the median. The M4F runs Thumb code, the
R5F Arm code.

{steps_table(costs, host, "steps", steps())}

`toolchain/emulate.sh` fails above {bounds}, under the coast "work" above {MOST_OF_WORK}. The results of all steps, hostile ones included, are
equal to the host's bit for bit.

## Instructions per period of axes that push each other, in float

The same of `KickCoordinator` for {COORDINATED_AXES} axes, whole periods by the phase in which they begin: 10000 in closed loop, and 20000 hostile
ones. An axis' own step, the PD of its approach, and the most that a period takes beyond {COORDINATED_AXES} of them: {own_steps(costs)}.
`toolchain/emulate.sh` fails above {MOST_FOR_COORDINATION}.

{steps_table(costs, host, "coordinated", periods())}

## Instructions per step of the whole node

Receive, supervise, control and send, in closed loop on the emulated bus from power-on on, with the axis of
`sim/scenarios/can_axis.toml` or the two of `sim/scenarios/two_axes.toml`, into which a tool looks by SDO in every period. The shares are of a
period of 1 ms, at {next(iter(TARGETS.values())).cycles_per_instruction} cycles an instruction: a cautious mean, as an instruction takes one cycle or a few (a division or square
root 14 to 30), and flash or a peripheral may make it wait. `toolchain/emulate.sh` fails above {next(iter(TARGETS.values())).most_share:.0%}.

{node_table(costs)}

On top come, on slcan, the time in which the serial line takes the characters (22 at 1 Mbaud: 220 us), and on the R5F some 50
accesses to peripherals, whose time on their bus an emulator does not know: 2.5% if each took 0.5 us.

## Memory, in bytes

Code with constants and initial values (flash of the STM32F405; TCM A and the upper half of TCM B, 98304 together, of the R5F), and
RAM (the lower half of TCM B) with the reserved stack, as linked. The stack's bound is that of the longest chain of calls, with an interrupt on top where there are any
(`toolchain/check_image.py`).

{sizes_table(costs)}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("host_replay", "tapes", "page", "build"):
        parser.add_argument(name)
    a = parser.parse_args()
    costs = {}
    for name in TARGETS:
        with open(f"{a.build}/{name}/run/costs.json", encoding="utf-8") as file:
            costs[name] = json.load(file)
    host, _ = count(a.host_replay, a.tapes)
    with open(a.page, "w", encoding="utf-8") as file:
        file.write(page(costs, host))
    print(f"wrote {a.page}")


if __name__ == "__main__":
    main()
