#!/usr/bin/env bash
# Builds targets' images and runs them on emulated machines against simulated axes.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/emulate.sh TARGET... [--costs]

Installs what is needed and missing (Debian packages, as root or by sudo), builds the images for each target and runs, on
QEMU and beside it on this host:
  proofs       no heap, no double arithmetic, a bounded stack, and a size
  closed loop  the controller node moves the simulated axes over a tour of targets: every frame equal to the same node's on
               the host
  replay       of six axes, under the coasts "pd", "brake" and "work", on moves with limits, with a tolerance below the floor
               and on friction that bends, 5000 recorded steps and 20000 hostile ones: equal to the host's bit for bit, and no
               step above its bound of instructions

  stm32f405    Cortex-M4F over slcan with one axis, the world on this host
  zynqmp_r5    Cortex-R5F on CAN with two axes at 1 kHz for 10 s, the world on the other core of the emulated machine
  linux        breakaway-node in a guest with CAN interfaces; on its own, see toolchain/emulate.sh linux --help
  --costs      also write firmware/targets/COSTS.md, for which both targets must be named

Images: build/TARGET/firmware/targets/TARGET/*.elf. Exit codes: 0 passed, 1 failed, 2 the machine or the command line is at
fault.
HELP
}

[[ ${1-} != linux ]] || exec "$toolchain/emulate_linux.sh" "${@:2}"

known=(stm32f405 zynqmp_r5)
targets=() costs=false
for argument in "$@"; do
  case $argument in
    -h | --help) usage && exit 0 ;;
    --costs) costs=true ;;
    *)
      [[ " ${known[*]} " == *" $argument "* ]] || die "unknown argument '$argument'; see --help"
      targets+=("$argument")
      ;;
  esac
done
((${#targets[@]})) || die "say which target: ${known[*]}; see --help"
$costs && ((${#targets[@]} < ${#known[@]})) && die "--costs needs the results of all targets: ${known[*]}"

fail() {
  printf 'FAIL: %s\n' "$1" >&2
  exit 1
}

# build_target <target>: its images with the node of $scenario, in $images, and those of its tests, in $tests.
build_target() {
  images=$root/build/$1/firmware/targets/$1
  tests=$root/build/$1/tests/emulated/$1
  cmake --preset "$1" -DBREAKAWAY_NODE_FOLDER="$host/node/$scenario" --log-level=WARNING
  cmake --build --preset "$1" --target images test_images
}

# prove <most bytes of code> <of RAM> <image>...; and that a spoiled image is refused: a proof that nothing fails proves
# nothing.
prove() {
  local image refusal refusals
  check() { python3 -B toolchain/check_image.py "$@"; }
  for image in "${@:3}"; do
    check "$image" --code "$1" --ram "$2"
  done
  refusals=$(check "$tests/spoiled.elf" --code "$1" --ram "$2") && fail 'the spoiled image passes the proofs'
  for refusal in heap 'double arithmetic' recursion 'has no bound' 'by pointer'; do
    [[ $refusals == *"$refusal"* ]] || fail "the proofs do not find '$refusal' in the spoiled image"
  done
}

# counting <image> <counts file> [option...]: QEMU's plugin option that counts instructions between the marks of the image.
counting() {
  local symbol
  symbol() { arm-none-eabi-nm "$1" | sed -n "s/^\([0-9a-f]*\) . $2$/0x\1/p"; }
  printf '%s,begin=%s,end=%s,out=%s' "$host/libinstruction_count.so" "$(symbol "$1" count_begin)" \
    "$(symbol "$1" count_end)" "$2"
  printf ',%s' "${@:3}"
}

# run_target <target>: in a shell of its own, so that what it leaves running ends with it.
run_target() (
  printf '\n=== %s: images\n' "$1"
  work=$root/build/$1/run
  rm -rf -- "$work"
  mkdir -p -- "$work/emulated"
  for axis in "${replayed[@]}"; do
    mkdir -- "$work/$axis" "$work/emulated/$axis"
    cp -- "$tapes/$axis"/*.tape "$work/emulated/$axis"
    cp -- "$tapes/$axis"/*.results "$work/$axis"
  done
  source "$toolchain/emulated/$1.sh"
  build_target "$1"
  printf '\n=== %s: proofs\n' "$1"
  prove_images
  printf '\n=== %s: closed loop\n' "$1"
  run_closed_loop
  printf '\n=== %s: replay\n' "$1"
  for axis in "${replayed[@]}"; do
    (cd -- "$work/emulated/$axis" && emulate_replay "$tests/replay_$axis.elf")
  done
  python3 -B tests/emulated/report.py "$1" "$work" "$images"
)

require_packages run emulate
cd -- "$root"

release=$root/build/release
options=()
[[ -e $release/CMakeCache.txt ]] || options=(-DBREAKAWAY_BUILD_TESTS=OFF)
cmake --preset release "${options[@]}" --log-level=WARNING
cmake --build --preset release --target emulation

# The host's results, and what the targets are to read.
host=$release/tests/emulated/host
tapes=$release/tests/emulated/tapes
rm -rf -- "$tapes"
"$host/host_replay" "$tapes"
mapfile -t replayed < <(ls -- "$tapes")

for target in "${targets[@]}"; do
  run_target "$target"
done
if $costs; then
  python3 -B tests/emulated/costs.py "$host/host_replay" "$tapes" firmware/targets/COSTS.md "$root/build"
fi
printf '\n%s: passed in %d s\n' "${targets[*]}" "$SECONDS"
