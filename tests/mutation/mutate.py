#!/usr/bin/env python3
"""Puts one fault at a time into what is flashed, and lists the faults that no test notices.

One build holds all mutants; an environment variable switches one of them on. A first run of the tests notes which
mutants would make a difference in which test; then only those tests run, the quickest first, and the first that fails
ends the trial. Results are kept in the build folder, so that a run which was ended goes on where it was.

Examples:
  tests/mutation/mutate.py --room law                      every mutant of controller/law
  tests/mutation/mutate.py --room law --survivors          again those that survived, after tests were added
  tests/mutation/mutate.py --sample 100 --seed 7           100 lines drawn at random, one mutant of each
  tests/mutation/mutate.py --slice                         a few that were noticed before, anew
  tests/mutation/mutate.py --write                         all rooms, and the table of tests/mutation/RESULTS.md
"""

import argparse
import collections
import concurrent.futures
import fnmatch
import functools
import hashlib
import itertools
import json
import math
import os
import pathlib
import pickle
import random
import re
import resource
import signal
import subprocess
import sys
import time
import tomllib

import mutation_points

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent

ROOMS = {
    "law": ["controller/law/include/*"],
    "firmware": ["firmware/include/*"],
    "hal": ["hal/include/*"],
    "canopen": ["hal/canopen/*"],
    "cia402": ["hal/cia402/*"],
    "odrive": ["hal/odrive/*"],
    "ports": ["hal/ports/slcan/*", "hal/ports/bxcan/*", "hal/ports/xilinx_can/*", "hal/ports/socketcan/*"],
    # What sticks and what slips next, which every certificate and every simulated run rests on.
    "stick": [f"sim/motion/hybrid/src/{name}.cpp" for name in ("stop_problem", "lcp", "mode_choice")] +
             ["sim/motion/hybrid/include/breakaway/hybrid/hybrid_modes.hpp",
              "sim/motion/include/breakaway/motion/tie.hpp"],
}
# The stop path, the limits and the faults, of which every mutant must be noticed.
STOP_PATH = ["firmware/include/breakaway/firmware/supervisor.hpp",
             "firmware/include/breakaway/firmware/control_loop.hpp",
             "firmware/include/breakaway/firmware/law_model.hpp",
             "firmware/include/breakaway/firmware/commanded_force.hpp",
             "firmware/include/breakaway/firmware/motion_under_force.hpp",
             "firmware/include/breakaway/firmware/motion_without_force.hpp", "hal/cia402/src/forced_stop.cpp",
             "hal/cia402/src/state_machine.cpp", "hal/cia402/include/breakaway/cia402/force_watch.hpp",
             "hal/cia402/include/breakaway/cia402/torque_scale.hpp",
             # What a held axis may do unpushed, and which messages of a drive are errors.
             "controller/law/include/breakaway/law/held_axis.hpp", "hal/canopen/include/breakaway/canopen/emcy.hpp"]
# Test programs, from the quick ones of one room to the closed loop.
TESTS = ["law_test", "k3_table_test", "kick_coordinator_test", "recorded_runs_test", "hal_test", "canopen_test",
         "cia402_test", "recorded_scripts_test", "odrive_test", "firmware_test", "flashed_machine_test", "slcan_test",
         "bxcan_test", "xilinx_can_test", "socketcan_test", "socketcan_calls_test", "virtual_bus_test",
         "drive_emulator_test", "config_test", "sil_test", "moves_end_test", "fault_test", "tampering_test",
         "plants_test", "settling_test", "odrive_loop_test", "external_motion_test", "law_in_c_test"]
