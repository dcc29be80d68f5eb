"""The table of all runs of long_run.sh, for tests/fuzz/RESULTS.md.

    results.py ROOT FOLDER
"""
import collections
import datetime
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "toolchain"))
import coverage  # noqa: E402: lies in toolchain

# Of each fuzzer: what it reads, and the files in which that is read.
PARSERS = {
    "pdo": ("mapped process data", ["hal/canopen/include/breakaway/canopen/pdo.hpp"]),
    "sdo_client": ("answers of an SDO server", ["hal/canopen/include/breakaway/canopen/sdo_client.hpp",
                                                "hal/canopen/src/sdo_client.cpp"]),
    "sdo_server": ("requests to an SDO server", ["hal/canopen/include/breakaway/canopen/sdo_server.hpp",
                                                 "hal/canopen/src/sdo_server.cpp"]),
    "slcan": ("the text of an slcan adapter", ["hal/ports/slcan/"]),
    "cia402_drive": ("whatever a drive says", ["hal/cia402/"]),
    "odrive_drive": ("whatever an ODrive says", ["hal/odrive/"]),
    "control_node": ("commands to a controller node, its objects by SDO, its drives",
                     [f"firmware/include/breakaway/firmware/{name}.hpp"
                      for name in ("remote_control", "node_objects", "served_port", "control_node")]),
    "law_image": ("the law image for C", ["firmware/c/", "firmware/include/breakaway/firmware/law_image.hpp"]),
    "data_sheet": ("EDS and DCF files of drives", ["firmware/config/src/data_sheet.cpp"]),
    "record_csv": ("records for `breakaway identify --log`", ["controller/identify/evaluation/src/record_csv.cpp"]),
    "scenario": ("nodes, axes and scenes in TOML", ["firmware/config/src/read_", "firmware/config/src/toml_section.cpp",
                                                    "sim/scenario/"]),
    "watch_stream": ("datagrams of `breakaway-node --stream`", ["sim/watch/src/datagram.cpp", "sim/watch/src/history.cpp"]),
    "watch_csv": ("runs that `breakaway watch` shows", ["sim/watch/src/csv_reader.cpp"]),
    "watch_command": ("commands over HTTP to `breakaway watch`", ["sim/watch/src/command.cpp"]),
    "watch_bus": ("frames that `breakaway watch` hears and answers", ["sim/watch/src/bus_listener.cpp",
                                                                      "sim/watch/src/commander.cpp"]),
}

HEAD = """# What the fuzzers searched

Under the address and undefined-behaviour sanitizers; what each fuzzer asks of what it reads is said in the head of its
file. Branches are outcomes, true or false, of the conditions in the files that read the input, seen in one run over the
inputs that were found; templates count once, and what is decided as the program is compiled is none. The seconds are those of the clock, on
processors that had other things to do, too. Written on {date} by

    tests/fuzz/long_run.sh FOLDER --seconds N && tests/fuzz/long_run.sh FOLDER --table

| fuzzer | reads | executions | seconds | findings | branches | taken |
|---|---|---|---|---|---|---|"""


def runs_of(folder):
    """Of each fuzzer: executions, seconds, findings."""
    sums = collections.defaultdict(lambda: [0, 0, 0])
    for line in (folder / "runs.txt").read_text().splitlines():
        name, _, executions, seconds, code = line.split(" ")
        for place, number in enumerate((int(executions or 0), int(seconds), int(code != "0"))):
            sums[name][place] += number
    return sums


def branches_of(folder, name, root):
    """The outcomes that were seen, and all, in the parser's own files; (0, 0) where they were not counted."""
    own = tuple(PARSERS[name][1])
    if not (folder / "coverage" / f"{name}.json").exists():
        return 0, 0
    seen = coverage.outcomes_of([folder / "coverage" / f"{name}.json"], str(root))
    missed, count = coverage.missed_of({place: c for place, c in seen.items() if place[0].startswith(own)},
                                       coverage.Sources(root))
    return count - len(missed), count


def main(root, folder):
    print(HEAD.format(date=datetime.date.today()))
    runs, total = runs_of(folder), [0, 0, 0]
    for name, (reads, _) in PARSERS.items():
        taken, count = branches_of(folder, name, root)
        total = [a + b for a, b in zip(total, runs[name])]
        executions, seconds, findings = runs[name]
        share = f"{taken} of {count} | {100 * taken / count:.1f} %" if count else "not counted |"
        print(f"| {name} | {reads} | {executions:,} | {seconds:,} | {findings} | {share} |")
    print(f"| all | | {total[0]:,} | {total[1]:,} | {total[2]} | | |")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]))
