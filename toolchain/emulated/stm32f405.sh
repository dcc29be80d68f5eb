# An STM32F405 (netduinoplus2) whose controller node speaks slcan to the world on this host. emulate.sh sources this.

scenario=can_axis

prove_images() {
  prove 65536 16384 "$images"/*.elf "$tests"/{replay_*,lockstep}.elf
  # Each further axis takes some 5 KiB of code with its constants, and 3 KiB of RAM.
  python3 -B toolchain/check_image.py "$tests/two_axes.elf" --code 73728 --ram 16384
}

# emulate <image> <counting> [QEMU option...]
emulate() {
  exec timeout -k 5 120 qemu-system-arm -M netduinoplus2 -accel tcg -kernel "$1" -nodefaults -display none -monitor none \
    -semihosting-config enable=on,target=native -plugin "$2" "${@:3}" </dev/null
}

run_closed_loop() {
  local log=$work/emulated/lockstep.log
  socket=$(mktemp -d)
  trap 'kill "$machine" 2>/dev/null || true; rm -rf -- "$socket"' EXIT
  (emulate "$tests/bootloader.elf" "$(counting "$tests/lockstep.elf" "$work/emulated/node.counts")" \
    -device "loader,file=$tests/lockstep.bin,addr=0x08010000" -icount shift=3,sleep=off \
    -serial "unix:$socket/slcan,server=on,wait=on") >"$log" 2>&1 &
  machine=$!
  timeout 120 "$host/emulated_axis" "$socket/slcan" || fail "the closed loop; see $log"
  kill "$machine" 2>/dev/null || true
  wait "$machine" || true
}

# emulate_replay <image>
emulate_replay() { (emulate "$1" "$(counting "$1" replay.counts)"); }
