"""Machines of two coordinates under friction that varies with speed, position and time, to 18 digits.

Prints tests/reference/friction_law_machine.csv. Independent of the library: in all coordinates, with the forces of what
sticks as unknowns, by extrapolation of order 24 in short steps of one size in 30 digits, without error control; events
are roots of what must stay positive. With half the step, all printed values agree to 6e-20.
    python3 tests/reference/friction_law_machine.py > tests/reference/friction_law_machine.csv
Columns: case, kind (of an event, else end, q, v), direction, value, as in linear_machine.csv.
"""
import itertools
import sys

from mpmath import mp, mpf, matrix, nstr, findroot, pi, sin, exp, lu_solve, sign

mp.dps = 30
STEP = mpf(1) / int(sys.argv[1] if len(sys.argv) > 1 else 64)
ROWS = 12
TINY = mpf(10) ** -20


def stribeck(speed_scale):
    return lambda t, x, speed: speed_scale / (speed_scale + speed)


def gaussian(speed_scale):
    return lambda t, x, speed: exp(-((speed / speed_scale) ** 2))


def sine_in_time(frequency):
    return lambda t, x, speed: (1 + sin(frequency * t)) / 2


def sine_in_position(period):
    return lambda t, x, speed: (1 + sin(2 * pi * x / period)) / 2


def mean(*parts):
    return lambda t, x, speed: sum(part(t, x, speed) for part in parts) / len(parts)


def table(rows):
    return matrix([[mpf(entry) for entry in row] for row in rows])


# name, M, C, K, f, W (columns), laws (lower, upper, shape, varies with time), q, v, end. All numbers are exact in binary.
CASES = [
    ("stribeck", [["0.5", 0], [0, 2]], [["0.25", "-0.125"], ["-0.0625", "0.125"]], [[3, -1], [-1, "1.5"]], [0, 0],
     [[1, 0], [0, 1]], [("0.25", "0.5", stribeck(mpf("0.25")), False), ("0.375", "1", gaussian(mpf("0.5")), False)],
     [2, "-1.5"], ["0.5", 1], 12),
    ("drawn_joint", [[1, "0.25"], ["0.25", 1]], [["0.125", 0], [0, "0.0625"]], [[2, -1], [-1, 3]], ["0.5", "-0.25"],
     [[1, -1], [0, 1]], [("0.25", "0.75", mean(stribeck(mpf("0.5")), sine_in_time(4)), True),
                         ("0.125", "0.25", sine_in_position(mpf("0.5")), False)],
     [2, -1], [0, 1], 8),
]


class Machine:
    def __init__(self, mass, damping, stiffness, force, directions, laws):
        self.mass, self.damping, self.stiffness = table(mass), table(damping), table(stiffness)
        self.force = matrix([mpf(entry) for entry in force])
        self.w = table(directions).T
        self.laws = [(mpf(lower), mpf(upper), shape, varies) for lower, upper, shape, varies in laws]
        self.n, self.m = self.mass.rows, len(laws)

    def split(self, y):
        return matrix(y[: self.n]), matrix(y[self.n :])

    def level(self, i, t, q, speed):
        lower, upper, shape, _ = self.laws[i]
        return lower + (upper - lower) * shape(t, (self.w[:, i].T * q)[0], speed)

    def acceleration(self, mode, t, q, v):
        """Acceleration and multipliers of a mode (sign, or 0 for sticking), from M a - W lambda = f - C v - K q."""
        stuck = [i for i in range(self.m) if mode[i] == 0]
        size = self.n + len(stuck)
        left, right = mp.zeros(size), mp.zeros(size, 1)
        force = self.force - self.damping * v - self.stiffness * q
        for i in range(self.m):
            if mode[i] != 0:
                speed = mode[i] * (self.w[:, i].T * v)[0]
                force -= self.w[:, i] * (mode[i] * self.level(i, t, q, speed))
        right[: self.n] = force
        left[: self.n, : self.n] = self.mass
        for c, i in enumerate(stuck):
            for r in range(self.n):
                left[r, self.n + c] = -self.w[r, i]
                left[self.n + c, r] = self.w[r, i]
        answer = lu_solve(left, right)
        return answer[: self.n], {i: answer[self.n + c] for c, i in enumerate(stuck)}

    def slack(self, mode, t, y):
        """What must stay positive, by direction: sliding speed, or static friction left."""
        q, v = self.split(y)
        _, multipliers = self.acceleration(mode, t, q, v)
        speeds = self.w.T * v
        return [mode[i] * speeds[i] if mode[i] else self.level(i, t, q, 0) - abs(multipliers[i])
                for i in range(self.m)]

    def next_mode(self, t, y, stopped, sliding):
        """The mode with most sticking whose accelerations agree with it: stopped directions are free to choose."""
        q, v = self.split(y)
        for choice in sorted(itertools.product((0, 1, -1), repeat=len(stopped)), key=lambda c: sum(map(abs, c))):
            mode = list(sliding)
            for i, s in zip(stopped, choice):
                mode[i] = s
            a, multipliers = self.acceleration(mode, t, q, v)
            rates = self.w.T * a
            slides = all(mode[i] * rates[i] > TINY for i in stopped if mode[i])
            if slides and all(abs(multipliers[i]) < self.level(i, t, q, 0) for i in stopped if mode[i] == 0):
                return mode
        raise AssertionError("no mode")


