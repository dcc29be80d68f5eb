#!/usr/bin/env bash
# Counts and times the control step and what stands around it, and writes tests/bench/RESULTS.md.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/bench.sh [RESULTS.md]

Installs what the benchmarks need and the machine lacks (Debian packages, as root or by sudo), builds them, counts
instructions with callgrind, takes ratios of times with Google Benchmark, and writes tests/bench/RESULTS.md, or the file
given. The counts do not depend on how busy the machine is; for the ratios, let nothing else run.

Example: toolchain/bench.sh out/bench.md
HELP
}

results=$root/tests/bench/RESULTS.md
(($# <= 1)) || die "takes one file at most, got $#; see --help"
case ${1-} in
  -h | --help) usage && exit 0 ;;
  -*) die "unknown option '$1'; see --help" ;;
  ?*) results=$(realpath -m -- "$1") ;;
esac
mkdir -p -- "$(dirname -- "$results")" && [[ -w $(dirname -- "$results") ]] || die "cannot write to '$results'"

require_packages run bench
cd -- "$root"

# A tree of its own, so that the flags are these whatever the other trees were configured with.
build=build/benchmarks
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBREAKAWAY_BUILD_TESTS=OFF -DBREAKAWAY_BUILD_BENCHMARKS=ON \
  --log-level=WARNING
cmake --build "$build" --target step_count breakaway_bench

printf 'Timing ...\n'
"$build/tests/bench/breakaway_bench" --benchmark_min_time=0.02 --benchmark_repetitions=9 \
  --benchmark_enable_random_interleaving=true --benchmark_report_aggregates_only=true \
  --benchmark_out="$build/times.json" --benchmark_out_format=json >/dev/null

printf 'Counting ...\n'
compiler=$(sed -n 's/^CMAKE_CXX_COMPILER:[^=]*=//p' "$build/CMakeCache.txt")
python3 -B tests/bench/write_results.py "$build/tests/bench/step_count" "$build/times.json" \
  "$("$compiler" --version | head -n 1)" "$results"
printf 'Wrote %s\n' "$results"
