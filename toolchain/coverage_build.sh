#!/usr/bin/env bash
# coverage_build.sh FOLDER TARGET...: builds these tests and fuzzers with clang's branch counters.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

cd -- "$root"
folder=$1 targets=()
for name in "${@:2}"; do targets+=(--target "$name"); done
cmake --preset asan-ubsan -B "$folder" -DCMAKE_CXX_FLAGS='-fprofile-instr-generate -fcoverage-mapping' \
  -DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 --log-level=WARNING >/dev/null
cmake --build "$folder" "${targets[@]}" >"$folder/build.log" 2>&1 || die "cannot build; see $folder/build.log"
