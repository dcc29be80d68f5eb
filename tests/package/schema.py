"""Holds what `breakaway schema` writes against files that breakaway takes, and against some that it does not.

Example: python3 schema.py --command build/release/sim/cli/breakaway --source .
"""

import argparse
import copy
import json
import pathlib
import re
import subprocess
import sys
import tomllib

import jsonschema

# Of what the README of sim names with a backtick, these are commands and figures of results.
NOT_OF_A_FILE = {"simulate", "design", "study", "overshoot_m", "beyond_m", "peak_speed_m_s", "method",
                 "error_estimate_m", "refused"}
NAME = re.compile(r"`\[*([a-z][A-Za-z0-9_]*)\]*`")


def written(command):
    return json.loads(subprocess.run([command, "schema"], capture_output=True, check=True, timeout=60).stdout)


def new_file(command):
    """What `breakaway new` writes."""
    numbers = "--mass 12 --friction-lower 15 --friction-upper 28 --encoder 5e-7 --rate 1000 --force 200 --move 0.4"
    ended = subprocess.run([command, "new", *numbers.split(), "-o", "-"], capture_output=True, check=True, timeout=60)
    return ended.stdout.decode()


def files(source):
    """Every file of the project that is meant for the readers."""
    found = sorted([*(source / "sim" / "scenarios").glob("*.toml"), *(source / "firmware" / "examples").glob("*.toml")])
    if len(found) < 15:
        sys.exit(f"only {len(found)} files found: do they stand elsewhere now?")
    return {str(file.relative_to(source)): file.read_text(encoding="utf-8") for file in found}


def complaints(validator, document):
    return ["/".join(map(str, error.absolute_path)) + ": " + error.message for error in validator.iter_errors(document)]


def tables_of(value, path=()):
    """Every table of a document with the keys that lead to it."""
    if isinstance(value, dict):
        yield path, value
        for key, inner in value.items():
            yield from tables_of(inner, (*path, key))
    if isinstance(value, list):
        for place, inner in enumerate(value):
            yield from tables_of(inner, (*path, place))


def misspelt(document):
    """The document with one key wrong, for every key of every table, and the place of that table."""
    for path, table in tables_of(document):
        for key in table:
            spoilt = copy.deepcopy(document)
            inner = spoilt
            for step in path:
                inner = inner[step]
            inner[key + "x"] = inner.pop(key)
            yield path, key, spoilt


# What may stand behind keys that are texts of a certain kind, and what may not.
NODE = """[loop]
period_s = 0.001
[[axis]]
name = {name}
plant.mass_kg = 1
friction = {{ lower_N = 2.5, upper_N = 4.5 }}
controller = {{ k1_N_per_m = 400, k21_Ns_per_m = 32, k22_Ns_per_m = 60, max_force_N = 50 }}
limits = {{ position_m = 1, speed_m_s = 20 }}
[axis.drive]
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
max_torque_per_mille = 2000
node_id = {node_id}
{rating}
[run]
duration_s = 0.01
settle_tolerance_m = 1e-4
"""
SOUND = {"name": '"x-1_b.C"', "node_id": "7", "rating": "rated_torque_Nm = 0.5"}
SPOILT = [{"name": f'"{name}"'} for name in ("", " ", "\u00e9 x", "a b", "a" * 24)] + [
    {"rating": 'rated_torque_Nm = 0.5\neds = ""'}, {"rating": 'rated_torque_Nm = 0.5\neds = "-"'},
    {"node_id": "1.5"}, {"node_id": "128"}, {"name": "1"}]


def disagreements(command, validator):
    """Where reader and schema do not agree about one of these."""
    for spoilt in [{}, *SPOILT]:
        text = NODE.format(**{**SOUND, **spoilt})
        ended = subprocess.run([command, "simulate", "-", "--json", "-"], input=text.encode(), capture_output=True,
                               check=False, timeout=60)
        reader, schema = ended.returncode != 2, not complaints(validator, tomllib.loads(text))
        if (reader, schema) != (not spoilt, not spoilt):
            yield f"{spoilt or 'the sound node'}: the reader takes it: {reader}, the schema: {schema}; {ended.stderr}"


def names_in(value):
    """All keys and words of a schema."""
    if isinstance(value, dict):
        yield from value.get("properties", {})
        yield from value.get("enum", [])
        for inner in value.values():
            yield from names_in(inner)
    if isinstance(value, list):
        for inner in value:
            yield from names_in(inner)


def names_of_readme(source):
    text = (source / "sim" / "README.md").read_text(encoding="utf-8")
    scenarios = text[text.index("## Scenarios"):text.index("## What is exact and what is modelled")]
    return set(NAME.findall(scenarios)) - NOT_OF_A_FILE


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", required=True)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    options = parser.parse_args()
    schema = written(options.command)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    wrong, spoilt_files = [], 0
    for name, text in {**files(options.source), "what `new` writes": new_file(options.command)}.items():
        document = tomllib.loads(text)
        wrong += [f"{name}: {complaint}" for complaint in complaints(validator, document)]
        for path, key, spoilt in misspelt(document):
            spoilt_files += 1
            place = "/".join(map(str, path))
            if not any(said.startswith(f"{place}: ") and f"'{key}x'" in said for said in complaints(validator, spoilt)):
                wrong.append(f"{name}: {key}x in [{place}] is not complained of there")
    wrong += disagreements(options.command, validator)
    named = names_of_readme(options.source)
    for name in sorted(named - set(names_in(schema))):
        wrong.append(f"the README of sim names {name}, and the schema does not")
    print("\n".join(wrong))
    print(f"{spoilt_files} misspelt keys, {len(named)} names of the README, {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
