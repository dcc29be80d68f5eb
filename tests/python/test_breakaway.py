"""`import breakaway` says what the command says, gives arrays that are no copies, and refuses as the command does."""

import doctest
import gc
import json
import pathlib
import signal
import subprocess
import tomllib

import breakaway
import numpy as np
import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENARIOS = SOURCE / "sim" / "scenarios"


def command(request, *arguments):
    ended = subprocess.run([request.config.getoption("--command"), *map(str, arguments), "--json", "-"], check=False,
                           capture_output=True, text=True, timeout=300)
    return json.loads(ended.stdout)


def without_times(figures):
    return {key: value for key, value in figures.items() if key not in ("wall_s", "seconds", "trajectories_per_s")}


def test_k3_is_the_command_s_in_any_shape(request):
    plant = {"mass_kg": 1, "k1_N_per_m": 1, "k22_Ns_per_m": 3, "friction_lower_N": 2.5}
    positions = np.array([[-0.1, 1e-6], [0.02, 2.0]])
    impulse, time = breakaway.k3(positions, **plant)
    assert impulse.shape == time.shape == positions.shape
    rows = command(request, "k3", "--mass", 1, "--k1", 1, "--k22", 3, "--friction-lower", 2.5,
                   *(f"--position={y}" for y in positions.ravel()))["rows"]
    assert [row["k3_Ns"] for row in rows] == list(impulse.ravel())
    assert [row["time_to_go_s"] for row in rows] == list(time.ravel())


@pytest.mark.parametrize("name", ["can_axis.toml", "impulsive_example.toml", "two_mass_example.toml", "three_axes.toml"])
def test_simulate_gives_the_figures_of_the_command(request, name):
    # To record a trace is to stop more often, which changes the rounding of the ideal law's figures.
    run = breakaway.simulate(SCENARIOS / name, trace=False)
    assert without_times(run.figures) == without_times(command(request, "simulate", SCENARIOS / name))


def test_samples_outlive_the_run_and_are_not_copied():
    axes = breakaway.simulate(SCENARIOS / "can_axis.toml").axes
    (axis,) = axes.values()
    position, force = axis.position_m, axis.force_N
    del axes, axis
    gc.collect()
    assert position.base is not None and not position.flags.owndata and not position.flags.writeable
    assert len(position) == len(force) > 1000
    assert abs(position[-1]) < 1e-4 and np.abs(force).max() > 1
    assert not hasattr(breakaway.simulate(SCENARIOS / "can_axis.toml", trace=False), "position_m")


def test_a_machine_s_samples_are_rows_of_its_coordinates():
    run = breakaway.simulate(SCENARIOS / "two_mass_example.toml")
    assert run.q.shape == run.v.shape == (len(run.time_s), 2)
    assert list(run.q[0]) == [2.5, -1] and list(run.q[-1]) == run.figures["q_end"]
    assert np.all(np.diff(run.time_s) >= 0)


def test_a_text_is_read_as_the_file_is():
    text = (SCENARIOS / "can_axis.toml").read_text(encoding="utf-8")
    assert without_times(breakaway.simulate(text).figures) == without_times(
        breakaway.simulate(SCENARIOS / "can_axis.toml").figures)


@pytest.mark.parametrize("name", ["braked_axis.toml", "belt_axis.toml", "coupled_gantry.toml", "three_axes.toml"])
def test_design_gives_the_checks_of_the_command(request, name):
    assert breakaway.design(SCENARIOS / name) == command(request, "design", SCENARIOS / name)


@pytest.mark.parametrize("changed", [
    ("k21_Ns_per_m = 32", "k21_Ns_per_m = 39.9999999"),  # no number of the law in float
    ('kind = "sine_in_time"', 'kind = "sine_in_position", period_m = 1e-6'),  # nothing that simulate takes
])
def test_design_refuses_what_the_command_refuses(request, tmp_path, changed):
    text = (SCENARIOS / "can_axis.toml").read_text(encoding="utf-8")
    assert changed[0] in text
    file = tmp_path / "axis.toml"
    file.write_text(text.replace(*changed).replace(", angular_frequency_rad_s = 4", ""), encoding="utf-8")
    ended = subprocess.run([request.config.getoption("--command"), "design", file], check=False, capture_output=True,
                           text=True, timeout=300)
    assert ended.returncode == 2
    assert ended.stderr.strip() == f"breakaway: {refused(breakaway.design, file)}"


