"""What `breakaway watch` shows of a node in real time: the cases of linux_node.py that look at the page's data."""
import json
import re
import socket
import urllib.request

import bench
from bench import Bench, case, latencies, require


class Page:
    """`breakaway watch` on a free port."""

    def __init__(self, b, *options):
        self.process = b.start(b.command, "watch", "--http", "0", *options)
        self.process.wait_for("http://127.0.0.1:")
        self.address = re.search(r"http://127\.0\.0\.1:\d+/", self.process.output())[0]

    def get(self, path):
        with urllib.request.urlopen(self.address + path, timeout=bench.LIMIT_S) as answer:
            return json.load(answer)

    def samples(self):
        fields, rows, told = self.get("about")["fields"], [], {"next": 0, "more": True}
        while told["more"]:
            told = self.get(f"samples?from={told['next']}")
            rows += [dict(zip(fields, row)) for row in told["rows"]]
        return rows, told


def require_loopback():
    bench.run("ip", "link", "set", "lo", "up")


@case
def a_run_that_is_watched(build):
    """The page has every sample of the node's own log, and what it hears on the bus agrees with it."""
    require_loopback()
    with Bench(build) as b:
        b.drive("vcan0")
        streamed = Page(b, "--stream", "9870")
        heard = Page(b, "--can", "vcan0", bench.SCENARIO)
        node = b.logged_node("vcan0", "--duration", "4", "--target", "0", "--stream", "udp:localhost:9870")
        code = node.end()
        require(code == 0, f"exit code {code}:\n{node.output()}")
        ticks, missed, _ = latencies(node.output())
        require(missed == 0, f"{missed} of {ticks} ticks missed")
        steps = bench.steps_of(node)
        samples, told = streamed.samples()
        lost = told["lost_on_the_way"] + told["lost_at_sender"] + told["malformed"]
        require(lost == 0 and len(samples) == len(steps), f"{len(samples)} of {len(steps)} samples, {lost} lost")
        for sample, step in zip(samples, steps):
            require(sample["position_m"] == float(step["position_m"]), f"{sample} is not {step}")
        require(f"{len(steps)} samples sent to udp:localhost:9870; not sent: 0" in node.output(), node.output())
        loads = [s["bus_load"] for s in samples[1000:3000]]
        require(0.15 < min(loads) and max(loads) < 0.5, f"bus load {min(loads)} to {max(loads)}")
        on_bus, _ = heard.samples()
        # A drive that is still set up does not answer SYNC.
        set_up = sum(step["drive"] != "configuring" for step in steps)
        require(abs(len(on_bus) - set_up) < 100, f"{len(on_bus)} samples on the bus, {set_up} of {len(steps)} of the node")
        seen = {round(s["position_m"] * 1e6) for s in on_bus}
        known = {round(float(s["position_m"]) * 1e6) for s in steps}
        require(len(known - seen) <= 2, f"positions that were not heard: {len(known - seen)}")
        for page in (streamed, heard):
            require(page.process.terminate() == 0, page.process.output())
    return f"{len(steps)} samples in the page, 0 lost, 0 of {ticks} ticks missed"


@case
def a_stream_that_nobody_reads(build):
    """Neither a receiver that stands still nor one that is not there costs the loop a tick."""
    require_loopback()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver, Bench(build) as b:
        receiver.bind(("127.0.0.1", 9870))
        b.drive("vcan0")
        for port, lost in (9870, "not sent: 0"), (9871, "that nobody took"):
            node = b.node("vcan0", "--duration", "3", "--target", "0", "--stream", f"udp:127.0.0.1:{port}")
            code = node.end()
            require(code == 0, f"exit code {code}:\n{node.output()}")
            ticks, missed, _ = latencies(node.output())
            require(missed == 0, f"{missed} of {ticks} ticks missed")
            require(lost in node.output(), node.output())
    return "0 ticks missed"
