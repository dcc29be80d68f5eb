"""Checks that parsers of other people read what `breakaway eds` writes, and read it as it is meant.

The npm package canopen loads each file and says what it has found; Wireshark, which reads an EDS to name the objects of Ethernet
POWERLINK, names every object in a capture that asks for each of them. Both are held against the sections and keys as Python's
configparser has them.

Example: python3 eds_parsers.py --command build/release/sim/cli/breakaway --source . --peers node_modules --parser wireshark
"""

import argparse
import configparser
import json
import pathlib
import re
import struct
import subprocess
import tempfile

SHEETS = (
    ("sim/scenarios/can_axis.toml", ("--node",)),
    ("sim/scenarios/can_axis.toml", ("--drive",)),
    ("firmware/examples/two_axes.toml", ("--node",)),
    ("firmware/examples/two_axes.toml", ("--drive", "--axis", "y")),
    ("sim/scenarios/coupled_gantry.toml", ("--node",)),
)
LISTS = ("MandatoryObjects", "OptionalObjects", "ManufacturerObjects")
OBJECT = re.compile(r"([0-9A-F]{4})(?:sub([0-9A-F]+))?")

NPM_READER = """
const { Eds } = require(process.argv[1] + '/canopen/source/eds');
const eds = new Eds();
eds.load(process.argv[2]);
const shown = (object) => [object.parameterName, object.objectType, object.dataType || 0, object.accessType || '',
                           object.pdoMapping ? 1 : 0];
const found = {};
for (const object of eds.values()) {
  const key = object.key.toUpperCase();
  found[key] = shown(object);
  if (object.subNumber === undefined) continue;
  for (let sub = 0; sub < 256; ++sub)
    if (object.at(sub) !== undefined) found[`${key}sub${sub.toString(16).toUpperCase()}`] = shown(object.at(sub));
}
console.log(JSON.stringify({ product: eds.deviceInfo.ProductName, objects: found }));
"""


def sheet(command, file, options, path):
    """Writes an EDS and returns it as configparser reads it."""
    subprocess.run([command, "eds", file, *options, "-o", path], check=True)
    parsed = configparser.RawConfigParser(inline_comment_prefixes=(";",))
    parsed.optionxform = str
    parsed.read(path)
    return parsed


def objects(parsed):
    """Section -> index, sub-index or None, keys."""
    found = {}
    for section in parsed.sections():
        match = OBJECT.fullmatch(section)
        if match:
            sub = None if match[2] is None else int(match[2], 16)
            found[section] = (int(match[1], 16), sub, parsed[section])
    listed = sum(int(parsed[name]["SupportedObjects"]) for name in LISTS)
    assert listed == sum(sub is None for _, sub, _ in found.values()), "the lists do not name every object"
    return found


def read_by_npm(peers, path, parsed):
    done = subprocess.run(["node", "-e", NPM_READER, peers, path], check=True, capture_output=True, text=True)
    answer = json.loads(done.stdout)
    assert answer["product"] == parsed["DeviceInfo"]["ProductName"], answer["product"]
    expected = {
        section: [keys["ParameterName"], int(keys["ObjectType"], 0), int(keys.get("DataType", "0"), 0), keys.get("AccessType", ""),
                  int(keys.get("PDOMapping", "0"))]
        for section, (_, _, keys) in objects(parsed).items()
    }
    # An access of "rwr" or "rww" is told as it stands, and a flag as text.
    assert answer["objects"].keys() == expected.keys(), answer["objects"].keys() ^ expected.keys()
    for section, wanted in expected.items():
        got = answer["objects"][section]
        assert got[:4] == wanted[:4], f"{section}: {got} instead of {wanted}"
    return len(expected)


def asking_frame(number, index, sub):
    """POWERLINK: the managing node reads an object of node 1."""
    sequence = bytes([(number % 64) << 2 | 2] * 2 + [0, 0])
    command = struct.pack("<BBBBHHHBB", 0, number % 256, 0, 2, 4, 0, index, sub, 0)
    frame = bytes.fromhex("01111e000004 00111e0000f0 88ab 06 01 f0 05") + sequence + command
    return frame.ljust(60, b"\0")


def write_capture(path, asked):
    with open(path, "wb") as capture:
        capture.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1))
        for number, (index, sub) in enumerate(asked, 1):
            frame = asking_frame(number, index, sub)
            capture.write(struct.pack("<IIII", number, 0, len(frame), len(frame)) + frame)


def read_by_wireshark(folder, path, parsed):
    found = objects(parsed)
    asked = [(index, sub or 0) for index, sub, _ in found.values()]
    write_capture(folder / "asked.pcap", asked)
    done = subprocess.run(
        ["tshark", "-r", folder / "asked.pcap", "-V", "-o", f'uat:epl_nodeid_profiles:"1","{path}"'],
        check=True, capture_output=True, text=True)
    named = re.findall(r"OD Index: 0x([0-9a-f]{4}) \((.*)\)\n\s*OD SubIndex: 0x([0-9a-f]{2}) \((.*)\)", done.stdout)
    assert len(named) == len(asked), f"{len(named)} of {len(asked)} requests are shown"
    for (index, name, sub, sub_name), (section, (_, own_sub, keys)) in zip(named, found.items()):
        shown = name if own_sub is None else sub_name
        assert shown == keys["ParameterName"], f"{section} is shown as {index}:{sub} {shown}"
    return len(named)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", required=True, help="the breakaway command")
    parser.add_argument("--source", required=True, type=pathlib.Path, help="the source tree")
    parser.add_argument("--peers", help="the node_modules with canopen")
    parser.add_argument("--parser", required=True, choices=("npm", "wireshark"))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for number, (file, arguments) in enumerate(SHEETS):
            path = str(folder / f"sheet{number}.eds")
            parsed = sheet(options.command, options.source / file, arguments, path)
            if options.parser == "npm":
                count = read_by_npm(options.peers, path, parsed)
            else:
                count = read_by_wireshark(folder, path, parsed)
            print(f"{file} {' '.join(arguments)}: {count} objects are read as they are written")


if __name__ == "__main__":
    main()
