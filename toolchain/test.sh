#!/usr/bin/env bash
# Builds and checks everything; what a change must pass before it is merged.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/test.sh [--quick]

Installs what the checks need and the machine lacks (Debian packages, as root or by sudo), then runs, stopping at the
first that fails: format, release build with warnings as errors, all tests, the images for targets on QEMU; with clang
under the address and undefined-behaviour sanitizers the tests (without those labelled slow or package), the fuzzers for a
fixed number of inputs and every public header; clang-tidy.

  --quick   the release build and its tests only
HELP
}

quick=false
(($# <= 1)) || die "takes one option at most, got $#; see --help"
case ${1-} in
  -h | --help) usage && exit 0 ;;
  --quick) quick=true ;;
  ?*) die "unknown option '$1'; see --help" ;;
esac

step_name=''
report_failure() {
  local code=$?
  if ((code != 0)) && [[ -n $step_name ]]; then
    printf '\nFAILED in step: %s (exit code %d)\n' "$step_name" "$code" >&2
    exit 1
  fi
}
trap report_failure EXIT

# step <name> <command...>: a heading, the command, its time.
step() {
  step_name=$1
  local start=$SECONDS
  printf '\n=== %s\n' "$step_name"
  "${@:2}"
  printf -- '--- %s: ok, %d s\n' "$step_name" $((SECONDS - start))
}

tracked() {
  # A clone that another user owns (a container's usual case) is safe to list.
  git -c safe.directory="$root" ls-files -z -- "$@"
}

build() {
  cmake --preset "$1" --log-level=WARNING "${@:2}"
  cmake --build --preset "$1"
}

run_tests() {
  ctest --preset "$1" --no-tests=error "${@:2}"
}

check_format() {
  tracked '*.hpp' '*.cpp' | xargs -0 clang-format --dry-run -Werror
}

# The library's and the command's own files, joined a leaf at a time as clang built them. Tests would double the time; the
# compilers and the sanitizers read them.
check_tidy() {
  sed -n 's/^ *"file": "\(.*\)",\?$/\1/p' build/asan-ubsan/compile_commands.json | grep -vF /tests/ | sort -u |
    timeout 1200 xargs -d '\n' -n 1 -P "$(nproc)" clang-tidy --quiet -p build/asan-ubsan
}

require_packages run test
$quick || require_packages emulate
cd -- "$root"

if ! $quick; then
  step 'format' check_format
fi
step 'release build' build release -DBREAKAWAY_BUILD_TESTS=ON
step 'release tests' run_tests release
if ! $quick; then
  step 'stm32f405 on an emulated machine' toolchain/emulate.sh stm32f405
  step 'zynqmp_r5 on an emulated machine' toolchain/emulate.sh zynqmp_r5
  step 'linux node in a guest' toolchain/emulate.sh linux
  step 'sanitizer build' build asan-ubsan
  step 'sanitizer tests, fuzzers' run_tests asan-ubsan -LE '^(slow|package)$'
  step 'headers with clang' run_tests asan-ubsan -R '^header[.]'
  step 'clang-tidy' check_tidy
fi
printf '\nAll steps passed in %d s.\n' "$SECONDS"
