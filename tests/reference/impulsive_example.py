#!/usr/bin/env python3
"""Reference values of the worked example of van de Wouw & Leine, section V, to 30 digits.

Renew with:  python3 tests/reference/impulsive_example.py > tests/reference/impulsive_example.csv
Needs mpmath. Nothing here is shared with the C++ code: the motion between kicks is summed as a Taylor series whose
coefficients come from recurrences, rest is a root of the velocity's polynomial, and k3 is the root of the printed
equations (12)-(14), all in 100-digit arithmetic (the printed form of (14) loses most of them near the target).
"""
from mpmath import mp, mpf, sin, cos, exp, sqrt, nstr

mp.dps = 100
ORDER = 60

M, G = mpf(1), mpf(10)
MU1, MU2, MU3, OMEGA = mpf("0.4"), mpf("0.3"), mpf("0.05"), mpf(4)
V_HALF = mpf("0.5")
MU_LO, MU_HI = mpf("0.25"), mpf("0.45")
K1, K21, K22 = mpf(1), mpf("0.5"), mpf(3)
KICKS_WRITTEN = 25


def taylor(t, x, v, k2, direction):
    """Coefficients of x and v about t for M v' = -K1 x - k2 v - direction M G mu(v, t), equation (2) with (16)."""
    xs, vs = [x], [v]
    slip = [1 + V_HALF * direction * v]  # 1 + |v|/2, and its reciprocal, as series
    inverse = [1 / slip[0]]
    wave = [sin(OMEGA * t), OMEGA * cos(OMEGA * t)]
    for n in range(ORDER):
        if n >= 2:
            wave.append(-OMEGA**2 * wave[n - 2] / (n * (n - 1)))
        mu = (MU1 - MU2) * inverse[n] + MU3 * wave[n] + (MU2 if n == 0 else 0)
        xs.append(vs[n] / (n + 1))
        vs.append((-K1 * xs[n] - k2 * vs[n] - direction * M * G * mu) / (M * (n + 1)))
        slip.append(V_HALF * direction * vs[n + 1])
        inverse.append(-sum(slip[j] * inverse[n + 1 - j] for j in range(1, n + 2)) / slip[0])
    return xs, vs


def value(coefficients, h):
    result = mpf(0)
    for c in reversed(coefficients):
        result = result * h + c
    return result


def reach_rest(t, x, v, k2, direction):
    """The first instant with v = 0 after (t, x, v), moving in `direction`."""
    while True:
        xs, vs = taylor(t, x, v, k2, direction)
        # A step of which the last terms are below the working precision of the velocity's own scale.
        scale = max(abs(c) for c in vs[:2]) if v == 0 else abs(v)
        h = min((scale * mpf(10) ** -(mp.dps - 5) / abs(vs[n])) ** (mpf(1) / n) for n in range(ORDER - 4, ORDER))
        points = [value(vs, h * i / 64) * direction for i in range(1, 65)]
        for i, speed in enumerate(points, start=1):
            if speed <= 0:
                low, tau = h * (i - 1) / 64, h * i / 64
                for _ in range(20):
                    middle = (low + tau) / 2
                    low, tau = (middle, tau) if value(vs, middle) * direction > 0 else (low, middle)
                for _ in range(8):
                    tau -= value(vs, tau) / value([n * c for n, c in enumerate(vs)][1:], tau)
                assert 0 < tau <= h * i / 64
                return t + tau, value(xs, tau)
        t, x, v = t + h, value(xs, h), value(vs, h)


def kick(y):
    """Velocity after the kick, by (12)-(15)."""
    omega_n = sqrt(K1 / M)
    zeta = K22 / (2 * sqrt(K1 * M))
    l1 = -omega_n * zeta + omega_n * sqrt(zeta**2 - 1)
    l2 = -omega_n * zeta - omega_n * sqrt(zeta**2 - 1)
    c_lo = M * G * MU_LO / K1
    d = l2 - l1
    distance = abs(y)

    def f(tau):  # (14) at t = t_j + tau, for the start on the negative side
        return c_lo * (l2 / d * exp(-l1 * tau) - l1 / d * exp(-l2 * tau) - 1) + distance

    def slope(tau):
        return c_lo * l1 * l2 / d * (exp(-l2 * tau) - exp(-l1 * tau))

    # Without spring and damper the flight is longer: Newton's method descends from there on a monotone, concave f.
    tau = sqrt(2 * distance / (G * MU_LO))
    for _ in range(60):
        tau -= f(tau) / slope(tau)
    assert abs(f(tau)) < distance * mpf(10) ** -30
    speed = abs(slope(tau))
    return speed if y < 0 else -speed


def main():
    c_lo, c_hi = M * G * MU_LO / K1, M * G * MU_HI / K1
    t, x, direction = mpf(0), mpf(-4), -1
    t, x = reach_rest(t, x, mpf(-4), K21, direction)
    while abs(x) > c_hi:  # outside the maximal stick set the spring always wins: it turns round
        direction = -1 if x > 0 else 1
        t, x = reach_rest(t, x, mpf(0), K21, direction)
    t1 = t
    kicks, t2, y2 = [], None, None
    while abs(x) > mpf(10) ** -60:
        if t2 is None and abs(x) <= c_lo:
            t2, y2 = t, x
        v = kick(x)
        kicks.append((t, x, v))
        t, x = reach_rest(t, x, v, K22, 1 if v > 0 else -1)
    bound = sqrt(2 * abs(y2) / (G * MU_LO)) / (1 - sqrt(1 - MU_LO / MU_HI))  # (19)

    def row(*cells):
        print(",".join(c if isinstance(c, str) else nstr(c, 30) for c in cells))

    print("# Section V of van de Wouw & Leine (impulsive control with uncertain friction): m = 1, g = 10, start (-4, -4).")
    print("# Written by impulsive_example.py; renew with:")
    print("#   python3 tests/reference/impulsive_example.py > tests/reference/impulsive_example.csv")
    print("# bound_s is t2 plus the right-hand side of (19). kick,time_s,position_m,velocity_after_m_s")
    for name, number in (("t1_s", t1), ("t2_s", t2), ("y2_m", y2), ("t_inf_s", t), ("bound_s", t2 + bound)):
        row(name, number)
    for number in kicks[:KICKS_WRITTEN]:
        row("kick", *number)


if __name__ == "__main__":
    main()
