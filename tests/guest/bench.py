"""Starts nodes and drives on CAN interfaces and reads what they did. Runs in the guest of toolchain/guest.sh."""
import csv
import dataclasses
import re
import signal
import subprocess
import tempfile
import time

PERIOD_S = 0.001
SCENARIO = "sim/scenarios/can_axis.toml"
CASES = []  # in the order in which they run
LONG_CASES = []  # of these
ENABLE_OPERATION = 0x0F
BUILT = ("sim/cli/breakaway", "firmware/targets/linux/breakaway-node")  # in the build's folder
PROGRAMS = ("candump", "cangen", "cansend", "chrt", "cyclictest", "env", "ip", "node", "python3", "rmmod", "setpriv", "sh")
# When what is waited for is taken for something that never comes. What is in the guest's memory comes within seconds of
# virtual time, and the little that is still read from the host within some tens where that is busy.
LIMIT_S = 1000.0


class Failure(Exception):
    """A check does not hold."""


class Spoilt(Failure):
    """What was measured may say nothing about the node: an emulated drive did not answer in time, or the kernel was busy at
    the wrong moment."""


def case(function):
    CASES.append(function)
    return function


def long_case(function):
    """One that --quick leaves out."""
    LONG_CASES.append(function)
    return case(function)


def require(condition, text):
    if not condition:
        raise Failure(text)


@dataclasses.dataclass
class Frame:
    time_s: float
    can_id: int
    data: bytes  # of a remote frame: none

    @property
    def torque(self):
        """Target torque of an RPDO1, per mille."""
        return int.from_bytes(self.data[2:4], "little", signed=True)

    @property
    def controlword(self):
        return int.from_bytes(self.data[0:2], "little")


def read_candump(path):
    frames = []
    with open(path, encoding="ascii") as log:
        for line in log:
            match = re.match(r"\((\d+\.\d+)\) \S+ ([0-9A-F]+)#(?:R\d?|([0-9A-F]*))$", line.strip())
            require(match, f"not a line of candump: {line!r}")
            frames.append(Frame(float(match[1]), int(match[2], 16), bytes.fromhex(match[3] or "")))
    return frames


def require_in_memory(program):
    """A program that the host holds starts when it pleases the host, whatever time it is in the guest."""
    require(program in PROGRAMS or program.endswith(BUILT), f"PROGRAMS of bench.py has no {program}")


class Process:
    """A program whose output goes to a file, so that nobody has to read along."""

    def __init__(self, command, errors=subprocess.STDOUT):
        require_in_memory(command[0])
        self.output_path = tempfile.mktemp(dir="/dev/shm")
        with open(self.output_path, "wb") as output:
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=output, stderr=errors)

    def output(self):
        with open(self.output_path, encoding="utf-8", errors="replace") as text:
            return text.read()

    def tell(self, line):
        self.process.stdin.write(line.encode() + b"\n")
        self.process.stdin.flush()

    def wait_for(self, text):
        """Until the output holds the text."""
        end = time.monotonic() + LIMIT_S
        while text not in self.output():
            require(self.process.poll() is None, f"ended before it said '{text}':\n{self.output()}")
            require(time.monotonic() < end, f"does not say '{text}':\n{self.output()}")
            time.sleep(0.01)

    def signal(self, number):
        self.process.send_signal(number)

    def end(self):
        """Its exit code, once it ends by itself."""
        try:
            return self.process.wait(LIMIT_S)
        except subprocess.TimeoutExpired as late:
            self.process.kill()
            raise Failure(f"did not end within {LIMIT_S} s:\n{self.output()}") from late

    def terminate(self):
        self.signal(signal.SIGTERM)
        return self.end()


