"""breakaway-node moves a load that hangs on a belt."""
import re

import bench
from bench import Bench, latencies, long_case, require

BELT = "sim/scenarios/belt_axis.toml"
PROMISED_M = 3.205e-4  # the tolerance of the file, and half a count


@long_case
def a_load_on_a_belt_settles(build):
    """The drive plays motor and load of the file, and shows where the motor is."""
    with Bench(build) as b:
        drive = b.drive("vcan0", scenario=BELT)
        node = b.node("vcan0", "--duration", "10", "--target", "0", "0.03", "0", "--dwell", "0.5", scenario=BELT)
        code = node.end()
        busy_ms = bench.require_keeps_up(drive)
        output = node.output()
        require(code == 0, f"exit code {code}:\n{output}")
        rest = re.search(r"stopped, ([-+\d.e]+) m from its target", output)
        require(rest and abs(float(rest[1])) <= PROMISED_M, f"does not rest within {PROMISED_M} m:\n{output}")
        ticks, missed, _ = latencies(output)
        require(missed == 0, f"{missed} of {ticks} ticks missed")
    return f"{rest[1]} m from its last target, 0 of {ticks} ticks missed, the drive busy for at most {busy_ms:.2f} ms"
