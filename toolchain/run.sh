#!/usr/bin/env bash
# Builds the breakaway command and drives the axis of a scenario to its target in simulation.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/run.sh [SCENARIO.toml]

Installs what the build needs and the machine lacks (Debian packages, as root or by sudo), builds the breakaway
command, simulates the scenario (sim/scenarios/can_axis.toml unless another is given), and writes the results to
out/<scenario>.html and out/<scenario>.json. A relative path is looked up from where you call it.

Example: toolchain/run.sh sim/scenarios/impulsive_example.toml
HELP
}

scenario=$root/sim/scenarios/can_axis.toml
(($# <= 1)) || die "takes one scenario at most, got $#; see --help"
case ${1-} in
  -h | --help) usage && exit 0 ;;
  -*) die "unknown option '$1'; see --help" ;;
  ?*) scenario=$(realpath -m -- "$1") ;;
esac
[[ -r $scenario ]] || die "cannot read the scenario '$scenario'"

require_packages run
cd -- "$root"

# The tests need packages that running does not; a tree that test.sh has configured keeps them.
options=()
[[ -e build/release/CMakeCache.txt ]] || options=(-DBREAKAWAY_BUILD_TESTS=OFF)
cmake --preset release "${options[@]}" --log-level=WARNING
cmake --build --preset release --target breakaway_cli

mkdir -p out
name=$(basename -- "$scenario" .toml)
exec build/release/sim/cli/breakaway simulate "$scenario" --report "out/$name.html" --json "out/$name.json"
