#!/usr/bin/env bash
# Builds the HAL component for LinuxCNC, loads it by halrun against a simulated axis, and tries what can be wrong with it.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/linuxcnc.sh [--minute]

Installs LinuxCNC's headers and halrun where they are missing (some 100 packages), builds breakaway's law and the component in
build/linuxcnc (or in BREAKAWAY_BUILD), installs the component into LinuxCNC's folder of modules, which needs root, and runs it.

  --minute  instead runs the example for 60 s in its thread of 1 kHz, on the real-time kernel of toolchain/guest.sh and in its
            virtual time, and requires that no period is missed
HELP
}

minute=false
for argument in "$@"; do
  case $argument in
    -h | --help) usage && exit 0 ;;
    --minute) minute=true ;;
    *) die "unknown argument '$argument'; see --help" ;;
  esac
done
((EUID == 0)) || die "LinuxCNC loads modules from a folder of root's: run this as root, in a container for example"
require_packages build test linuxcnc

# A build that is there saves time: BREAKAWAY_BUILD=build/release
build=$root/${BREAKAWAY_BUILD:-build/linuxcnc}
mkdir -p "$build"
[[ -f $build/CMakeCache.txt ]] || cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBREAKAWAY_BUILD_TESTS=OFF -DBREAKAWAY_BUILD_NODE=OFF \
  -DCMAKE_UNITY_BUILD=ON >"$build.log"
cmake --build "$build" --target breakaway_law_shared breakaway_cli >>"$build.log" || { tail -n 40 "$build.log" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$root"/firmware/linuxcnc/* "$work"
cd "$work"
export CPATH=$root/firmware/c/include
export LDFLAGS="-L$build/firmware/c -Wl,--no-as-needed -lbreakaway_law -Wl,-rpath,$build/firmware/c"
halcompile --install breakaway.c
LDFLAGS='' halcompile --install sticking_axis.c
"$build/sim/cli/breakaway" design "$root/sim/scenarios/braked_axis.toml" --law-image axis.law >/dev/null
head -c 1000 axis.law >short.law
chmod -R a+rwX "$work"

die_of() {
  printf 'FAILED: %s\n' "$1" >&2
  exit 1
}

# A period is missed where as much time passes between two calls as two periods have. What is seen while the components
# are loaded is forgotten by a reset.
run_minute() {
  local places=() place text longest_ns
  cat example.hal - >minute.hal <<'HAL'
loadrt timedelta
addf timedelta.0 servo-thread
loadusr -w sleep 1
setp timedelta.0.reset 1
loadusr -w sleep 1
setp timedelta.0.reset 0
loadusr -w sleep 20
sets target 0.02
loadusr -w sleep 20
sets target 0.07
loadusr -w sleep 20
show pin
show thread
HAL
  for place in /bin/{bash,sh,sleep} /usr/bin/{env,setpriv,halrun,halcmd,rtapi_app} /usr/lib/linuxcnc/realtime \
    /usr/lib/linuxcnc/modules/{hal_lib,threads,timedelta,breakaway,sticking_axis}.so "$work" \
    "$build/firmware/c/libbreakaway_law.so.1"; do
    places+=(--in-memory "$place")
  done
  text=$("$toolchain/guest.sh" --timeout 7200 "${places[@]}" env RTAPI_FIFO_PATH=/run/fifo HOME=/run \
    setpriv --reuid=65534 --regid=65534 --clear-groups halrun minute.hal 2>&1) || true
  printf '%s\n' "$text" | grep -E 'Note|in-position|true-position|kicks|\.time$|timedelta\.0\.(max|min)$' || true
  longest_ns=$(sed -n 's/.* \([0-9]*\)  timedelta\.0\.max.*/\1/p' <<<"$text")
  [[ $longest_ns =~ ^[0-9]+$ ]] || die "the example did not run: $text"
  ((longest_ns < 2000000)) || die_of "$longest_ns ns between two periods"
  grep -Eq ' 0\.0(69998|69999|7|70000|70001)[0-9]*  sticking-axis.true-position' <<<"$text" ||
    die_of 'the axis is not at its target'
  printf 'ok: 60 s without a missed period, at most %s ns between two\n' "$longest_ns"
}
if $minute; then
  run_minute
  exit
fi

# LinuxCNC's programs refuse to run as root.
hal() { # FILE: what halrun says of it
  RTAPI_FIFO_PATH=$work/fifo HOME=$work timeout 60 setpriv --reuid=65534 --regid=65534 --clear-groups halrun "$1" 2>&1
}
failed=0
expect() { # WHAT TEXT PATTERN...: each pattern must be found
  local what=$1 text=$2 pattern
  shift 2
  for pattern in "$@"; do
    if ! grep -Eq -- "$pattern" <<<"$text"; then
      printf 'FAILED: %s: no "%s" in\n%s\n' "$what" "$pattern" "$text" >&2
      failed=1
      return
    fi
  done
  printf 'ok: %s\n' "$what"
}

{ cat example.hal; printf 'loadusr -w sleep 3\nshow pin\nsets target 0.02\nloadusr -w sleep 3\nshow pin\n'; } >moves.hal
text=$(hal moves.hal)
printf '%s\n' "$text" | grep -E 'in-position|true-position|kicks|force '
expect "an axis that sticks is brought to both its targets" "$text" \
  'TRUE  breakaway.0.in-position' ' 0\.0(49998|49999|5|50000|50001)[0-9]*  sticking-axis.true-position' \
  ' 0\.0(19998|19999|2|20000|20001)[0-9]*  sticking-axis.true-position' 'FALSE  breakaway.0.fault'

# NAME SED TEXT CODE: the example, changed, is stopped with this sentence and code, and its axis has not moved.
refused() {
  sed -E "$2" example.hal >changed.hal
  printf 'loadusr -w sleep 1\nshow pin\n' >>changed.hal
  expect "$1" "$(hal changed.hal)" "$3" " $4  breakaway.0.fault-code" ' 0  breakaway.0.force ' ' 0  sticking-axis.true-position'
}
refused "a position that is connected to nothing" '/^net position/d' 'position is connected to nothing' 101
refused "a command that is connected to nothing" '/^net target|^sets target/d' 'command is connected to nothing' 102
refused "a thread of another period" 's/period1=1000000/period1=2000000/' 'the thread has another period' 103

sed 's/image=axis.law/image=short.law/' example.hal >short.hal
expect "an image that was cut" "$(hal short.hal)" 'axis 0 of short.law: the law image is damaged'
sed 's/image=axis.law/image=none.law/' example.hal >none.hal
expect "an image that is not there" "$(hal none.hal)" 'image=none.law cannot be opened'
sed 's/image=axis.law/count=1/' example.hal >without.hal
expect "no image" "$(hal without.hal)" 'no law image: say image=FILE'
exit $failed
