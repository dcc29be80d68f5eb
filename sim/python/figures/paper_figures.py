"""Draws every figure of both papers that shows something computed, each from the scenario that holds its numbers.

[I] van de Wouw & Leine, "Impulsive Control of Mechanical Motion Systems with Uncertain Friction": Figures 2 to 6.
[A] van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
    Friction": Figures 2 and 4.

Needs matplotlib. Example: python3 paper_figures.py --scenarios sim/scenarios --folder figures
"""

import argparse
import pathlib
import tomllib

import breakaway
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (the backend has to be chosen first)

DRAWN = {}


def figure(name):
    def kept(draw):
        DRAWN[name] = draw
        return draw

    return kept


class Papers:
    def __init__(self, scenarios, points):
        self.impulsive = scenarios / "impulsive_example.toml"
        self.two_masses = scenarios / "two_mass_example.toml"
        self.points = points
        with open(self.impulsive, "rb") as file:
            self.axis = tomllib.load(file)
        with open(self.two_masses, "rb") as file:
            self.machine = tomllib.load(file)
        self.run = breakaway.simulate(self.impulsive)
        (self.samples,) = self.run.axes.values()

    def friction_N(self, bound):
        plant, friction = self.axis["plant"], self.axis["friction"]
        return plant["mass_kg"] * friction["gravity_m_s2"] * friction[f"mu_{bound}"]

    def k3(self, positions):
        controller = self.axis["controller"]
        return breakaway.k3(positions, mass_kg=self.axis["plant"]["mass_kg"], k1_N_per_m=controller["k1_N_per_m"],
                            k22_Ns_per_m=controller["k22_Ns_per_m"], friction_lower_N=self.friction_N("lower"))[0]


@figure("impulsive_2_kick_law")
@figure("impulsive_4_kick_law")
def kick_law(papers, axes):
    edge = papers.friction_N("upper") / papers.axis["controller"]["k1_N_per_m"]
    positions = np.linspace(-edge, edge, 801)
    axes.plot(positions, papers.k3(positions))
    axes.set(xlabel="position error $x_1$ [m]", ylabel="impulse $k_3$ [N s]", title="Impulsive control law, ζ > 1")


@figure("impulsive_3_friction")
def friction(papers, axes):
    force = papers.samples.friction_level_N
    weight = papers.axis["plant"]["mass_kg"] * papers.axis["friction"]["gravity_m_s2"]
    axes.plot(papers.samples.time_s, force / weight)
    bounds = [papers.friction_N(bound) / weight for bound in ("lower", "upper")]
    for level in (*bounds, sum(bounds) / 2):
        axes.axhline(level, linestyle="--", color="grey")
    axes.set(xlabel="time [s]", ylabel="friction coefficient μ", xlim=(0, 5), title="Friction along the response")


@figure("impulsive_5_response")
def response(papers, axes):
    axes.plot(papers.samples.time_s, papers.samples.position_m, label="$x_1$ [m]")
    axes.plot(papers.samples.time_s, papers.samples.velocity_m_s, label="$x_2$ [m/s]")
    for name in ("t1_s", "t2_s", "t_inf_s"):
        axes.axvline(papers.run.figures[name], linestyle=":", color="grey")
    axes.legend()
    axes.set(xlabel="time [s]", xlim=(0, 6), title="Response; dotted: $t_1$, $t_2$ and $t_∞$")


@figure("impulsive_6_phase_plane")
def phase_plane(papers, axes):
    axes.plot(papers.samples.position_m, papers.samples.velocity_m_s)
    stiffness = papers.axis["controller"]["k1_N_per_m"]
    for bound, width in (("upper", 3), ("lower", 6)):
        edge = papers.friction_N(bound) / stiffness
        axes.plot([-edge, edge], [0, 0], linewidth=width, alpha=0.5, label=f"stick set, {bound} bound")
    axes.legend()
    axes.set(xlabel="$x_1$ [m]", ylabel="$x_2$ [m/s]", title="Response and stick sets")


@figure("attractivity_2_region")
def region(papers, axes):
    window = 6
    basin = breakaway.basin(papers.two_masses, points=papers.points, window=window)
    axes.imshow(basin.fates, origin="lower", extent=(-window, window, -window, window), cmap="Greys_r", vmin=-1, vmax=1)
    machine = papers.machine["machine"]
    outline(axes, np.array(machine["stiffness"]), basin.figures["rho_star_J"], label="certified")
    equilibria(axes, np.array(machine["stiffness"]), np.array(machine["friction_N"]))
    axes.legend()
    axes.set(xlabel="$x_1$ [m]", ylabel="$x_2$ [m]", title="Region of attraction, and what Theorem 1 certifies")


@figure("attractivity_4_gains")
def gains(papers, axes):
    machine = papers.machine["machine"]
    found = breakaway.attract(papers.two_masses, depth=2)
    for row in found.figures["sweep"]:
        if row["rho_star_J"] is not None and np.isfinite(row["rho_star_J"]):
            outline(axes, np.array(machine["stiffness"]), row["rho_star_J"], label=f"$d_1$ = {row['d1']:g}")
    equilibria(axes, np.array(machine["stiffness"]), np.array(machine["friction_N"]))
    axes.legend()
    axes.set(xlabel="$x_1$ [m]", ylabel="$x_2$ [m]", xlim=(-25, 25), ylim=(-25, 25),
             title="Certified region for a growing derivative gain")


def outline(axes, stiffness, level_J, label):
    """The border of { q'K q / 2 < level } at rest."""
    angles = np.linspace(0, 2 * np.pi, 721)
    directions = np.array([np.cos(angles), np.sin(angles)])
    energies = np.einsum("ij,ik,kj->j", directions, stiffness, directions) / 2
    axes.plot(*(directions * np.sqrt(level_J / energies)), label=label)


def equilibria(axes, stiffness, friction_N):
    corners = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1], [1, 1]]).T * friction_N[:, None]
    axes.plot(*np.linalg.solve(stiffness, corners), color="black", label="equilibrium set")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenarios", type=pathlib.Path, default=pathlib.Path("sim/scenarios"))
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("figures"), help="is made where it is not")
    parser.add_argument("--points", type=int, default=301, help="of the region of attraction, along each axis")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    papers = Papers(options.scenarios, options.points)
    for name, draw in DRAWN.items():
        picture, axes = pyplot.subplots(layout="constrained")
        draw(papers, axes)
        picture.savefig(options.folder / f"{name}.svg")
        pyplot.close(picture)
        print(options.folder / f"{name}.svg")


if __name__ == "__main__":
    main()
