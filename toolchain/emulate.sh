#!/usr/bin/env bash
# Builds a target's images and runs them on an emulated machine against the simulated axis.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/emulate.sh stm32f405 [--costs]

Installs what is needed and missing (Debian packages, as root or by sudo), builds the images for the target and runs, on
QEMU and beside it on this host:
  proofs       no heap, no double arithmetic, a bounded stack, at most 64 KiB of flash and 16 KiB of RAM
  replay       5000 recorded steps and 20000 hostile ones: equal to the host's bit for bit, and no step above its bound of
               instructions
  closed loop  the controller node over slcan moves the simulated axis over a tour of targets: every frame and position equal
               to the same node on the host

  --costs      also write firmware/targets/stm32f405/COSTS.md

Images: build/stm32f405/firmware/targets/stm32f405/*.elf, .hex, .bin. Exit codes: 0 passed, 1 failed, 2 the machine or the
command line is at fault.
HELP
}

target='' costs=()
for argument in "$@"; do
  case $argument in
    -h | --help) usage && exit 0 ;;
    --costs) costs=(--costs "$root/firmware/targets/stm32f405/COSTS.md") ;;
    stm32f405) target=$argument ;;
    *) die "unknown argument '$argument'; see --help" ;;
  esac
done
[[ -n $target ]] || die "say which target: stm32f405; see --help"

require_packages run emulate
cd -- "$root"

host=build/release
options=()
[[ -e $host/CMakeCache.txt ]] || options=(-DBREAKAWAY_BUILD_TESTS=OFF)
cmake --preset release "${options[@]}" --log-level=WARNING
cmake --build --preset release --target emulation

# The host's results, and beside them what the target is to read.
work=$root/build/$target/replay
mkdir -p -- "$work/emulated"
"$host/tests/emulated/host/host_replay" "$work"
cp -- "$work"/*.tape "$work/emulated"

cmake --preset "$target" -DBREAKAWAY_AXIS_FOLDER="$root/$host/tests/emulated/host/axis" --log-level=WARNING
cmake --build --preset "$target"
images=$root/build/$target/firmware/targets/$target
tests=$root/build/$target/tests/emulated/$target

printf '\n=== proofs\n'
prove() { python3 -B toolchain/check_image.py "$1" --flash 65536 --ram 16384; }
for image in "$images"/*.elf "$tests"/{replay,lockstep}.elf; do
  prove "$image"
done
# A proof that nothing fails proves nothing.
fail() {
  printf 'FAIL: %s\n' "$1" >&2
  exit 1
}
refusals=$(prove "$tests/spoiled.elf") && fail 'the spoiled image passes the proofs'
for refusal in heap 'double arithmetic' recursion 'has no bound' 'by pointer'; do
  [[ $refusals == *"$refusal"* ]] || fail "the proofs do not find '$refusal' in the spoiled image"
done

# emulate <image> <counts file> [QEMU option...]: counts between the marks of the image.
emulate() {
  local symbol begin end
  symbol() { arm-none-eabi-nm "$1" | sed -n "s/^\([0-9a-f]*\) . $2$/0x\1/p"; }
  begin=$(symbol "$1" count_begin) end=$(symbol "$1" count_end)
  exec timeout -k 5 120 qemu-system-arm -M netduinoplus2 -accel tcg -kernel "$1" -nodefaults -display none -monitor none \
    -semihosting-config enable=on,target=native \
    -plugin "$root/$host/tests/emulated/host/libinstruction_count.so,begin=$begin,end=$end,out=$2" "${@:3}" </dev/null
}

printf '\n=== closed loop\n'
socket=$(mktemp -d)
trap 'kill "$machine" 2>/dev/null || true; rm -rf -- "$socket"' EXIT
(emulate "$tests/lockstep.elf" "$work/emulated/lockstep.counts" -icount shift=3,sleep=off \
  -serial "unix:$socket/slcan,server=on,wait=on") >"$work/emulated/lockstep.log" 2>&1 &
machine=$!
timeout 120 "$host/tests/emulated/host/emulated_axis" "$socket/slcan" || fail "the closed loop; see $work/emulated/lockstep.log"
kill "$machine" 2>/dev/null || true
wait "$machine" || true

printf '\n=== replay\n'
(cd -- "$work/emulated" && emulate "$tests/replay.elf" replay.counts)
python3 -B tests/emulated/report.py "$work" "$host/tests/emulated/host/host_replay" "$images" "${costs[@]}"
printf '\n%s: passed in %d s\n' "$target" "$SECONDS"
