#!/usr/bin/env bash
# Builds and checks everything; what a change must pass before it is merged.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/test.sh [--quick | --long]

Installs what the checks need and the machine lacks (Debian packages, as root or by sudo), then runs, stopping at the
first that fails: format, release build with warnings as errors, the tests, the images for targets on QEMU, the node in a
guest; with clang under the address and undefined-behaviour sanitizers the tests of what is flashed or reads bytes from
outside, and the fuzzers for a fixed number of inputs; clang-tidy on the same.

  --quick   the release build and its tests only
  --long    also what takes too long for every change: the tests labelled long; a debug build, which joins no sources, so that
            each has what it needs; in the guest the longest cases; all other tests under the sanitizers (but those that
            compute for long or are labelled slow or package); clang-tidy on all of the library and the commands

Example: toolchain/test.sh --quick
HELP
}

quick=false long=false
(($# <= 1)) || die "takes one option at most, got $#; see --help"
case ${1-} in
  -h | --help) usage && exit 0 ;;
  --quick) quick=true ;;
  --long) long=true ;;
  ?*) die "unknown option '$1'; see --help" ;;
esac

step_name=''
declare -A meanwhile_process
report_failure() {
  local code=$? process
  for process in "${meanwhile_process[@]}"; do
    kill -- "-$process" "$process" 2>/dev/null || true
  done
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

# meanwhile <name> <command...>: begins the command, whose output and time are shown when `step <name> wait_for <name>` waits
# for it. It leads a group of its own, which ends with this script. The guest keeps one processor busy, and in virtual time:
# what runs beside it changes nothing of what it does.
meanwhile() {
  setsid "${@:2}" >"build/$1.log" 2>&1 &
  meanwhile_process[$1]=$!
}

wait_for() {
  local code=0
  wait "${meanwhile_process[$1]}" || code=$?
  unset "meanwhile_process[$1]"
  cat -- "build/$1.log"
  return "$code"
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

# What a sanitizer is for, bytes from outside and indices, the short tests reach. These compute for long, which it makes ten
# times longer.
long_computations='^(Accuracy|Conditions|EquilibriumSet|MethodChoice|PdSynthesis|SynthesisUnits)[.]|^Command[.].*(Tradeoff|Accuracy)'
long_computations+='|^Command[.](LeadsFromAnExperiment|TunesAnAxis|ReadsStandardInputWhere|WritesTheSameJsonTwice)'

# What a change is checked with, and what --long adds.
input_only=ON not_run='^long$' untidied='/asan-ubsan/(controller/stability|sim/(motion/hybrid|sil|study|report|watch|cli))/'
guest_cases=(--quick)
if $long; then
  input_only=OFF not_run='^$' untidied='^$' guest_cases=()
fi

# Files of the library and of the commands, joined a leaf at a time as clang built them. Tests would double the time; the
# compilers and the sanitizers read them.
check_tidy() {
  sed -n 's/^ *"file": "\(.*\)",\?$/\1/p' build/asan-ubsan/compile_commands.json | grep -vF /tests/ | grep -vE "$untidied" |
    sort -u | timeout 3600 xargs -d '\n' -n 1 -P "$(nproc)" clang-tidy --quiet -p build/asan-ubsan
}

uses=(test)
$quick || uses+=(emulate guest)
# Where npm comes from elsewhere than Debian, Debian's would not go with it.
command -v npm >/dev/null || uses+=(npm)
require_packages run build
# Who may have to type a password is asked at the start; else the compiler does not wait for what only the checks need.
((EUID == 0)) || require_packages "${uses[@]}"
cd -- "$root"

mkdir -p build
is_formatted=false
if command -v clang-format >/dev/null; then
  step 'format' check_format
  is_formatted=true
fi
meanwhile packages bash -c 'source toolchain/setup.sh; require_packages "$@"' test.sh "${uses[@]}"
step 'release build' build release -DBREAKAWAY_BUILD_TESTS=ON
step 'the other packages' wait_for packages
$is_formatted || step 'format' check_format
step 'release build of what needs them' build release
if ! $quick; then
  meanwhile guest toolchain/emulate.sh linux "${guest_cases[@]}"
  # What follows leaves the guest the processor that it asks for: one that waits for this machine computes what happens
  # in the meantime.
  renice -n 10 $$ >/dev/null
fi
step 'release tests' run_tests release -LE "$not_run"
$long && step 'debug build' build debug -DBREAKAWAY_BUILD_TESTS=ON
if ! $quick; then
  meanwhile boards toolchain/emulate.sh stm32f405 zynqmp_r5
  step 'sanitizer build' build asan-ubsan -DBREAKAWAY_TESTS_OF_INPUT_ONLY="$input_only"
  step 'stm32f405 and zynqmp_r5 on emulated machines' wait_for boards
  step 'sanitizer tests, fuzzers' run_tests asan-ubsan -LE '^(slow|package)$' -E "$long_computations"
  step 'clang-tidy' check_tidy
  step 'linux node in a guest' wait_for guest
fi
printf '\nAll steps passed in %d s.\n' "$SECONDS"
