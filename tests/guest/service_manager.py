"""breakaway-node under a service manager, whose end of sd_notify is here; and what is left of a node that it kills."""
import contextlib
import ctypes
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time

import bench
from bench import Bench, case, require

WATCHDOG_S = 0.4


class Manager:
    """Takes what a node tells it."""

    def __init__(self):
        self.path = tempfile.mktemp(dir="/dev/shm")
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(self.path)
        self.lines = []

    def environment(self):
        return [f"NOTIFY_SOCKET={self.path}", f"WATCHDOG_USEC={round(1e6 * WATCHDOG_S)}"]

    def listen(self, time_s):
        """The lines that come within that time."""
        end, heard = time.monotonic() + time_s, []
        while (left := end - time.monotonic()) > 0:
            self.socket.settimeout(left)
            try:
                heard += self.socket.recv(4096).decode().splitlines()
            except TimeoutError:
                break
        self.lines += heard
        return heard

    def wait_for(self, line):
        end = time.monotonic() + bench.LIMIT_S
        while line not in self.lines:
            require(time.monotonic() < end, f"was not told {line}: {self.lines}")
            self.listen(0.05)


def hold_thread(thread_id):
    """Stops one thread of a process and none of the others, until this process ends."""
    seize, interrupt = 0x4206, 0x4207
    libc = ctypes.CDLL(None, use_errno=True)
    for request in (seize, interrupt):
        if libc.ptrace(request, ctypes.c_long(thread_id), None, None) != 0:
            sys.exit(f"ptrace: {os.strerror(ctypes.get_errno())}")
    print("held", flush=True)
    signal.pause()


@contextlib.contextmanager
def held(b, thread_id):
    """By a process of its own, which must be gone before anybody hears of the end of what it holds."""
    holder = b.start("python3", "-B", "tests/guest/service_manager.py", str(thread_id))
    try:
        holder.wait_for("held")
        yield
    finally:
        holder.process.kill()
        holder.process.wait()


def statusword(recorder_path, asked):
    """Of the drive, asked by SDO."""
    bench.run("cansend", "vcan0", asked)
    time.sleep(0.1)
    answers = [f for f in bench.read_candump(recorder_path) if f.can_id == 0x581]
    return int.from_bytes(answers[-1].data[4:6], "little")


@case
def a_service_manager_is_told_and_kills_a_loop_that_stands_still(build):
    manager = Manager()
    with Bench(build) as b:
        b.drive("vcan0")
        node = b.start("env", *manager.environment(), b.node_command, "--can", "vcan0", bench.SCENARIO)
        manager.wait_for("READY=1")
        require("STATUS=enabled" not in manager.lines[:manager.lines.index("READY=1")], f"{manager.lines}")
        manager.wait_for("STATUS=enabled")
        alive = manager.listen(2).count("WATCHDOG=1")
        require(8 <= alive <= 11, f"{alive} signs of life in 2 s")
        with held(b, node.process.pid):
            manager.listen(0.1)  # what was said until then
            heard = manager.listen(3 * WATCHDOG_S)
            require("WATCHDOG=1" not in heard, f"signs of life of a loop that stands still: {heard}")
            require(node.process.poll() is None, "the node ended")
            recorder = b.record("vcan0")
            word = statusword(recorder.output_path, "601#4041600000000000")
            require(word & 0x6F != 0x27, f"the drive of a node that stands still is left enabled: {word:04X}h")
            node.signal(signal.SIGKILL)
        node.end()
    return f"{alive} signs of life in 2 s, none once the loop stood still, and the drive had disabled itself"


@case
def a_service_manager_is_told_of_faults_and_of_the_stop(build):
    manager = Manager()
    with Bench(build) as b:
        b.drive("vcan0")
        node = b.start("env", *manager.environment(), b.node_command, "--can", "vcan0", bench.SCENARIO)
        manager.wait_for("STATUS=enabled")
        bench.run("cansend", "vcan0", "20000040#0000000000000000")
        manager.listen(0.5)
        require(any("FAULT: bus off" in line for line in manager.lines), f"was not told of the fault: {manager.lines}")
        node.signal(signal.SIGTERM)
        manager.wait_for("STOPPING=1")
        require(node.end() == 1, f"did not end with its fault:\n{node.output()}")
        require(manager.lines.count("READY=1") == 1, f"is ready more than once: {manager.lines}")
        code = subprocess.run(["env", "NOTIFY_SOCKET=/dev/shm/nobody", b.node_command, "--can", "vcan0", bench.SCENARIO],
                              capture_output=True, text=True)
        require(code.returncode == 2 and "NOTIFY_SOCKET=/dev/shm/nobody" in code.stderr, f"not refused: {code}")
    return "fault and stop told; a manager that is not there is refused by name"


if __name__ == "__main__":
    hold_thread(int(sys.argv[1]))