# Those of what is not flashed, which no other program reaches.
TESTS_OF = {"stick": ["hybrid_test"]}
# With assertions of the standard library an index or an optional gone wrong is noticed, whatever lies there.
COMPILE = ["-include", str(HERE / "switches.hpp"), "-w", "-Wno-narrowing", "-D_GLIBCXX_ASSERTIONS"]
# A quick look: so many mutants that this program noticed when they were drawn, because it is built within seconds.
SLICE = HERE / "slice.json"
SLICE_SIZE = 25
SLICE_TEST = "kick_coordinator_test"
NUMBERS_OF_A_FILE = 1024  # so that a change of one file leaves the numbers of the others, and what is built of them
MEMORY_BYTES = 4 << 30
STAGES_MS = (30, 100, 300, 1000, math.inf)  # tests up to this long, in time of the processor, run before the others
QUICK_MS = 100  # and those up to this long run whatever they take together
WAITING = 20  # times that of the processor that a test may take by the clock: it may wait, and others use the machine


def tracked_files():
    listed = subprocess.run(["git", "-c", f"safe.directory={ROOT}", "-C", str(ROOT), "ls-files", "-z", "--cached",
                             "--others", "--exclude-standard"], capture_output=True, text=True, check=True)
    return [name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]


def room_of(path):
    return next((room for room, patterns in ROOMS.items() if any(fnmatch.fnmatch(path, p) for p in patterns)), None)


class Mutants:
    """Every mutant of the rooms, or of some of their files, and the sources with the switches in."""

    def __init__(self, folder, files, only=None):
        read = ("controller/", "firmware/include", "hal/", "sim/motion/", "sim/input/")
        headers = [f for f in files if "/include/" in f and f.startswith(read)]
        flags = ["-I" + str(ROOT / f) for f in sorted({h[:h.index("include/") + 7] for h in headers})]
        flags += ["-isystem", "/usr/include/eigen3"]
        chosen = [f for f in files if room_of(f) and f.endswith((".hpp", ".cpp"))]
        folder.mkdir(parents=True, exist_ok=True)
        self.all, self.points, self.texts = [], {}, {}
        self.texts = {path: (ROOT / path).read_text() for path in chosen}
        first = {path: index * NUMBERS_OF_A_FILE + 1 for index, path in enumerate(chosen)}
        for path, points in self.found(folder, flags, [f for f in chosen if only is None or f in only]).items():
            self.points[path] = points
            self.number(path, points, self.texts[path], first[path])

    def found(self, folder, flags, chosen):
        """The points of the chosen files, which are kept until a file or the finder changes."""
        finder = (HERE / "mutation_points.py").read_text()
        stamp = hashlib.sha256(repr((finder, chosen, sorted(self.texts.items()))).encode()).hexdigest()
        kept = folder / "points.pickle"
        if kept.exists():
            old_stamp, points = pickle.loads(kept.read_bytes())
            if old_stamp == stamp:
                return points
        points = {path: self.find(folder, flags, path) for path in chosen}
        kept.write_bytes(pickle.dumps((stamp, points)))
        return points

    def find(self, folder, flags, path):
        source = ROOT / path
        if path.endswith(".hpp"):
            source = folder / "one_header.cpp"
            source.write_text(f'#include "{ROOT / path}"\n')
        tree = mutation_points.Tree(flags, str(source))
        return mutation_points.find_points(tree, str(ROOT / path), self.texts[path])

    def number(self, path, points, text, first):
        data, lines, seen = text.encode(), text.split("\n"), collections.Counter()
        for point in points:
            line = data[:point.begin].count(b"\n") + 1
            point.mutants = []
            for change in point.changes:
                mutant = mutation_points.Mutant(path, line, lines[line - 1].strip(), change, first + seen.total())
                seen[mutant.key] += 1
                if seen[mutant.key] > 1:
                    mutant.change += f", number {seen[mutant.key]} of the line"
                point.mutants.append(mutant)
                self.all.append(mutant)

    def mutated(self, path, left_out):
        """The text with its switches. Points with a mutant in left_out, which does not compile, stay as they are."""
        points = self.points[path]
        numbers = [None if any(m.key in left_out for m in p.mutants) else [m.id for m in p.mutants] for p in points]
        return mutation_points.apply(self.texts[path], points, numbers)