class Bench:
    """One case: whatever it starts is ended with it."""

    def __init__(self, build):
        self.command, self.node_command = (f"{build}/{program}" for program in BUILT)
        self.processes = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for started in self.processes:
            if started.process.poll() is None:
                started.process.kill()
                started.process.wait()

    def start(self, *command):
        self.processes.append(Process(command))
        return self.processes[-1]

    def drive(self, interface, *options, scenario=SCENARIO):
        drive = self.start(self.command, "drive", "--can", interface, "--realtime", scenario, *options)
        drive.wait_for("drive ")
        return drive

    def node(self, interface, *options, scenario=SCENARIO):
        return self.start(self.node_command, "--can", interface, scenario, *options)

    def logged_node(self, interface, *options, scenario=SCENARIO):
        folder = tempfile.mkdtemp(dir="/dev/shm")
        node = self.node(interface, "--candump", f"{folder}/log", "--csv", f"{folder}/csv", *options, scenario=scenario)
        node.folder = folder
        return node

    def adapter(self, interface, bitrate=1000000):
        """slcan0, whose adapter is on that interface."""
        adapter = self.start("python3", "-B", "tests/guest/slcan_adapter.py", interface, str(bitrate))
        adapter.wait_for("ready")
        return adapter

    def record(self, interface):
        """An independent witness: all frames with the kernel's time stamps, error frames among them."""
        recorder = Process(["candump", "-D", "-L", f"{interface},0:0,#FFFFFFFF"], subprocess.DEVNULL)
        self.processes.append(recorder)
        time.sleep(0.1)
        return recorder


def frames_of(recorder):
    recorder.signal(signal.SIGTERM)
    recorder.process.wait()
    return read_candump(recorder.output_path)


def steps_of(node):
    with open(f"{node.folder}/csv", encoding="ascii", newline="") as text:
        return list(csv.DictReader(text))


def scenario_with_absolute_encoders(scenario, path):
    """The scenario with drives that know where they stand when they start: a reset needs no new zero."""
    with open(scenario, encoding="utf-8") as text:
        changed, drives = re.subn(r"^(\[(?:axis\.)?drive\].*)$", r'\1\nencoder = "absolute"', text.read(), flags=re.MULTILINE)
    require(drives > 0, f"{scenario} has no [drive]")
    with open(path, "w", encoding="utf-8") as text:
        text.write(changed)
    return path


def run(*command):
    require_in_memory(command[0])
    subprocess.run(command, check=True)


def latencies(text):
    match = re.search(r"(\d+) ticks, (\d+) missed, wake-up latency ([\d.]+) / ([\d.]+) / ([\d.]+) us", text)
    require(match, f"no timing in:\n{text}")
    return int(match[1]), int(match[2]), float(match[5])


def require_keeps_up(drive):
    """The emulated drives answered within the period, so that what a node saw was the bus and not a slow emulator. To be
    asked before what the node did is judged."""
    require(drive.terminate() == 0, f"the drive failed:\n{drive.output()}")
    match = re.search(r"busy for at most ([\d.e+-]+) ms at a time", drive.output())
    require(match, f"does not say how long it was busy:\n{drive.output()}")
    if not float(match[1]) < 1e3 * PERIOD_S:
        raise Spoilt(f"the emulated drives were busy for too long:\n{drive.output()}")
    return float(match[1])


def refuses(b, command, *texts):
    started = b.start(*command)
    code, output = started.end(), started.output()
    require(code == 2, f"exit code {code} instead of 2:\n{output}")
    lines = [line for line in output.split("\n") if line.startswith("breakaway-node: ")]
    require(len(lines) == 1, f"not one line:\n{output}")
    for text in texts:
        require(text in lines[0], f"'{text}' is missing in: {lines[0]}")
    return lines[0]


def last_before_silence(times_s):
    """The last of these times before more than 0.1 s without one, or the last of all."""
    return next((before for before, after in zip(times_s, times_s[1:]) if after - before > 0.1), times_s[-1])


COMMANDS = (0x201,)  # RPDO1 of the drives that are looked at


def require_no_force_after(time_s, frames, what, commands=COMMANDS):
    """No command on the bus later than two ticks after time_s asks for torque or keeps a drive enabled."""
    late = [f for f in frames if f.can_id in commands and f.time_s > time_s + 2 * PERIOD_S + 50e-6]
    bad = [f for f in late if f.torque != 0 or f.controlword == ENABLE_OPERATION]
    require(not bad, f"{what}: {len(bad)} commands with force, the first {bad and bad[0]} after {time_s:.6f}")
    return late


def require_force_before(time_s, frames, what, commands=COMMANDS):
    """The check above means something only if there was force."""
    for command in commands:
        before = [f for f in frames if f.can_id == command and time_s - 5 * PERIOD_S < f.time_s <= time_s]
        require(before and all(f.torque != 0 for f in before), f"{what}: no force of {command:03X} before it happened")