def step(slope, t, y, h):
    """From (t, y) over h: the modified midpoint rule with 2, 4, .. 2 ROWS parts, extrapolated in their square."""
    column = []
    first = slope(t, y)
    for row in range(1, ROWS + 1):
        parts = 2 * row
        part = h / parts
        before, now = y, [a + part * d for a, d in zip(y, first)]
        for i in range(1, parts):
            rate = slope(t + i * part, now)
            before, now = now, [a + 2 * part * d for a, d in zip(before, rate)]
        value, kept = now, []
        for back, older in enumerate(column, start=1):
            kept.append(value)
            ratio = (mpf(row) / (row - back)) ** 2 - 1
            value = [v + (v - o) / ratio for v, o in zip(value, older)]
        column = kept + [value]
    return column[-1]


def follow(machine, mode, t, y, end):
    """(time, state, whether an event ends it there) of one mode from (t, y)."""

    def slope(time, at):
        q, v = machine.split(at)
        return list(v) + list(machine.acceleration(mode, time, q, v)[0])

    while t < end:
        h = min(STEP, end - t)
        following = step(slope, t, y, h)
        passed = [i for i, left in enumerate(machine.slack(mode, t + h, following)) if left < 0]
        if not passed:
            t, y = t + h, following
            continue
        roots = []
        for i in passed:
            left = lambda part: machine.slack(mode, t + part, step(slope, t, y, part))[i]
            roots.append(findroot(left, (h * mpf(10) ** -6, h), solver="anderson", tol=mpf(10) ** -48))
        h = min(roots)
        return t + h, step(slope, t, y, h), True
    return t, y, False


def simulate(machine, q, v, end):
    y, t, events = [mpf(e) for e in list(q) + list(v)], mpf(0), []
    speeds = machine.w.T * machine.split(y)[1]
    stopped = [i for i in range(machine.m) if speeds[i] == 0]
    mode = machine.next_mode(t, y, stopped, [int(sign(s)) for s in speeds])
    while True:
        t, y, ended_by_event = follow(machine, mode, t, y, end)
        if not ended_by_event:
            return y, t, events
        slack = machine.slack(mode, t, y)
        cause, before = slack.index(min(slack)), list(mode)
        if mode[cause] == 0:
            q_now, v_now = machine.split(y)
            _, multipliers = machine.acceleration(mode, t, q_now, v_now)
            mode = list(mode)
            mode[cause] = -int(sign(multipliers[cause]))
        else:
            stopped = [i for i in range(machine.m) if mode[i] == 0 or i == cause]
            mode = machine.next_mode(t, y, stopped, mode)
        for i in range(machine.m):
            if mode[i] != before[i]:
                kind = "stick" if mode[i] == 0 else "slip" if before[i] == 0 else "reversal"
                events.append((t, i, kind))
                print(nstr(t, 10), i, kind, file=sys.stderr)
        if all(s == 0 for s in mode) and not any(varies for *_, varies in machine.laws):
            return y[: machine.n] + [mpf(0)] * machine.n, t, events


print("case,kind,direction,value")
for name, mass, damping, stiffness, force, directions, laws, q, v, end in CASES:
    machine = Machine(mass, damping, stiffness, force, directions, laws)
    y, t, events = simulate(machine, q, v, mpf(end))
    for time, direction, kind in events:
        print(f"{name},{kind},{direction},{nstr(time, 25)}")
    print(f"{name},end,0,{nstr(t, 25)}")
    for i in range(machine.n):
        print(f"{name},q,{i},{nstr(y[i], 25)}")
    for i in range(machine.n):
        print(f"{name},v,{i},{nstr(y[machine.n + i], 25)}")