class Build:
    """The mutated copy and its test programs."""

    def __init__(self, folder, mutants, files, tests):
        self.folder, self.mutants, self.files, self.tests = folder, mutants, files, tests
        self.source, self.build = folder / "source", folder / "build"
        self.left_out_file = folder / "left_out.json"
        self.left_out = set(json.loads(self.left_out_file.read_text())) if self.left_out_file.exists() else set()

    def write(self, path, content):
        target = self.source / path
        if target.exists() and target.read_bytes() == content:
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)

    def copy(self):
        kept = set(self.files)
        for old in self.source.rglob("*") if self.source.exists() else []:
            if old.is_file() and str(old.relative_to(self.source)) not in kept:
                old.unlink()
        listener = f'\n#include "{HERE}/trace_listener.hpp"\n'.encode()
        for path in self.files:
            if path in self.mutants.points:
                content = self.mutants.mutated(path, self.left_out).encode()
            else:
                content = (ROOT / path).read_bytes()
                if re.match(r"tests/(unit|closed_loop)/.*_test\.cpp$", path):
                    content += listener
            self.write(path, content)

    def run(self, jobs):
        self.copy()
        if not (self.build / "build.ninja").exists():
            subprocess.run(["cmake", "-S", str(self.source), "-B", str(self.build), "-G", "Ninja",
                            "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1",
                            "-DCMAKE_CXX_FLAGS=" + " ".join(COMPILE),
                            "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=4",
                            "-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON"], check=True,
                           stdout=subprocess.DEVNULL)
        for _ in range(30):
            command = ["cmake", "--build", str(self.build), f"-j{jobs}", "--target", *self.tests, "--", "-k", "0"]
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            if done.returncode == 0:
                return
            faults = self.that_do_not_compile(done.stdout)
            if not faults:
                raise SystemExit("the mutated copy does not build:\n" + done.stdout[-6000:])
            print(f"  {len(faults)} points do not compile and are left out", flush=True)
            self.left_out |= faults
            self.left_out_file.write_text(json.dumps(sorted(self.left_out), indent=1))
            self.copy()
        raise SystemExit("the mutated copy does not build, whatever is left out")

    def that_do_not_compile(self, output):
        """The mutants at the places that the compiler names with an error."""
        faults = set()
        blocks = re.split(r"\n(?=\S*FAILED: |\[\d+/\d+\])", output)
        for block in blocks:
            if "error:" not in block:
                continue
            for error in re.finditer(r"^(?:.*\n)??.*error:.*$", block, re.M):
                around = block[max(0, error.start() - 3000):error.end() + 200]
                places = re.findall(r"/source/(\S+?):(\d+):(\d+)", around)
                for path, line, column in reversed(places):
                    found = self.at(path, int(line), int(column))
                    if found:
                        faults |= found
                        break
        return faults - self.left_out

    def at(self, path, line, column):
        """The keys of the innermost point at this place of the mutated text."""
        if path not in self.mutants.points:
            return set()
        text = (self.source / path).read_text().split("\n")[line - 1]
        before = re.findall(r"::mutation::\w+(?:<[^>]*>)?\((\d+)", text[:column + 12])
        for number in reversed(before):
            point = next((p for p in self.mutants.points[path] if any(m.id == int(number) for m in p.mutants)), None)
            keys = {m.key for m in point.mutants} if point else set()
            if not keys <= self.left_out:
                return keys
        return set()

    def program(self, test):
        found = [p for p in (self.build / "tests").rglob(test) if p.is_file() and os.access(p, os.X_OK)]
        return found[0] if found else None


