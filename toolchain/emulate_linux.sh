#!/usr/bin/env bash
# emulate.sh linux: builds the node for Linux and runs it in a guest with CAN interfaces.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/emulate.sh linux [SCENE...]

Installs what is needed and missing (Debian packages, as root or by sudo), builds breakaway and breakaway-node and runs them in a
guest with a PREEMPT_RT kernel (toolchain/guest.sh), in virtual time: 60 s at 1 kHz on vcan without a missed tick, interface
down and up, bus-off, a killed drive, SIGTERM, bad input, two emulated Kvaser cards, slcan with real error states, and other
people's CANopen software. With SCENE..., named as in tests/guest/linux_node.py, these only.

Exit codes: 0 passed, 1 failed, 2 the machine or the command line is at fault.
HELP
}

for argument in "$@"; do
  case $argument in
    -h | --help) usage && exit 0 ;;
    -*) die "unknown option '$argument'; see --help" ;;
  esac
done

require_packages run guest
cd -- "$root"

host=build/release
options=()
[[ -e $host/CMakeCache.txt ]] || options=(-DBREAKAWAY_BUILD_TESTS=OFF)
cmake --preset release "${options[@]}" --log-level=WARNING
cmake --build --preset release --target breakaway_cli breakaway_node

code=0
toolchain/guest.sh --bitrate 1000000 --timeout 600 python3 -B tests/guest/linux_node.py "$host" "$@" || code=$?
if ((code != 0)); then
  printf 'linux: FAILED (exit code %d)\n' "$code" >&2
  exit 1
fi
printf 'linux: passed in %d s\n' "$SECONDS"
