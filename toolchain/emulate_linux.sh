#!/usr/bin/env bash
# emulate.sh linux: builds the node for Linux and runs it in a guest with CAN interfaces.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/emulate.sh linux [--quick | CASE...]

Installs what is needed and missing (Debian packages, as root or by sudo), builds breakaway and breakaway-node and runs them in a
guest with a PREEMPT_RT kernel (toolchain/guest.sh), in virtual time: 60 s of three axes at 1 kHz on vcan without a missed tick,
interface down and up, bus-off, a killed drive, SIGTERM, bad input, two nodes on one bus, two emulated Kvaser cards,
slcan with real error states, and other people's CANopen software. With CASE..., named as in tests/guest, these only; with
--quick all but the longest: 10 s of the three axes, no experiment that finds mass and friction, and none of what the tests of
the host run on a simulated bus and that asks for nothing of a kernel.

Exit codes: 0 passed, 1 failed, 2 the machine or the command line is at fault.
HELP
}

for argument in "$@"; do
  case $argument in
    -h | --help) usage && exit 0 ;;
    --quick) (($# == 1)) || die "--quick and cases exclude each other; see --help" ;;
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

# Other people's CANopen. Where npm comes from elsewhere than Debian, Debian's would not go with it.
peers=$root/build/guest/peers
install_peers() {
  local modules=(socketcan node-crc) module
  command -v npm >/dev/null || require_packages npm
  rm -rf -- "$peers"
  mkdir -p -- "$peers"
  [[ ! -e /usr/include/node/node.h ]] || export npm_config_nodedir=/usr
  npm install --prefix "$peers" --no-audit --no-fund --loglevel=error --ignore-scripts canopen@6.2.1 socketcan@4.0.7
  npm rebuild --prefix "$peers" --loglevel=error "${modules[@]}" >"$peers/rebuild.log" 2>&1 || true
  for module in "${modules[@]}"; do
    compgen -G "$peers/node_modules/$module/build/Release/*.node" >/dev/null ||
      die "npm could not build $module; see $peers/rebuild.log"
  done
  touch -- "$peers/ready"
}
[[ -e $peers/ready ]] || install_peers

# Found where the guest finds it, not by what comes first for whoever calls this.
guest_path=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
places=$(PATH=$guest_path python3 -B tests/guest/in_memory.py "$host" "$peers/node_modules" tests/guest sim/scenarios)
in_memory=()
while IFS= read -r place; do in_memory+=(--in-memory "$place"); done <<<"$places"

# The limit is for a guest that stands still, and long enough for a machine that has other things to do.
code=0
toolchain/guest.sh --bitrate 1000000 --timeout 7200 "${in_memory[@]}" env NODE_PATH="$peers/node_modules" \
  python3 -B tests/guest/linux_node.py "$host" "$@" || code=$?
if ((code != 0)); then
  printf 'linux: FAILED (exit code %d)\n' "$code" >&2
  exit 1
fi
printf 'linux: passed in %d s\n' "$SECONDS"
