"""breakaway-node moves an axis behind an emulated ODrive."""
import re
import signal
import struct
import time

import bench
from bench import Bench, case, latencies, refuses, require

ODRIVE = "sim/scenarios/polled_odrive.toml"
PROMISED_M = 6.98e-6  # as `breakaway design` says
TORQUE, STATE, HEARTBEAT = 0x2E, 0x27, 0x21  # commands and a message of node 1
IDLE, CLOSED_LOOP = 1, 8


def torque_of(frame):
    return struct.unpack("<f", frame.data[0:4])[0]


def require_no_torque_after(time_s, frames, what):
    late = [f for f in frames if f.can_id == TORQUE and f.time_s > time_s + 2 * bench.PERIOD_S and torque_of(f) != 0]
    require(not late, f"{what}: {len(late)} commands with torque, the first {late and late[0]} after {time_s:.6f}")
    before = [f for f in frames if f.can_id == TORQUE and time_s - 5 * bench.PERIOD_S < f.time_s <= time_s]
    require(before and any(torque_of(f) != 0 for f in before), f"{what}: no torque before it happened")


def error_of(output):
    rest = re.search(r"stopped, ([-+\d.e]+) m from its target", output)
    require(rest, f"was not stopped without a fault:\n{output}")
    return float(rest[1])


@case
def an_odrive_settles(build):
    """Over a tour of targets at 1 kHz; at the end the drive is seen idle."""
    with Bench(build) as b:
        drive = b.drive("vcan0", scenario=ODRIVE)
        recorder = b.record("vcan0")
        node = b.node("vcan0", "--duration", "5", "--target", "0", "0.05", "0", "--dwell", "0.3", scenario=ODRIVE)
        listener = b.node("vcan0", "--readonly", "--duration", "2", scenario=ODRIVE)
        code = node.end()
        bench.require_keeps_up(drive)
        require(code == 0, f"exit code {code}:\n{node.output()}")
        require(listener.end() == 0 and "enabled" in listener.output(), f"hears nothing:\n{listener.output()}")
        error_m = error_of(node.output())
        require(abs(error_m) <= PROMISED_M, f"rests {error_m} m from its target")
        frames = bench.frames_of(recorder)
        beats = [f.data[4] for f in frames if f.can_id == HEARTBEAT and len(f.data) == 8]
        require(CLOSED_LOOP in beats and beats[-1] == IDLE, f"the drive is left in state {beats[-1]}")
        ticks, missed, _ = latencies(node.output())
        require(missed == 0, f"{missed} of {ticks} ticks missed")
    return f"{error_m:+.3g} m from its last target, 0 of {ticks} ticks missed, idle at the end"


@case
def an_odrive_is_stopped_by_sigterm_and_named_when_it_is_gone(build):
    with Bench(build) as b:
        drive = b.drive("vcan0", scenario=ODRIVE)
        recorder = b.record("vcan0")
        node = b.node("vcan0", scenario=ODRIVE)
        node.wait_for("enabled")
        time.sleep(0.1)
        code = node.terminate()
        require(code == 0, f"exit code {code}:\n{node.output()}")
        frames = bench.frames_of(recorder)
        stop = next(f for f in frames if f.can_id == STATE and f.data[0] == IDLE and torque_before(f, frames))
        require_no_torque_after(stop.time_s, frames, "SIGTERM")
        recorder = b.record("vcan0")
        node = b.node("vcan0", "--target", "3", scenario=ODRIVE)
        node.wait_for("enabled")
        time.sleep(0.2)
        drive.signal(signal.SIGKILL)
        node.wait_for("FAULT: feedback stale")
        node.terminate()
        require("NOT CONFIRMED as stopped: the drive was told to by Set_Axis_State" in node.output(), node.output())
        frames = bench.frames_of(recorder)
        silence_s = max(f.time_s for f in frames if f.can_id == 0x29 and len(f.data) == 8)
        require_no_torque_after(silence_s + 3 * bench.PERIOD_S, frames, "killed drive")
    return "idle at SIGTERM; a drive that is gone is named, and told no torque"


def torque_before(stop, frames):
    return any(f.can_id == TORQUE and f.time_s < stop.time_s and torque_of(f) != 0 for f in frames)


@case
def an_odrive_is_refused_by_name(build):
    with Bench(build) as b:
        node = [b.node_command, "--can", "vcan0", ODRIVE]
        refuses(b, [*node, "--node-id", "63"], "--node-id 63", "0 to 62")
        refuses(b, [b.node_command, "--can", "vcan0", "sim/scenarios/odrive_axis.toml"], "not certified", "polled")
        drive = b.drive("vcan0", "--node-id", "7", scenario=ODRIVE)
        refuses(b, [*node, "--wait", "1"], "no drive answers as node 1", "these nodes do: 7")
        drive.terminate()
        b.drive("vcan0", scenario=ODRIVE)
        first = b.node("vcan0", "--target", "0", "--duration", "6", scenario=ODRIVE)
        first.wait_for("enabled")
        refuses(b, node, "another master is on the bus", "it commands node 1")
        code = first.end()
        require(code == 0, f"the first node: exit code {code}:\n{first.output()}")
    return "each in one line with the remedy"
