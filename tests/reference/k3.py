#!/usr/bin/python3
"""Reference values of the impulse law k3, by mpmath with 60 correct digits.

Solves (13), (14) of van de Wouw & Leine, "Impulsive Control of Mechanical Motion Systems with Uncertain Friction", as
printed, by bisection in high precision: a method that has nothing in common with the library's but the equations.
Every input is a double and taken as exact, so the committed rows test the library's handling of its own inputs too.

Usage: tests/reference/k3.py > tests/reference/k3.csv
"""

import random
import sys

from mpmath import mp, mpf


def reference(mass, stiffness, damping, friction, distance):
    """(k3 [N s], time to go [s]) for a position error of -distance, from (12)-(15)."""
    # Digits for the cancellation in (14): 2 ln(1/Y) for a small distance and 1 for close poles, beside 60 to keep.
    relative = mpf(distance) * stiffness / friction
    mp.dps = 60
    mp.dps = int(100 + 2 * max(0, -mp.log10(relative)))
    m, k1, k22, f, y = (mpf(v) for v in (mass, stiffness, damping, friction, distance))
    omega2, half = k1 / m, k22 / (2 * m)
    root = mp.sqrt(half**2 - omega2)
    l1, l2 = -half + root, -half - root
    c = f / k1

    def f14(t):
        return c * (l2 / (l2 - l1) * mp.exp(-l1 * t) - l1 / (l2 - l1) * mp.exp(-l2 * t) - 1) + y

    low, high = mpf(0), mpf(1) / -l2
    while f14(high) > 0:
        low, high = high, 2 * high
    if low == 0:  # the solution is far below 1/|l2|: bracket it around the friction-only parabola
        guess = mp.sqrt(2 * y * m / f)
        low, high = guess / 8, guess * 2
        assert f14(low) > 0 > f14(high)
    # Illinois false position: superlinear, and never outside the bracket.
    at_low, at_high = f14(low), f14(high)
    for _ in range(4000):
        t = (low * at_high - high * at_low) / (at_high - at_low)
        at_t = f14(t)
        if at_t == 0 or abs(high - low) < t * mpf(10) ** -45:
            break
        if at_t * at_high < 0:
            low, at_low = high, at_high
        else:
            at_low /= 2
        high, at_high = t, at_t
    else:
        raise ArithmeticError("no convergence")
    assert abs(f14(t)) < y * mpf(10) ** -40
    speed = c * l1 * l2 / (l2 - l1) * (mp.exp(-l1 * t) - mp.exp(-l2 * t))
    return m * speed, t


def cases():
    random.seed(20240601)
    plants = [(1.0, 1.0, 2.5), (0.37, 1234.5, 0.81), (83.0, 0.019, 410.0)]
    zetas = [-14, -13, -12, -10, -8, -6, -4, -3, -2, -1, -0.3, 0, 0.5, 1, 2, 3, 4, 6, 8]
    distances = [-300, -200, -100, -50, -30, -20, -16, -14, -12, -10, -8, -6, -4, -3, -2, -1, -0.5, 0, 0.5, 1, 2, 4, 6]
    for index, zeta in enumerate(zetas):
        m, k1, f = plants[index % len(plants)]
        for distance in distances:
            yield m, k1, 2 * (m * k1) ** 0.5 * (1 + 10.0**zeta), f, f / k1 * 10.0**distance
    for _ in range(1200):
        m, k1, f = (10.0 ** random.uniform(-6, 6) for _ in range(3))
        k22 = 2 * (m * k1) ** 0.5 * (1 + 10.0 ** random.uniform(-13, 8))
        # Most rows where the two branches and both kinds of friction-limited motion meet, some very small.
        span = random.choice([(-3, 6), (-12, 6), (-300, 6)])
        yield m, k1, k22, f, f / k1 * 10.0 ** random.uniform(*span)
    for _ in range(150):  # extreme scales of force: the law is linear in (force, distance)
        f = 10.0 ** random.uniform(-300, 300)
        k22 = 2 * (1 + 10.0 ** random.uniform(-13, 8))
        yield 1.0, 1.0, k22, f, f * 10.0 ** random.uniform(-5, 2)


def main():
    print("mass_kg,k1,k22,friction_lower_N,distance_m,k3_Ns,time_to_go_s")
    for case in cases():
        mass, stiffness, damping, friction, distance = case
        if not damping**2 > 4 * stiffness * mass:
            mp.dps = 60
            if not mpf(damping) ** 2 > 4 * mpf(stiffness) * mass:
                continue
        k3, time = reference(*case)
        mp.dps = 40
        print(",".join(repr(v) for v in case), mp.nstr(k3, 20), mp.nstr(time, 20), sep=",")
    return 0


if __name__ == "__main__":
    sys.exit(main())
