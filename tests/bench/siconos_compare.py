#!/usr/bin/python3
"""Two masses with dry friction: breakaway beside Siconos, error and time of one trajectory in one run.

Usage: siconos_compare.py BREAKAWAY [STEP_S...]        (steps default to 1e-2 1e-3)
BREAKAWAY is the built command. Needs the Debian packages python3-siconos and python3-numpy, and Debian's own python3.

The trajectory is that of section 4 of van de Wouw & Leine (stability properties of equilibrium sets) from rest at
(2.5, -1) to rest; errors are against 25 digits. Siconos runs its Moreau-Jean-type scheme (EulerMoreauOSI, relay law,
theta = 1/2), breakaway its midpoint scheme with the same steps, and its event-driven method. Times are of the processor,
the least of three; building the model is left out on both sides.
"""
import csv
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENARIO = ROOT / "sim/scenarios/two_mass_example.toml"
START = (2.5, -1.0)
STIFFNESS = [[2.0, -1.0], [-1.0, 2.0]]
DAMPING = [[0.125, 0.375], [0.375, 0.125]]


def reference():
    with open(ROOT / "tests/reference/linear_machine.csv", encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if row[0] == "two_mass"]
    end = {int(row[2]): float(row[3]) for row in rows if row[1] == "q"}
    return [end[0], end[1]], next(float(row[3]) for row in rows if row[1] == "end")


def siconos(np, sk, step_s, end_s):
    """Final coordinates and seconds."""
    a = np.zeros((4, 4))
    a[:2, 2:] = np.eye(2)
    a[2:, :2] = -np.array(STIFFNESS)
    a[2:, 2:] = -np.array(DAMPING)
    sliding = np.zeros((2, 4))
    sliding[:, 2:] = np.eye(2)
    system = sk.FirstOrderLinearTIDS(np.array([*START, 0.0, 0.0]), a)
    friction = sk.Interaction(sk.RelayNSL(2, -1.0, 1.0), sk.FirstOrderLinearTIR(sliding, sliding.T.copy()))
    model = sk.NonSmoothDynamicalSystem(0.0, end_s)
    model.insertDynamicalSystem(system)
    model.link(friction, system)
    run = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, step_s), sk.EulerMoreauOSI(0.5), sk.Relay())
    start_s = time.process_time()
    while run.hasNextEvent():
        run.computeOneStep()
        run.nextStep()
    return list(system.x()[:2]), time.process_time() - start_s


def breakaway_end(command, run_keys):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "two_mass.toml")
        text = SCENARIO.read_text(encoding="utf-8")
        pathlib.Path(path).write_text(text.replace("[run]\n", "[run]\n" + run_keys), encoding="utf-8")
        out = subprocess.run([command, "simulate", path, "--json", "-"], check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(out.stdout)["q_end"]


def breakaway_s(command, work):
    """Seconds of one trajectory: the difference of many repetitions and one."""
    def seconds(repeats):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([command, "tradeoff", "--work", work, "--repeat", str(repeats)], check=True)
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

    repeats = 1
    while seconds(repeats) < 0.2:
        repeats *= 4
    return (seconds(repeats) - seconds(1)) / (repeats - 1)


def least(times):
    return min(times() for _ in range(3))


def main(arguments):
    if not arguments or arguments[0].startswith("-"):
        print(__doc__)
        return 0 if arguments else 2
    try:
        import numpy as np
        import siconos.kernel as sk
    except ImportError as error:
        print(f"siconos_compare.py: {error}; install python3-siconos and run this with /usr/bin/python3",
              file=sys.stderr)
        return 2
    command, steps = arguments[0], [float(step) for step in arguments[1:]] or [1e-2, 1e-3]
    exact, settling_s = reference()

    def error_m(end):
        return max(abs(found - true) for found, true in zip(end, exact))

    rows = []
    for step_s in steps:
        runs = [siconos(np, sk, step_s, settling_s + 10 * step_s) for _ in range(3)]
        rows.append(("Siconos, theta = 1/2", step_s, error_m(runs[0][0]), min(seconds for _, seconds in runs)))
    for step_s in steps:
        end = breakaway_end(command, f'integrator = "time_stepping"\nstep_s = {step_s:g}\n')
        rows.append(("breakaway, midpoint", step_s, error_m(end),
                     least(lambda: breakaway_s(command, f"integrate-theta0.5-step{step_s:g}"))))
    rows.append(("breakaway, event-driven", None, error_m(breakaway_end(command, "")),
                 least(lambda: breakaway_s(command, "integrate-events"))))

    fastest = rows[-1][3]
    print("| method | step [s] | error [m] | time of a trajectory, event-driven = 1 |\n|---|---:|---:|---:|")
    for method, step_s, error, seconds in rows:
        print(f"| {method} | {'' if step_s is None else f'{step_s:g}'} | {error:.2g} | {seconds / fastest:.3g} |")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
