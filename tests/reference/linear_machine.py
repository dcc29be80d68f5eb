#!/usr/bin/env python3
"""Reference trajectories of linear machines with dry friction, eqs. (1) and (2) of van de Wouw & Leine, to 25 digits.

Renew with:  python3 tests/reference/linear_machine.py > tests/reference/linear_machine.csv
Needs mpmath. Nothing here is shared with the C++ code: the state is propagated by matrix exponentials of the whole
first-order system in 40-digit arithmetic, sticking directions are constraints with multipliers, events are bracketed
on a fine grid and bisected, and the next mode is found by trying all 3^m of them.

Rows: case, event, time, direction, kind, then the state at the end, as in the C++ test that reads them.
"""
import itertools
import sys

from mpmath import mp, mpf, matrix, eye, expm, nstr, zeros, lu_solve

mp.dps = 40
GRID = mpf(1) / 64
TINY = mpf(10) ** -25

# name, M, C, K, W (columns), friction, q, v, end. All numbers are exact in binary, so that C++ starts from the same.
CASES = [
    ("two_mass", [[1, 0], [0, 1]], [["0.125", "0.375"], ["0.375", "0.125"]], [[2, -1], [-1, 2]], [[1, 0], [0, 1]],
     [1, 1], ["2.5", -1], [0, 0], 60),
    ("unequal", [["0.5", 0], [0, 2]], [["0.25", "-0.125"], ["-0.0625", "0.125"]], [[3, -1], [-1, "1.5"]],
     [[1, 0], [0, 1]], ["0.375", "0.75"], [2, "-1.5"], ["0.5", 1], 60),
    ("chain_of_three", [[1, 0, 0], [0, "0.75", 0], [0, 0, "1.5"]],
     [["0.25", "-0.125", 0], ["-0.125", "0.1875", "-0.0625"], [0, "-0.0625", "0.125"]],
     [[3, -1, 0], [-1, 2, -1], [0, -1, "1.25"]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]], ["0.5", "0.25", "0.375"],
     [3, "-1", 2], [0, "0.5", "-1"], 60),
    ("one_joint_for_three", [[1, "0.25", 0], ["0.25", 1, 0], [0, 0, 2]],
     [["0.125", 0, 0], [0, "0.25", "-0.125"], [0, "-0.125", "0.25"]], [[2, -1, 0], [-1, 2, -1], [0, -1, 2]],
     [[1, -1, 0]], ["0.75"], [2, -1, 1], [0, 1, 0], 12),
    ("three_joints_for_two", [[1, 0], [0, "0.5"]], [["0.125", 0], [0, "0.0625"]], [[2, -1], [-1, 3]],
     [[1, 0], [0, 1], [1, -1]], ["0.25", "0.375", "0.5"], [3, -2], [1, 0], 60),
    ("relative_joints", [[2, 0, 0], [0, 1, 0], [0, 0, "0.5"]], [["0.125", 0, 0], [0, "0.125", 0], [0, 0, "0.125"]],
     [[2, -1, 0], [-1, 3, "-1.5"], [0, "-1.5", 2]], [[1, -1, 0], [0, 1, -1]], ["0.5", "0.25"], [1, -2, 1], [0, 0, 2],
     15),
    ("critically_damped", [[1, 0], [0, 1]], [[2, 0], [0, 4]], [[1, 0], [0, 4]], [[1, "0.5"], ["0.5", 1]],
     ["0.25", "0.125"], [2, -3], [0, 0], 20),
]


