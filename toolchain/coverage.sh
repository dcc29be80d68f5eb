#!/usr/bin/env bash
# Measures the branch coverage of the controller and of the hardware abstraction.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/coverage.sh [--missed | --write] [ROOM...]

Builds the unit tests of controller, hal, firmware and the reading of descriptions, the closed-loop tests and the fuzzers with clang's branch counters,
runs them (the fuzzers over their corpus only), and prints for each room how many outcomes of its conditions were ever
seen. Instantiations of a template count as one; what is decided as the program is compiled is no condition. It takes as long as
a build of these tests: half an hour on two processors.

  --missed   lists every outcome that never came, as file:line:column
  --write    writes tests/COVERAGE.md, with the reasons of toolchain/coverage_reasons.toml
  ROOM       such as hal/cia402 or controller/law; without one, all rooms of controller and hal

Example: toolchain/coverage.sh --missed controller/law
Exit codes: 0 measured, 1 a test failed, 2 the machine or the command line is at fault.
HELP
}

options=() rooms=() page=/dev/stdout
for argument in "$@"; do
  case $argument in
    -h | --help) usage && exit 0 ;;
    --missed) options+=(--missed) ;;
    --write) options+=(--page) && page=$root/tests/COVERAGE.md ;;
    -*) die "unknown option '$argument'; see --help" ;;
    *) rooms+=("$argument") ;;
  esac
done
((${#rooms[@]} == 0)) || options+=(--rooms "${rooms[@]}")

require_packages run build test
cd -- "$root"
build=$root/build/coverage

# names <function> <folder>...: what its calls in the CMakeLists.txt there name.
names() {
  local files=("${@:2}")
  sed -n "s/^ *$1(\([a-z0-9_]*\).*/\1/p" "${files[@]/%//CMakeLists.txt}"
}
unit=(law identify design stability input config scenario hal canopen cia402 odrive virtual_bus slcan bxcan socketcan xilinx_can firmware c)
mapfile -t tests <<<"$(names breakaway_test "${unit[@]/#/tests/unit/}" tests/closed_loop)"
mapfile -t fuzzers <<<"$(names breakaway_fuzzer tests/fuzz)"

# A test is run once as it is built, to be asked for its cases: what that counts is of no use.
export LLVM_PROFILE_FILE=$build/asked.profraw
"$toolchain/coverage_build.sh" "$build" "${tests[@]}" "${fuzzers[@]/#/fuzz_}"

programs=("${tests[@]}" "${fuzzers[@]/#/fuzz_}") failed=0
rm -rf -- "$build/profiles"
mkdir -p -- "$build/profiles"
for name in "${programs[@]}"; do
  program=$(find "$build/tests" -type f -executable -name "$name")
  arguments=()
  if [[ $name == fuzz_* ]]; then
    # The fuzzer of scenarios begins with those of the simulation and has no corpus of its own.
    corpus=$root/tests/fuzz/corpus/${name#fuzz_}
    [[ -d $corpus ]] || corpus=$root/sim/scenarios
    arguments=(-runs=0 "$corpus")
  fi
  LLVM_PROFILE_FILE=$build/profiles/$name.profraw "$program" "${arguments[@]}" >"$build/profiles/$name.log" 2>&1 || failed=1
  ((failed == 0)) || { printf 'coverage: %s failed, see %s\n' "$name" "$build/profiles/$name.log" >&2 && exit 1; }
  llvm-profdata merge -sparse "$build/profiles/$name.profraw" -o "$build/profiles/$name.profdata"
  llvm-cov export -format=text -instr-profile "$build/profiles/$name.profdata" "$program" "$root/controller" "$root/hal" \
    >"$build/profiles/$name.json" 2>/dev/null
done
python3 -B toolchain/coverage.py "$root" "$build"/profiles/*.json "${options[@]}" >"$page"
