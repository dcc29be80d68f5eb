"""breakaway-node --identify on the emulated drive: what it finds is true, and a signal ends it at rest."""
import re
import time

import bench
from bench import Bench, case, long_case, require

MOVES = "sim/scenarios/move_axis.toml"  # 1 kg, friction of 2.5 to 4.5 N, within 0.6 m


def axis_to_identify(path="/dev/shm/to_identify.toml"):
    """The scenario under friction that falls with the speed from one bound to the other. Its own swings with the time, too,
    and at the end of a slow ramp of force the emulated drive may be busy with that for several periods."""
    with open(MOVES, encoding="utf-8") as text:
        changed, laws = re.subn(r"^kind = \"mean\"\nweights = .*\nparts = .*$", 'kind = "stribeck"\nvelocity_m_s = 0.1',
                                text.read(), flags=re.MULTILINE)
    require(laws == 1, f"{MOVES} has another law of friction")
    with open(path, "w", encoding="utf-8") as text:
        text.write(changed)
    return path


def found(output, pattern):
    match = re.search(pattern, output)
    require(match, f"no {pattern} in:\n{output}")
    return [float(number) for number in match.groups()]


@long_case
def finds_mass_friction_and_latency_of_an_axis(build):
    """What it finds over the bus, and what `breakaway identify --log` finds in its record."""
    with Bench(build) as b:
        scenario = axis_to_identify()
        drive = b.drive("vcan0", scenario=scenario)
        node = b.logged_node("vcan0", "--identify", scenario=scenario)
        code = node.end()
        bench.require_keeps_up(drive)
        output = node.output()
        require(code == 0, f"exit code {code}:\n{output}")
        mass, = found(output, r"mass +([\d.]+) kg")
        lower, upper = found(output, r"bounds +([\d.]+) to ([\d.]+) N")
        require(abs(mass - 1) < 0.02, f"{mass} kg instead of 1")
        require(2 < lower < 3.3 and 4.4 < upper < 5.2, f"friction of {lower} to {upper} N instead of 2.5 to 4.5")
        require("latency        1 period," in output, f"another latency than 1:\n{output}")
        steps = bench.steps_of(node)
        require(all(abs(float(step["position_m"])) <= 0.6 for step in steps), "the axis left its travel")
        again = b.start(b.command, "identify", scenario, "--log", f"{node.folder}/csv")
        require(again.end() == 0, again.output())
        require(abs(found(again.output(), r"mass +([\d.]+) kg")[0] - mass) < 1e-3, "the record says another mass")
    return f"{mass} kg, {lower} to {upper} N"


@case
def a_signal_ends_an_experiment_at_rest(build):
    """The axis brakes and rests, and the node ends as failed, for it found nothing."""
    with Bench(build) as b:
        scenario = axis_to_identify()
        b.drive("vcan0", scenario=scenario)
        node = b.logged_node("vcan0", "--identify", scenario=scenario)
        node.wait_for("enabled")
        time.sleep(8)
        require(node.terminate() == 1, f"not exit code 1:\n{node.output()}")
        require("ended as asked" in node.output() and "stopped" in node.output(), node.output())
    return "ended as asked"
