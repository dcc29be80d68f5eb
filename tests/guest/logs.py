"""breakaway-node whose logs are not taken: by nobody, by a reader that is gone, by a disk that is full."""
import os
import signal
import subprocess
import time

import bench
import identified
from bench import Bench, case, require

# A stop takes milliseconds, what is left is given up within two seconds for the logs and two for standard output. In
# the guest's virtual time this holds however busy its host is.
END_S = 6


def end_soon(process, what):
    began = time.monotonic()
    try:
        return process.wait(END_S)
    except subprocess.TimeoutExpired:
        raise bench.Failure(f"{what}: not ended {time.monotonic() - began:.1f} s after SIGTERM") from None


def require_released(recorder, stopped_s, what):
    """Quick stop at once, no force after it, and the drive was told not to expect heartbeats any more."""
    frames = bench.frames_of(recorder)
    commands = [f for f in frames if f.can_id == 0x201]
    require(any(f.controlword == bench.ENABLE_OPERATION for f in commands if f.time_s < stopped_s), f"{what}: never ran")
    stop_s = next((f.time_s for f in commands if f.controlword != bench.ENABLE_OPERATION and f.time_s > stopped_s), None)
    require(stop_s is not None and stop_s < stopped_s + 0.1, f"{what}: no stop within 0.1 s")
    require(any(f.can_id == 0x601 and f.data[1:4].hex() == "161001" and f.time_s > stop_s for f in frames),
            f"{what}: its drive was not released")


def moving(b, *command):
    """A node whose axis is on its way, and who listens beside it. Its standard output is a pipe."""
    b.drive("vcan0")
    recorder = b.record("vcan0")
    node = subprocess.Popen([b.node_command, "--can", "vcan0", bench.SCENARIO, *command], stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for line in node.stdout:
        if " s  enabled" in line:
            break
    time.sleep(0.25)
    return node, recorder


@case
def a_log_that_nobody_reads_keeps_no_axis_moving(build):
    """A fifo that is full, as log; a standard output that is full."""
    fifo = "/dev/shm/stalls"
    os.mkfifo(fifo)
    reader = os.open(fifo, os.O_RDWR)
    with Bench(build) as b:
        node, recorder = moving(b, "--csv", fifo)
        time.sleep(2)  # more than the fifo takes
        stopped_s = time.time()
        node.send_signal(signal.SIGTERM)
        code = end_soon(node, "a log that stalls")
        error = node.stderr.read()
        require(code == 1 and error == f"breakaway-node: {fifo}: cannot be written: nobody takes what is written to it\n",
                f"exit code {code}: {error}")
        require_released(recorder, stopped_s, "a log that stalls")
    os.close(reader)
    os.unlink(fifo)
    with Bench(build) as b:
        b.drive("vcan0")
        recorder = b.record("vcan0")
        out, into = os.pipe()
        os.set_blocking(into, False)
        try:
            while os.write(into, bytes(4096)):
                pass
        except BlockingIOError:
            os.set_blocking(into, True)
        node = subprocess.Popen([b.node_command, "--can", "vcan0", bench.SCENARIO], stdin=subprocess.DEVNULL, stdout=into,
                                stderr=subprocess.PIPE, text=True)
        os.close(into)
        time.sleep(2)
        stopped_s = time.time()
        node.send_signal(signal.SIGTERM)
        code = end_soon(node, "standard output that stalls")
        error = node.stderr.read()
        require(code == 1 and "standard output: cannot be written: nobody" in error, f"exit code {code}: {error}")
        os.close(out)
        require_released(recorder, stopped_s, "standard output that stalls")
    return f"stopped, released and ended within {END_S} s, by name"


@case
def a_reader_that_is_gone_ends_no_run(build):
    with Bench(build) as b:
        node, recorder = moving(b)
        node.stdout.close()
        stopped_s = time.time()
        node.send_signal(signal.SIGTERM)  # its stop is what it has to print next
        code = end_soon(node, "a reader that is gone")
        error = node.stderr.read()
        require(code == 1 and error == "breakaway-node: standard output: cannot be written: Broken pipe\n",
                f"exit code {code}: {error}")
        require_released(recorder, stopped_s, "a reader that is gone")
    with Bench(build) as b:
        node, _ = moving(b)
        node.stdout.close()
        bench.run("cansend", "vcan0", "20000040#0000000000000000")  # a fault, which is printed
        time.sleep(0.5)
        require(node.poll() is None, f"ended with {node.poll()} as its reader did")
        node.send_signal(signal.SIGTERM)
        require(end_soon(node, "a fault without a reader") == 1, "a fault without a reader: not 1")
    return "goes on without, ends with 1, by name"


@case
def a_full_disk_and_a_start_that_is_refused(build):
    with Bench(build) as b:
        record = "/dev/shm/earlier.csv"
        with open(record, "w", encoding="ascii") as earlier:
            earlier.write("an earlier record\n")
        bench.refuses(b, [b.node_command, "--can", "vcan0", bench.SCENARIO, "--wait", "0.3", "--csv", record], "no drive answers")
        with open(record, encoding="ascii") as earlier:
            require(earlier.read() == "an earlier record\n", "the record of another run is gone")
        b.drive("vcan0")
        node = b.node("vcan0", "--csv", "/dev/full", "--candump", record, "--target", "0", "--duration", "3")
        code, output = node.end(), node.output()
        require(code == 1, f"exit code {code}:\n{output}")
        require("/dev/full: cannot be written: No space left on device\n" in output, output)
        ticks = bench.latencies(output)[0]
        lost = int(output.rsplit("; ", 1)[1].split()[0])
        require(ticks - 500 < lost <= ticks, f"{lost} records are said to be lost in {ticks} ticks")
        require(len(bench.read_candump(record)) > 2 * 3000, "the other log suffered, too")
    return f"named, {lost} records counted, and an earlier record is kept"


@case
def a_record_that_was_not_written_is_offered_to_nobody(build):
    scenario, record = identified.axis_to_identify("/dev/shm/unwritten.toml"), "/dev/shm/written.csv"
    for path in record, "/dev/full":
        with Bench(build) as b:
            b.drive("vcan0", scenario=scenario)
            node = b.node("vcan0", "--identify", "--csv", path, scenario=scenario)
            node.wait_for("s  enabled")
            time.sleep(0.5)
            require(node.terminate() == 1, f"an experiment that was ended has not failed:\n{node.output()}")
            offered = f"--log {path}" in node.output()
            require(offered == (path == record), f"offered: {offered}\n{node.output()}")
    return "a record that was written is offered, one that was not is not"
