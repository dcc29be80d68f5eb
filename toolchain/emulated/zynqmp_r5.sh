# The RPU of a Zynq UltraScale+ (xlnx-zcu102): the controller on its first core and CAN0, the world on its second core and
# CAN1, one bus between them. emulate.sh sources this.

scenario=two_axes

prove_images() {
  prove 98304 32768 "$images"/*.elf "$tests"/{controller,replay_*}.elf
  (cd -- "$work/emulated" && emulate "$tests/overflow.elf") ||
    fail "the stack outgrew its memory without a fault there ($?)"
  printf 'a stack that outgrows its memory faults\n'
  (cd -- "$work/emulated" && emulate "$tests/protection.elf") ||
    fail "what the memory protection is to refuse was not refused: attempt $? of tests/emulated/zynqmp_r5/protection_image.cpp"
  printf 'code and constants cannot be written, data and constants not executed, and the rest not read\n'
}

# emulate <image> [QEMU option...]: the image at 0 for the first core of the RPU.
emulate() {
  QEMU_AUDIO_DRV=none timeout -k 5 120 qemu-system-aarch64 -M xlnx-zcu102,canbus0=can,canbus1=can -object can-bus,id=can \
    -smp 6 -m 256M -accel tcg,thread=single -nodefaults -display none -monitor none -serial none \
    -semihosting-config enable=on,target=native -device loader,file="$1" \
    -device loader,file="$tests/power_on.elf",cpu-num=0 "${@:2}" </dev/null 2>qemu.log
}

# Only what the controller's core executes, in its TCM, is counted, because the cores take turns.
below=below=0x30000

# emulate_both [QEMU option...]: 2 ns an instruction, so a core at 500 MHz that takes one cycle for each.
emulate_both() {
  local world_entry=0xFFFC0004  # as power_on.S has it
  emulate "$tests/controller.elf" -icount shift=1,sleep=off -device loader,file="$tests/world.elf" \
    -device loader,addr=$world_entry,data=0x200000,data-len=4 "$@"
}

run_closed_loop() {
  local result again=$work/again
  mkdir -p -- "$again"
  (cd -- "$again" && emulate_both) &
  (cd -- "$work/emulated" &&
    emulate_both -plugin "$(counting "$tests/controller.elf" node.counts $below)") ||
    fail "the closed loop ended with $? (1 no bus, 2 the world is too slow, 3 cannot write, 4 lost frames); see $work/emulated/qemu.log"
  wait $! || fail "the second run ended with $?; see $again/qemu.log"
  "$host/compare_world" "$work/emulated" || fail 'the closed loop differs from that on the host'
  for result in world.frames world.positions controller.report; do
    cmp -- "$work/emulated/$result" "$again/$result" || fail 'two runs differ'
  done
  printf 'two runs are equal\n'
}

# emulate_replay <image>
emulate_replay() { emulate "$1" -plugin "$(counting "$1" replay.counts $below)"; }