def test_no_kick_of_the_table_goes_beyond_the_distance_that_it_is_for():
    distances = np.geomspace(1e-6, 1e-1, 200)
    table = breakaway.kick_table(SCENARIOS / "braked_axis.toml", distances)
    within = distances >= table.least_distance_m
    assert within.any() and np.all(table.most_m[within] <= distances[within])
    assert np.all(table.least_m <= table.most_m) and np.all(table.periods == np.rint(table.periods))


def test_study_gives_the_rows_of_the_command(request):
    file = SCENARIOS / "braked_axis.toml"
    rows = breakaway.study(file, starts=[(-4.1, 0)], laws=3)
    assert rows == command(request, "study", file, "--start", -4.1, 0, "--laws", 3)
    assert rows["rows"][0]["settled"] == 7


def test_attract_gives_the_command_s_findings_and_the_cells_behind_them(request):
    file = SCENARIOS / "two_mass_example.toml"
    found = breakaway.attract(file, depth=5)
    assert found.figures == command(request, "attract", file, "--depth", 5)
    side = 2 * found.figures["window"] / 2.0**found.level
    assert (side**2)[found.proved == 1].sum() == pytest.approx(found.figures["certified_area"], rel=1e-12)


def test_a_basin_is_two_arrays_that_look_into_the_library_s_memory(request):
    file = SCENARIOS / "two_mass_example.toml"
    basin = breakaway.basin(file, points=31, window=6)
    assert basin.fates.shape == basin.times_s.shape == (31, 31) and basin.fates.dtype == np.int8
    assert not basin.fates.flags.owndata and not basin.times_s.flags.owndata
    assert (basin.fates == 1).sum() == basin.figures["attracted"]
    assert without_times(basin.figures) == without_times(command(request, "basin", file, "--grid", 31, "--window", 6))
    assert basin.coordinates[0] == -6 and basin.coordinates[-1] == 6


def test_tune_gives_a_file_that_is_certified():
    tuned = breakaway.tune(SCENARIOS / "braked_axis.toml", laws=2)
    assert breakaway.design(tuned.text)["certified"]
    assert tomllib.loads(tuned.text)["controller"]["coast"] == tuned.figures["chosen"]["coast"]


def test_identify_gives_a_file_with_what_was_found():
    file = SCENARIOS / "braked_axis.toml"
    found = breakaway.identify(file, lowest_m=-4.5, highest_m=-3.5)
    told = tomllib.loads(file.read_text(encoding="utf-8"))
    mass = tomllib.loads(found.text)["told"]["mass_kg"] if "told" in tomllib.loads(found.text) else None
    mass = mass or tomllib.loads(found.text)["plant"]["mass_kg"]
    assert mass == pytest.approx(told["plant"]["mass_kg"], rel=0.02)


def refused(call, *arguments, **options):
    with pytest.raises(breakaway.InputError) as caught:
        call(*arguments, **options)
    text = str(caught.value)
    assert "\n" not in text and isinstance(caught.value, ValueError)
    return caught.value