class Tests:
    """What each test reaches, and trials of one mutant."""

    def __init__(self, build, folder):
        self.build, self.folder = build, folder
        self.programs = {t: build.program(t) for t in build.tests}
        self.reached = collections.defaultdict(list)  # id: (ms of the processor, program, test)

    def trace(self, jobs):
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            for program, lines in pool.map(self.trace_one, [t for t, p in self.programs.items() if p]):
                for name, ms, failed, *ids in lines:
                    if failed == "1":
                        print(f"  {program}: {name} fails without a mutant, and is left out", flush=True)
                        continue
                    for number in ids:
                        self.reached[int(number)].append((int(ms), program, name))
        for tests in self.reached.values():
            tests.sort()

    def trace_one(self, test):
        path = self.programs[test]
        out = self.folder / f"{test}.trace"
        stamp = (path.stat().st_mtime, path.stat().st_size)
        kept = self.folder / f"{test}.stamp"
        if not (kept.exists() and out.exists() and json.loads(kept.read_text()) == list(stamp)):
            environment = os.environ | {"BREAKAWAY_MUTANT": "trace", "BREAKAWAY_MUTANT_TRACE": str(out)}
            subprocess.run([path, "--gtest_brief=1"], env=environment, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL, cwd=self.folder, timeout=1800)
            kept.write_text(json.dumps(stamp))
        return test, [line.split(" ") for line in out.read_text().splitlines()]

    def trial(self, number, budget_ms):
        """("noticed", by which test) | ("survived", how many tests ran) | ("not reached", "")."""
        tests = self.reached.get(number, [])
        if not tests:
            return "not reached", ""
        affordable, spent = [], 0
        for test in tests:
            spent += test[0] if test[0] > QUICK_MS else 0
            if spent > budget_ms and affordable:
                break
            affordable.append(test)
        for begin, end in itertools.pairwise((-1, *STAGES_MS)):
            groups = collections.defaultdict(list)
            for test in affordable:
                if begin < test[0] <= end:
                    groups[test[1]].append(test)
            for program, group in sorted(groups.items(), key=lambda g: sum(t[0] for t in g[1])):
                failed = self.run(number, program, group)
                if failed:
                    return "noticed", failed
        return "survived", f"{len(affordable)} of {len(tests)} tests"

    def run(self, number, program, group):
        names = [t[2] for t in group]
        limit = 5 + math.ceil(6 * sum(t[0] for t in group) / 1000)
        command = [self.programs[program], "--gtest_fail_fast", "--gtest_brief=1", "--gtest_filter=" + ":".join(names)]
        try:
            done = subprocess.run(command, env=os.environ | {"BREAKAWAY_MUTANT": str(number)}, capture_output=True,
                                  timeout=WAITING * limit, cwd=self.folder,
                                  preexec_fn=functools.partial(bounded, limit))
        except subprocess.TimeoutExpired:
            return f"{program}: no end"
        if done.returncode == -signal.SIGXCPU:
            return f"{program}: no end"
        if done.returncode == 0:
            return None
        found = re.search(rb"\[  FAILED  \] (\S+?)[ ,(\n]", done.stdout)
        return f"{program}: {found[1].decode() if found else f'exit code {done.returncode}'}"


def bounded(processor_s):
    resource.setrlimit(resource.RLIMIT_CPU, (processor_s, processor_s + 5))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def words(code):
    """A line's text, however its parts are aligned."""
    return code.split()


class Equivalents:
    """Mutants that no test can notice, each with its reason: equivalent.toml."""

    def __init__(self, mutants, paths):
        self.reasons, self.stale = {}, []
        kept = HERE / "equivalent.toml"
        for entry in tomllib.loads(kept.read_text()).get("mutant", []) if kept.exists() else []:
            matching = [m for m in mutants if m.path.endswith(entry["file"]) and words(m.code) == words(entry["code"]) and
                        m.change in entry["changes"]]
            if not any(path.endswith(entry["file"]) for path in paths):
                continue
            missing = set(entry["changes"]) - {m.change for m in matching}
            self.stale += [f'{entry["file"]}: {entry["code"]}: {change}' for change in missing]
            for mutant in matching:
                self.reasons[mutant.key] = entry["reason"]


def of_the_rooms(files, options):
    """The files that are mutated. Those of the other rooms stay as they are, so that less is built and traced."""
    if not options.room:
        return None
    stop = STOP_PATH if "stop" in options.room else []
    return {f for f in files if room_of(f) in options.room or f in stop}