class Machine:
    def __init__(self, mass, damping, stiffness, directions, friction):
        self.mass, self.damping, self.stiffness = (self.table(a) for a in (mass, damping, stiffness))
        self.w = self.table(directions).T
        self.friction = [mpf(f) for f in friction]
        self.n, self.m = self.mass.rows, len(friction)

    @staticmethod
    def table(rows):
        return matrix([[mpf(entry) for entry in row] for row in rows])

    def acceleration(self, mode, q, v):
        """Acceleration and multipliers of a mode (sign, or 0 for sticking), from M a - W lambda = -C v - K q."""
        stuck = self.independent([i for i in range(self.m) if mode[i] == 0])
        size = self.n + len(stuck)
        left, right = zeros(size), zeros(size, 1)
        right[: self.n] = self.forces(mode, q, v)
        left[: self.n, : self.n] = self.mass
        for c, i in enumerate(stuck):
            for r in range(self.n):
                left[r, self.n + c] = -self.w[r, i]
                left[self.n + c, r] = self.w[r, i]
        answer = lu_solve(left, right)
        return answer[: self.n], {i: answer[self.n + c] for c, i in enumerate(stuck)}

    def forces(self, mode, q, v):
        force = -self.damping * v - self.stiffness * q
        for i in range(self.m):
            force -= self.w[:, i] * (mode[i] * self.friction[i])
        return force

    def independent(self, chosen):
        """A maximal independent part, by Gram-Schmidt."""
        kept, basis = [], []
        for i in chosen:
            rest = self.w[:, i].copy()
            for b in basis:
                rest -= b * (b.T * rest)[0]
            size = mp.sqrt((rest.T * rest)[0])
            if size > TINY:
                kept.append(i)
                basis.append(rest / size)
        return kept

    def generator(self, mode):
        """A with (q, v, 1)' = A (q, v, 1): columns are derivatives at unit states."""
        size = 2 * self.n + 1
        a = zeros(size)

        def slope(x):
            return self.acceleration(mode, x[: self.n], x[self.n : 2 * self.n])[0]

        origin = slope(zeros(2 * self.n, 1))
        for c in range(2 * self.n):
            unit = zeros(2 * self.n, 1)
            unit[c] = 1
            column = slope(unit) - origin
            for r in range(self.n):
                a[self.n + r, c] = column[r]
            if c >= self.n:
                a[c - self.n, c] = 1
        for r in range(self.n):
            a[self.n + r, size - 1] = origin[r]
        return a

    def slack(self, mode, x):
        """What must stay positive, by direction: sliding speed, or friction left (if its multiplier is unique)."""
        q, v = x[: self.n], x[self.n : 2 * self.n]
        speeds = self.w.T * v
        _, multipliers = self.acceleration(mode, q, v)
        stuck = [i for i in range(self.m) if mode[i] == 0]
        if len(stuck) != len(multipliers):
            assert len(multipliers) == self.n, "dependent sticking directions are followed only where all is at rest"
            return [mpf(1)] * self.m
        return [mode[i] * speeds[i] if mode[i] else self.friction[i] - abs(multipliers[i]) for i in range(self.m)]

    def next_mode(self, x, stopped, sliding):
        """The mode whose accelerations agree with it: stopped directions are free to choose."""
        q, v = x[: self.n], x[self.n : 2 * self.n]
        for choice in itertools.product((0, 1, -1), repeat=len(stopped)):
            mode = list(sliding)
            for i, s in zip(stopped, choice):
                mode[i] = s
            a, multipliers = self.acceleration(mode, q, v)
            speeds_up = self.w.T * a
            if any(mode[i] * speeds_up[i] <= TINY for i in stopped if mode[i]):
                continue
            if any(mode[i] == 0 and abs(speeds_up[i]) > TINY for i in stopped):
                continue
            stuck = [i for i in range(self.m) if mode[i] == 0]
            if len(multipliers) == len(stuck):
                if all(abs(multipliers[i]) < self.friction[i] for i in stuck):
                    return mode
            elif self.bearable(stuck, mode, q, v, a):
                return mode
        raise AssertionError("no mode")

    def bearable(self, stuck, mode, q, v, a):
        """Whether dependent directions can bear the force: one multiplier at either limit or all within, by choice."""
        need = self.mass * a - self.forces(mode, q, v)
        free = self.independent(stuck)
        others = [i for i in stuck if i not in free]
        gram = matrix([[(self.w[:, i].T * self.w[:, j])[0] for j in free] for i in free])
        steps = [mpf(k) / 200 for k in range(-200, 201)]
        for choice in itertools.product(steps, repeat=len(others)):
            rest = need.copy()
            for i, share in zip(others, choice):
                rest -= self.w[:, i] * (share * self.friction[i])
            multipliers = lu_solve(gram, matrix([(self.w[:, i].T * rest)[0] for i in free]))
            if all(abs(multipliers[c]) < self.friction[i] for c, i in enumerate(free)):
                return True
        return False


def simulate(machine, q, v, end):
    n, m = machine.n, machine.m
    x = matrix([mpf(e) for e in list(q) + list(v) + [1]])
    t, events = mpf(0), []
    speeds = machine.w.T * x[n : 2 * n]
    stopped = [i for i in range(m) if speeds[i] == 0]
    mode = machine.next_mode(x, stopped, [int(mp.sign(s)) for s in speeds])
    while t < end and not (all(s == 0 for s in mode) and all(abs(e) < TINY for e in x[n : 2 * n])):
        a = machine.generator(mode)
        step, h = expm(a * GRID), mpf(0)
        start = x.copy()
        # The grid's first point is skipped: a direction that has just begun to slide starts at zero.
        while t + h < end:
            following = step * x
            if min(machine.slack(mode, following)) < 0:
                break
            x, h = following, h + GRID
        if t + h >= end:
            return expm(a * (end - t)) * start, end, events
        low, high = h, h + GRID
        while high - low > mpf(10) ** -33:
            middle = (low + high) / 2
            if min(machine.slack(mode, expm(a * middle) * start)) < 0:
                high = middle
            else:
                low = middle
        x, t = expm(a * high) * start, t + high
        slack = machine.slack(mode, x)
        cause = slack.index(min(slack))
        before = list(mode)
        if mode[cause] == 0:
            _, multipliers = machine.acceleration(mode, x[:n], x[n : 2 * n])
            mode = list(mode)
            mode[cause] = -int(mp.sign(multipliers[cause]))
        else:
            speeds = machine.w.T * x[n : 2 * n]
            stopped = [i for i in range(m) if mode[i] == 0 or i == cause or abs(speeds[i]) < TINY]
            mode = machine.next_mode(x, stopped, mode)
        for i in range(m):
            if mode[i] != before[i]:
                kind = "stick" if mode[i] == 0 else "slip" if before[i] == 0 else "reversal"
                events.append((t, i, kind))
    return x, t, events


print("case,kind,direction,value")
for name, mass, damping, stiffness, directions, friction, q, v, end in CASES:
    machine = Machine(mass, damping, stiffness, directions, friction)
    x, t, events = simulate(machine, q, v, mpf(end))
    for time, direction, kind in events:
        print(f"{name},{kind},{direction},{nstr(time, 25)}")
    print(f"{name},end,0,{nstr(t, 25)}")
    for i in range(machine.n):
        print(f"{name},q,{i},{nstr(x[i], 25)}")
    for i in range(machine.n):
        print(f"{name},v,{i},{nstr(x[machine.n + i], 25)}")
    print(name, len(events), file=sys.stderr)
