"""One node with three axes, and two nodes on one bus."""
import os
import re
import signal
import subprocess
import time

import bench
from bench import Bench, case, latencies, long_case, refuses, require

THREE_AXES = "sim/scenarios/three_axes.toml"
NAMES = ("gantry", "slide", "table")
TOLERANCE_M = {"gantry": 2.5e-6, "slide": 2.5e-6, "table": 2.5e-5}  # of the reading: half a count more than the file's
MACHINE = "sim/scenarios/coupled_gantry.toml"
COMMANDS = (0x201, 0x202, 0x203)


def require_all_at_rest(node):
    for name in NAMES:
        match = re.search(rf"^{name} +stopped, ([-+\d.e]+) m from its target$", node.output(), re.MULTILINE)
        require(match, f"{name} was not stopped without a fault:\n{node.output()}")
        require(abs(float(match[1])) <= TOLERANCE_M[name], f"{name} rests {match[1]} m from its target")


def line_of(node, name, text):
    """The first line of the output about that axis with that text."""
    return next((line for line in node.output().split("\n") if f" {name} " in line and text in line), None)


def wait_for_line(node, name, text):
    end = time.monotonic() + bench.LIMIT_S
    while line_of(node, name, text) is None:
        require(time.monotonic() < end, f"does not say '{text}' of {name}:\n{node.output()}")
        time.sleep(0.01)


def worst_of_cyclictest(seconds):
    shown = subprocess.run(["cyclictest", "-q", "-m", "-p", "80", "-i", "1000", "-l", str(1000 * seconds)], check=True,
                           capture_output=True, text=True).stdout
    return float(re.search(r"Max:\s*(\d+)", shown)[1])


@case
def ten_seconds_of_three_axes_without_a_missed_tick(build):
    return tour_of_three_axes(build, 10)


@long_case
def sixty_seconds_of_three_axes_without_a_missed_tick(build):
    return tour_of_three_axes(build, 60)


def tour_of_three_axes(build, duration_s):
    """1 kHz on vcan0 over a tour of targets; every axis has a drive of its own and targets of its own."""
    reference_us = worst_of_cyclictest(10)
    with Bench(build) as b:
        drive = b.drive("vcan0", scenario=THREE_AXES)
        node = b.node("vcan0", "--duration", str(duration_s), "--target", "0", "0.1,-0.2,0.5", "-0.05,0.001,-1.5",
                      "0.25,0.1,0", "0.001,-0.1,2", "0", "--dwell", str(duration_s / 20), scenario=THREE_AXES)
        code = node.end()
        busy_ms = bench.require_keeps_up(drive)
        require(code == 0, f"exit code {code}:\n{node.output()}")
        require_all_at_rest(node)
        ticks, missed, worst_us = latencies(node.output())
        require(ticks >= 1000 * duration_s and missed == 0, f"{missed} of {ticks} ticks missed")
        require(worst_us <= 2 * reference_us, f"worst wake-up {worst_us} us, cyclictest {reference_us} us")
    return (f"{ticks} ticks, 0 missed, worst wake-up {worst_us:.1f} us, cyclictest {reference_us:.0f} us, "
            f"drives busy for at most {busy_ms:.2f} ms, all at their targets")


@long_case
def a_machine_is_sent_no_further_than_its_certificate_goes(build):
    with Bench(build) as b:
        b.drive("vcan0", scenario=MACHINE)
        recorder = b.record("vcan0")
        node = b.node("vcan0", "--target", "0.9", "--duration", "4", scenario=MACHINE)
        code = node.end()
        said = "axis left would go to its first target from -0.03 m to 0.9 m at once, and [coupling] start_m is 0.03"
        require(code == 2 and said in node.output(), f"exit code {code}:\n{node.output()}")
        moved = [f for f in bench.frames_of(recorder) if f.can_id in COMMANDS and f.controlword & 0xF == 0xF]
        require(not moved, f"{len(moved)} commands enabled a drive")
        # The drives are too slow for what follows, with the machine between them.
        near = b.node("vcan0", "--target", "-0.01", "--duration", "1", scenario=MACHINE)
        near.end()
        require(line_of(near, "left", "enabled"), f"was not enabled:\n{near.output()}")
    return "0.93 m are refused with no drive enabled, 0.02 m are not"


@long_case
def a_killed_drive_of_three_is_named_and_stops_all(build):
    absolute = bench.scenario_with_absolute_encoders(THREE_AXES, "/dev/shm/absolute.toml")
    with Bench(build) as b:
        drives = {name: b.drive("vcan0", "--axis", name, scenario=absolute) for name in NAMES}
        node = b.logged_node("vcan0", "--target", "0.9,-0.4,-3", scenario=absolute)
        for name in NAMES:
            wait_for_line(node, name, "enabled")
        time.sleep(0.1)
        recorder = b.record("vcan0")
        # A process that dies gives its locked memory back for milliseconds: not before those that live are served.
        os.sched_setscheduler(drives["slide"].process.pid, os.SCHED_FIFO, os.sched_param(60))
        drives["slide"].signal(signal.SIGKILL)
        wait_for_line(node, "slide", "FAULT: feedback stale")
        for name in ("gantry", "table"):
            wait_for_line(node, name, "FAULT: stopped with another axis")
        time.sleep(0.3)
        b.drive("vcan0", "--axis", "slide", scenario=absolute)
        time.sleep(2)
        reset_s = time.time()
        node.signal(signal.SIGUSR1)
        time.sleep(4)
        code = node.terminate()
        require(code == 0, f"exit code {code}:\n{node.output()}")
        require_all_at_rest(node)
        frames = bench.frames_of(recorder)
        answers = [f.time_s for f in frames if f.can_id == 0x182 and f.time_s < reset_s]
        missed_s = bench.last_before_silence(answers) + bench.PERIOD_S  # the first tick without it
        bench.require_force_before(missed_s, frames, "killed drive", COMMANDS)
        held = [f for f in frames if f.time_s < reset_s]
        bench.require_no_force_after(missed_s, held, "killed drive", COMMANDS)
    return "named with its axis, no force on any axis until the reset, then all at their targets"


@case
def a_second_node_on_the_bus_is_refused(build):
    with Bench(build) as b:
        b.drive("vcan0")
        first = b.node("vcan0", "--target", "0", "--duration", "8")
        first.wait_for("enabled")
        recorder = b.record("vcan0")
        second = [b.node_command, "--can", "vcan0", THREE_AXES]
        refused = refuses(b, second, "another master is on the bus", "[[axis]]")
        require("it sends SYNC" in refused or "it commands node 1" in refused, f"does not say by what sign: {refused}")
        syncs = [f.time_s for f in bench.frames_of(recorder) if f.can_id == 0x080]
        shortest_s = min(after - before for before, after in zip(syncs, syncs[1:]))
        require(shortest_s > 0.5 * bench.PERIOD_S, f"two SYNCs within {shortest_s:.6f} s")
        code = first.end()
        require(code == 0, f"the first node: exit code {code}:\n{first.output()}")
        ticks, missed, _ = latencies(first.output())
        require(missed == 0, f"{missed} of {ticks} ticks missed")
    return f"exit code 2, one line with the remedy; the first node's {ticks} ticks go on, 0 missed"