def tests_of(options):
    """The test programs that may reach the rooms."""
    chosen = list(TESTS) if not options.room or set(options.room) - set(TESTS_OF) else []
    for room, tests in TESTS_OF.items():
        chosen += tests if not options.room or room in options.room else []
    return [t for t in chosen if re.fullmatch(options.tests, t)]


def choose(mutants, options):
    chosen = mutants
    if options.room:
        stop = STOP_PATH if "stop" in options.room else []
        chosen = [m for m in chosen if room_of(m.path) in options.room or m.path in stop]
    if options.files:
        chosen = [m for m in chosen if any(fnmatch.fnmatch(m.path, f"*{pattern}") for pattern in options.files)]
    if options.sample:
        draw = random.Random(options.seed)
        lines = collections.defaultdict(list)
        for mutant in chosen:
            lines[(mutant.path, mutant.line)].append(mutant)
        drawn = draw.sample(sorted(lines), min(options.sample, len(lines)))
        chosen = [draw.choice(lines[line]) for line in drawn]
    return chosen


def counts(chosen, results, equivalents):
    counted = [m for m in chosen if m.key in results]
    rest = [m for m in counted if m.key not in equivalents.reasons]
    noticed = sum(results[m.key][0] == "noticed" for m in rest)
    return [len(chosen), len(counted), len(counted) - len(rest), noticed, len(rest) - noticed]


def row(name, numbers):
    rest = numbers[3] + numbers[4]
    share = f"{100 * numbers[3] / rest:.1f} %" if rest else "-"
    return f"| {name} | " + " | ".join(str(n) for n in numbers) + f" | {share} |"


STOP_ROW = "stop path, limits, faults"


def written_rows():
    """The rows of RESULTS.md as it is: of rooms that a run leaves alone they stay."""
    rows = {}
    for line in (HERE / "RESULTS.md").read_text().splitlines():
        found = re.fullmatch(r"\| ([^|]+) " + r"\| (\d+) " * 5 + r"\| [^|]+ \|", line)
        if found:
            rows[found[1]] = [int(n) for n in found.groups()[1:]]
    return rows


def whole_rooms(mutants):
    """The rooms of which every file was mutated. Of one with some of its files the row would say too little."""
    return {room for room in ROOMS if all(path in mutants.points for path in mutants.texts if room_of(path) == room)}


def table(mutants, results, equivalents, whole):
    lines = ["| room | mutants | tried | equivalent | noticed | survive | noticed of those that are not equivalent |",
             "|---|---|---|---|---|---|---|"]
    rows, here = written_rows(), {m.path for m in mutants}
    for room in ROOMS:
        chosen = [m for m in mutants if room_of(m.path) == room]
        if room in whole and any(m.key in results for m in chosen):
            rows[room] = counts(chosen, results, equivalents)
    if here.issuperset(STOP_PATH):
        rows[STOP_ROW] = counts([m for m in mutants if m.path in STOP_PATH], results, equivalents)
    named = [name for name in (*ROOMS, STOP_ROW) if name in rows]
    lines += [row(name, rows[name]) for name in named]
    lines.append(row("all", [sum(column) for column in zip(*(rows[room] for room in ROOMS if room in rows))]))
    return lines


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--room", action="append", choices=[*ROOMS, "stop"],
                        help="only of this room; stop: the stop path; may be given several times")
    parser.add_argument("--files", action="append", metavar="GLOB", help="only of files whose path ends so")
    parser.add_argument("--sample", type=int, metavar="N", help="N lines drawn at random, one mutant of each")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (default 1)")
    parser.add_argument("--survivors", action="store_true",
                        help="again those that were tried, were not noticed and are not listed as equivalent")
    parser.add_argument("--slice", action="store_true",
                        help="only the few of tests/mutation/slice.json, each of which was noticed, anew")
    parser.add_argument("--fresh", action="store_true", help="forgets what earlier runs found of these")
    parser.add_argument("--list", action="store_true", help="lists the mutants, builds and runs nothing")
    parser.add_argument("--jobs", type=int, default=2, help="at a time (default 2)")
    parser.add_argument("--budget", type=float, default=20, metavar="S",
                        help="processor time of the slow tests of one mutant (default 20 s)")
    parser.add_argument("--tests", default=".*", metavar="REGEX", help="only these test programs")
    parser.add_argument("--folder", type=pathlib.Path,
                        help="of the copy and the results (default build/mutation, build/mutation_slice for --slice)")
    parser.add_argument("--write", action="store_true", help="writes tests/mutation/RESULTS.md, and draws the slice")
    return parser.parse_args()


