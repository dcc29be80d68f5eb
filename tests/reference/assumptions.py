#!/usr/bin/python3
"""Reference values for the checks of Assumption 3, by mpmath with 40 correct digits.

Columns: zeta of the kick phase; the threshold of f_lower/f_upper by (18) of van de Wouw & Leine, "Impulsive Control of
Mechanical Motion Systems with Uncertain Friction", as printed; the exact threshold, found by letting a kick from the
outer edge of the stick set run under the upper friction bound and looking where it stops.

Usage: tests/reference/assumptions.py > tests/reference/assumptions.csv
"""

import sys

from mpmath import mp, mpf

sys.dont_write_bytecode = True  # leave no cache beside the sources
from k3 import reference  # noqa: E402


def poles(zeta):
    root = mp.sqrt(zeta**2 - 1)
    return -zeta + root, -zeta - root


def threshold_18(zeta):
    l1, l2 = poles(zeta)
    a1 = -l1 / (l2 - l1)
    return 1 - (l1 / l2) ** (-a1)


def stop_after_kick(zeta, ratio):
    """Where the axis (m = k1 = f_upper = 1) stops that was kicked at -c_upper = -1, with f_lower = ratio."""
    impulse, _ = reference(1, 1, 2 * zeta, ratio, 1)
    mp.dps = 40
    l1, l2 = poles(zeta)
    # x = -1 + z, z'' = -2 zeta z' - z with z(0) = 0, z'(0) = impulse; stops where z' = 0.
    t = mp.log(l2 / l1) / (l1 - l2)
    return -1 + impulse * (mp.exp(l1 * t) - mp.exp(l2 * t)) / (l1 - l2)


def exact_threshold(zeta):
    # -stop is how far from the target it stops; it must be within c_lower = ratio.
    return mp.findroot(lambda ratio: stop_after_kick(zeta, ratio) + ratio, (mpf("0.001"), mpf("0.4")),
                       solver="anderson", tol=1e-25)


def main():
    mp.dps = 40
    print("zeta,threshold_18,exact_threshold")
    for text in ["1.000001", "1.03125", "1.125", "1.25", "1.5", "2", "3", "5", "10", "17"]:
        zeta = mpf(float(text))
        exact = exact_threshold(zeta)
        mp.dps = 40
        print(text, mp.nstr(threshold_18(zeta), 18), mp.nstr(exact, 18), sep=",")


if __name__ == "__main__":
    main()
