#!/usr/bin/env bash
# Searches for longer than the tests do, and writes the table of all that was searched.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/../../toolchain/setup.sh"

usage() {
  cat <<'HELP'
Usage: tests/fuzz/long_run.sh FOLDER [--seconds N] [FUZZER...]
       tests/fuzz/long_run.sh FOLDER --table

Runs the fuzzers (all of them without FUZZER...) one after another for N seconds each (default 600), from seeds that it
counts up, on what earlier runs found in FOLDER and on the corpus of the tests. Every run adds a line to
FOLDER/runs.txt, so that it may be ended and begun again, and several may share a folder that take fuzzers of their own. An
input that is a finding is kept in FOLDER/findings.

  --table   builds the fuzzers with branch counters, runs them once over what was found, and writes tests/fuzz/RESULTS.md;
            also keeps, of what was found, a few inputs (12 KiB a fuzzer) in tests/fuzz/corpus

Example: nice -n 19 tests/fuzz/long_run.sh /tmp/fuzz --seconds 3600 && tests/fuzz/long_run.sh /tmp/fuzz --table
Exit codes: 0 done, 1 a finding, 2 the machine or the command line is at fault.
HELP
}

seconds=600 table=false folder='' wanted=()
while (($# > 0)); do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --table) table=true ;;
    --seconds) [[ ${2-} =~ ^[0-9]+$ ]] || die "--seconds needs a number; see --help"; seconds=$2 && shift ;;
    -*) die "unknown option '$1'; see --help" ;;
    *) if [[ -z $folder ]]; then folder=$1; else wanted+=("$1"); fi ;;
  esac
  shift
done
[[ -n $folder ]] || die "give a folder; see --help"
mkdir -p -- "$folder/findings"
folder=$(cd -- "$folder" && pwd)
require_packages run build test
cd -- "$root"
all=$(sed -n 's/^ *breakaway_fuzzer(\([a-z0-9_]*\) .*/\1/p' tests/fuzz/CMakeLists.txt)
((${#wanted[@]} > 0)) || mapfile -t wanted <<<"$all"

# The fuzzers under the sanitizers, and nothing else.
build() {
  local targets=() name
  cmake --preset asan-ubsan --log-level=WARNING >/dev/null
  for name in $all; do targets+=(--target "fuzz_$name"); done
  cmake --build --preset asan-ubsan "${targets[@]}" >/dev/null ||
    die "the fuzzers do not build; see cmake --build --preset asan-ubsan"
}

# The folders and options that the test of a fuzzer has, without the number of runs.
arguments_of() {
  sed -n "s|^add_test(\[=\[fuzz.$1\]=\] \"[^\"]*\" \(.*\))\$|\1|p" "$root/build/asan-ubsan/tests/fuzz/CTestTestfile.cmake" |
    tr ' ' '\n' | tr -d '"' | grep -v -e '^-runs=' -e '^-seed=' -e "_found$"
}

search() {
  local name=$1 log seed started code=0
  mkdir -p -- "$folder/found/$name"
  seed=$(($(grep -c "^$name " "$folder/runs.txt" 2>/dev/null || true) + 1000))
  log=$folder/$name.log
  started=$SECONDS
  # shellcheck disable=SC2046
  build/asan-ubsan/tests/fuzz/fuzz_"$name" "$folder/found/$name" $(arguments_of "$name") -seed="$seed" -max_total_time="$seconds" \
    -print_final_stats=1 -artifact_prefix="$folder/findings/$name-" >"$log" 2>&1 || code=$?
  printf '%s %s %s %s %s\n' "$name" "$seed" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" \
    "$((SECONDS - started))" "$code" >>"$folder/runs.txt"
  ((code == 0)) || printf 'long_run.sh: %s found something, see %s\n' "$name" "$log" >&2
  return "$code"
}

if ! $table; then
  build
  failed=0
  for name in "${wanted[@]}"; do search "$name" || failed=1; done
  exit "$failed"
fi

# What is kept of an input is what the coverage build sees of it: the sanitizers' build says which inputs are needed.
merge() {
  local name=$1 merged=$folder/merged/$1 kept=$root/tests/fuzz/corpus/$1
  rm -rf -- "$merged"
  mkdir -p -- "$merged"
  # shellcheck disable=SC2046
  build/asan-ubsan/tests/fuzz/fuzz_"$name" -merge=1 "$merged" "$folder/found/$name" \
    $(arguments_of "$name") >"$folder/$name.merge.log" 2>&1 || die "cannot merge $name; see $folder/$name.merge.log"
  python3 -B tests/fuzz/keep_small.py "$merged" "$kept"
}
counted=$root/build/coverage
build
mapfile -t names <<<"$all"
"$toolchain/coverage_build.sh" "$counted" "${names[@]/#/fuzz_}"
rm -rf -- "$folder/coverage"
mkdir -p -- "$folder/coverage"
for name in $all; do
  merge "$name"
  LLVM_PROFILE_FILE=$folder/coverage/$name.profraw "$counted/tests/fuzz/fuzz_$name" -runs=0 "$folder/merged/$name" \
    tests/fuzz/corpus/"$name" >/dev/null 2>&1 || die "the coverage build of $name fails"
  llvm-profdata merge -sparse "$folder/coverage/$name.profraw" -o "$folder/coverage/$name.profdata"
  llvm-cov export -format=text -instr-profile "$folder/coverage/$name.profdata" "$counted/tests/fuzz/fuzz_$name" \
    "$root/controller" "$root/hal" "$root/firmware" "$root/sim" >"$folder/coverage/$name.json" 2>/dev/null
done
python3 -B tests/fuzz/results.py "$root" "$folder" >tests/fuzz/RESULTS.md
printf 'tests/fuzz/RESULTS.md written\n'