def try_all(chosen, tests, results, options, save):
    begin, done = time.monotonic(), 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        futures = {pool.submit(tests.trial, m.id, 1000 * options.budget): m for m in chosen}
        for future in concurrent.futures.as_completed(futures):
            mutant = futures[future]
            results[mutant.key] = future.result()
            done += 1
            if done % 25 == 0 or done == len(chosen):
                save()
                left = sum(results[m.key][0] != "noticed" for m in chosen if m.key in results)
                seconds = time.monotonic() - begin
                print(f"  {done} of {len(chosen)} tried in {seconds:.0f} s; {left} not noticed", flush=True)


def main():
    options = read_options()
    name = "build/mutation_slice" if options.slice else "build/mutation"
    options.folder = (options.folder or ROOT / name).resolve()
    files = tracked_files()
    if options.slice:
        return try_slice(files, options)
    mutants = Mutants(options.folder, files, of_the_rooms(files, options))
    equivalents = Equivalents(mutants.all, mutants.points)
    for entry in equivalents.stale:
        print(f"equivalent.toml names what is no longer there; take it out: {entry}")
    chosen = choose(mutants.all, options)
    print(f"{len(mutants.all)} mutants, {len(chosen)} chosen")
    if options.list:
        for m in chosen:
            print(f"{m.id} {m.path}:{m.line}: {m.change}   in: {m.code}")
        return 0
    kept = options.folder / "results.json"
    results = json.loads(kept.read_text()) if kept.exists() else {}
    for m in chosen if options.fresh else []:
        results.pop(m.key, None)
    build = Build(options.folder, mutants, files, tests_of(options))
    if options.survivors:
        chosen = [m for m in chosen if results.get(m.key, ("noticed",))[0] != "noticed" and
                  m.key not in equivalents.reasons]
    chosen = [m for m in chosen if m.key not in build.left_out]
    wanted = [m for m in chosen if options.survivors or m.key not in results]
    if wanted:
        build_and_try(build, wanted, results, options)
        note_run(options)
    chosen = [m for m in chosen if m.key not in build.left_out]
    report(chosen, results, equivalents)
    lines = table([m for m in mutants.all if m.key not in build.left_out], results, equivalents, whole_rooms(mutants))
    print("\n".join(lines))
    if options.write:
        write_results(lines, mutants, results, equivalents, build)
        draw_slice(mutants.all, results, options.seed)
    left = [m for m in chosen if results[m.key][0] != "noticed" and m.key not in equivalents.reasons]
    return 1 if left or equivalents.stale else 0


def try_slice(files, options):
    """The mutants of slice.json, anew: each must be noticed, and still be there."""
    keys = set(json.loads(SLICE.read_text()))
    mutants = Mutants(options.folder, files, {key.split("|")[0] for key in keys})
    chosen = [m for m in mutants.all if m.key in keys]
    results = {}
    build_and_try(Build(options.folder, mutants, files, [SLICE_TEST]), chosen, results, options)
    missed = [m for m in chosen if results[m.key][0] != "noticed"]
    for m in missed:
        print(f"{results[m.key][0]} {m.path}:{m.line}: {m.change}   in: {m.code}")
    gone = sorted(keys - {m.key for m in chosen})
    for key in gone:
        print(f"slice.json names what is no longer there; --write draws it anew: {key}")
    return 1 if missed or gone else 0