def test_what_cannot_be_used_is_refused_with_key_and_remedy():
    text = (SCENARIOS / "can_axis.toml").read_text(encoding="utf-8")
    error = refused(breakaway.design, text.replace("k1_N_per_m", "k1_N_per_mm"))
    assert error.file == "<text>:21" and "k1_N_per_mm" in str(error) and "nearest valid key" in error.problem
    error = refused(breakaway.k3, [float("nan")], mass_kg=1, k1_N_per_m=1, k22_Ns_per_m=3, friction_lower_N=1)
    assert error.key == "position_m" and "not finite" in error.problem
    assert "zeta > 1" in str(refused(breakaway.k3, 1, mass_kg=1, k1_N_per_m=1, k22_Ns_per_m=1, friction_lower_N=1))
    assert "mass_kg" in str(refused(breakaway.k3, 1, mass_kg=float("nan"), k1_N_per_m=1, k22_Ns_per_m=3,
                                    friction_lower_N=1))
    two_masses = SCENARIOS / "two_mass_example.toml"
    assert "plane" in str(refused(breakaway.basin, two_masses, points=11, window=6, plane=(0, 4)))
    assert "window" in str(refused(breakaway.basin, two_masses, points=11, window=float("nan")))
    assert "window" in str(refused(breakaway.basin, two_masses, points=11, window=1e300))
    assert "window" in str(refused(breakaway.attract, two_masses, window=1e300))
    assert "points" in str(refused(breakaway.basin, two_masses, points=1, window=6))
    assert "depth" in str(refused(breakaway.attract, two_masses, depth=15))
    assert "accuracy_m" in str(refused(breakaway.simulate, two_masses, accuracy_m=-1.0))
    for call in (breakaway.study, breakaway.tune, breakaway.identify):
        assert "axis=" in str(refused(call, SCENARIOS / "three_axes.toml"))
    assert "describes an axis" in str(refused(breakaway.attract, SCENARIOS / "can_axis.toml"))
    assert "time, accuracy or gentle" in str(refused(breakaway.tune, SCENARIOS / "can_axis.toml", objective="speed"))
    assert "coast" in str(refused(breakaway.kick_table, SCENARIOS / "can_axis.toml", [1e-3]))
    assert "one coordinator" in str(refused(breakaway.kick_table, SCENARIOS / "coupled_gantry.toml", [1e-3]))
    assert "several axes" in str(refused(breakaway.kick_table, SCENARIOS / "two_axes.toml", [1e-3]))
    too_much = (SCENARIOS / "braked_axis.toml").read_text(encoding="utf-8").replace("mu_upper = 0.45", "mu_upper = 5.9")
    assert "no kick that is sure to move" in str(refused(breakaway.kick_table, too_much, [1e-3]))
    assert "laws" in str(refused(breakaway.tune, SCENARIOS / "can_axis.toml", laws=-1))
    assert "laws" in str(refused(breakaway.study, SCENARIOS / "can_axis.toml", laws=1_000_001))
    for call, more in ((breakaway.study, {}), (breakaway.tune, {}), (breakaway.attract, {}),
                       (breakaway.basin, {"points": 11, "window": 6})):
        file = SCENARIOS / ("can_axis.toml" if call in (breakaway.study, breakaway.tune) else "two_mass_example.toml")
        for threads in (-1, 1025):
            assert "threads" in str(refused(call, file, threads=threads, **more))
    assert "record" in str(refused(breakaway.identify, SCENARIOS / "braked_axis.toml", record="a\n", highest_m=1))
    assert str(refused(breakaway.k3, 1e308, mass_kg=1, k1_N_per_m=1, k22_Ns_per_m=3,
                       friction_lower_N=1)).startswith("position_m of 1e+308 m")
    with pytest.raises(FileNotFoundError):
        breakaway.design("nothere.toml")


@pytest.mark.parametrize(("call", "name", "options"), [
    (breakaway.simulate, "accuracy_m", {"accuracy_m": "1e-6"}), (breakaway.study, "laws", {"laws": 1.5}),
    (breakaway.tune, "seed", {"seed": -1}), (breakaway.identify, "lowest_m", {"lowest_m": "left"}),
    (breakaway.kick_table, "axis", {"distance_m": 1e-3, "axis": None}), (breakaway.attract, "plane", {"plane": (0, 1, 2)}),
    (breakaway.basin, "points", {"points": 1.5, "window": 6})])
def test_a_signature_with_names_says_which_types_there_are(call, name, options):
    with pytest.raises(TypeError, match=rf"\b{name}: "):
        call(SCENARIOS / "braked_axis.toml", **options)


def test_every_function_is_explained_with_an_example():
    for name in breakaway.__all__:
        thing = getattr(breakaway, name)
        assert thing.__doc__, name
        if callable(thing) and not isinstance(thing, type):
            assert ">>> " in thing.__doc__ and f"breakaway.{name}" in thing.__doc__, name


def test_every_example_runs(monkeypatch):
    monkeypatch.chdir(SOURCE)
    known = {"breakaway": breakaway}
    for name in ("", *breakaway.__all__):
        thing = getattr(breakaway, name) if name else breakaway
        for example in doctest.DocTestParser().get_examples(thing.__doc__):
            exec(example.source, known)  # noqa: S102: the source is our own


class Stopped(Exception):
    """What the handler of a signal throws, as Python's own does on Ctrl-C."""


@pytest.mark.parametrize("takes_hours", [
    lambda: breakaway.simulate((SCENARIOS / "can_axis.toml").read_text().replace(
        "duration_s = 30", "duration_s = 1e6\nstop_when_settled = false"), trace=False),
    lambda: breakaway.study(SCENARIOS / "can_axis.toml", laws=100_000, threads=2),
    lambda: breakaway.tune(SCENARIOS / "can_axis.toml", laws=100_000, threads=2),
    lambda: breakaway.attract(SCENARIOS / "two_mass_example.toml", depth=14, threads=2),
    lambda: breakaway.basin(SCENARIOS / "two_mass_example.toml", points=4000, window=10, threads=2),
], ids=["simulate", "study", "tune", "attract", "basin"])
def test_a_signal_ends_what_would_take_hours(takes_hours):
    def stop(*_):
        raise Stopped

    before = signal.signal(signal.SIGALRM, stop)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(Stopped):
            takes_hours()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