def build_and_try(build, wanted, results, options):
    print("building", flush=True)
    build.run(options.jobs)
    tests = Tests(build, options.folder)
    print("tracing", flush=True)
    tests.trace(options.jobs)

    def save():
        (options.folder / "results.json").write_text(json.dumps(results, indent=1))

    try_all([m for m in wanted if m.key not in build.left_out], tests, results, options, save)


def note_run(options):
    """Which of a room were tried: so that the table can say it."""
    if options.survivors:
        return
    parts = [f"--room {room}" for room in options.room or []] + [f"--files '{name}'" for name in options.files or []]
    parts += [f"--sample {options.sample} --seed {options.seed}"] if options.sample else []
    kept = options.folder / "runs.json"
    runs = json.loads(kept.read_text()) if kept.exists() else []
    run = " ".join(parts) or "every room"
    kept.write_text(json.dumps([r for r in runs if r != run] + [run], indent=1))


def report(chosen, results, equivalents):
    for m in chosen:
        verdict, by = results[m.key]
        if verdict == "noticed" and m.key in equivalents.reasons:
            print(f"not equivalent, take it out of equivalent.toml ({by} notices it): {m.path}:{m.line}: {m.change}")
        if verdict != "noticed" and m.key not in equivalents.reasons:
            print(f"{verdict} {m.path}:{m.line}: {m.change}   in: {m.code}" + (f"   ({by})" if by else ""))


def written_lists():
    """What RESULTS.md says of the runs, and of survivors by their place."""
    lines = (HERE / "RESULTS.md").read_text().splitlines()
    runs = [found[1] for line in lines if (found := re.fullmatch(r"- `mutate\.py (.+)`", line))]
    places = [line for line in lines if re.match(r"- `[^`]+:\d+`: ", line)]
    left_out = next((int(line.split()[0]) for line in lines if "do not compile" in line), 0)
    return runs, places, left_out


def write_results(lines, mutants, results, equivalents, build):
    left = [m for m in mutants.all if m.key not in equivalents.reasons and m.key not in build.left_out and
            results.get(m.key, ("noticed",))[0] != "noticed"]
    runs, places, left_out = written_lists()
    tried_rooms = {room_of(m.path) for m in mutants.all if m.key in results} & whole_rooms(mutants)
    tried_files = {m.path for m in mutants.all if m.key in results}
    path_of = {p: p.split("`")[1].rsplit(":", 1)[0] for p in places}
    places = [p for p in places if room_of(path_of[p]) not in tried_rooms and path_of[p] not in tried_files]
    text = ["# Faults put in, and noticed", "",
            "Written by `tests/mutation/mutate.py --write`; see [README.md](README.md).", "", *lines, "",
            f"{max(left_out, len(build.left_out))} further mutants do not compile and are not counted.", ""]
    kept = build.folder / "runs.json"
    new = json.loads(kept.read_text()) if kept.exists() else []
    runs = [run for run in runs if run not in new] + new
    if runs:
        text += ["Tried by (a run may have been ended before it was through):", ""]
        text += [f"- `mutate.py {run}`" for run in runs] + [""]
    places += [f"- `{m.path}:{m.line}`: {m.change}" for m in left]
    if places:
        text += ["## Not noticed yet", ""] + places + [""]
    (HERE / "RESULTS.md").write_text("\n".join(text))


def draw_slice(mutants, results, seed):
    known = {m.key for m in mutants}
    noticed = [key for key in sorted(known) if results.get(key, ("", ""))[1].startswith(f"{SLICE_TEST}: ")]
    if not noticed:  # another room was tried
        return
    keys = random.Random(seed).sample(noticed, min(SLICE_SIZE, len(noticed)))
    SLICE.write_text(json.dumps(sorted(keys), indent=1) + "\n")


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.exit(main())
