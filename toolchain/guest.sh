#!/usr/bin/env bash
# Runs a command in a Linux guest with a PREEMPT_RT kernel and CAN interfaces.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/guest.sh [option...] [--] COMMAND [argument...]

Boots Debian's PREEMPT_RT kernel on an emulated machine (QEMU, one processor) and runs COMMAND in it, in the current folder,
with this machine's files: they can be read and seemingly written, but what is written vanishes with the guest. vcan0 and vcan1
are up. Output is passed on; the exit code is the command's, 124 when time ran out, 125 when the guest failed.

  --bitrate N   two Kvaser cards besides, can0 and can1, on one bus at N bit/s
  --icount N    virtual time: an instruction takes 2^N ns whatever this machine does, and waiting takes none (default 1);
                `none` for the time of this machine, in which latencies mean nothing
  --memory N    of the guest, in MiB (default 1024)
  --timeout N   seconds, of this machine's time (default 300)
  --in-memory PATH  the guest has this file, program with its libraries, or folder in its memory (may be given several times).
                Every other file it asks this machine for, and while it waits virtual time runs on: by seconds, or by many
                minutes where this machine is busy. What is to keep to a time in the guest starts only what is in memory.
  --prepare     only install what is missing and fetch the kernel

The kernel is downloaded once, extracted to build/guest, not installed.
Example: toolchain/guest.sh ip -br link
HELP
}

bitrate='' icount=1 memory=1024 limit=300 prepare=false in_memory=()
while (($# > 0)); do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --prepare) prepare=true && shift ;;
    --bitrate | --icount | --memory | --timeout | --in-memory)
      [[ -n ${2-} ]] || die "$1 needs a value; see --help"
      case $1 in
        --bitrate) bitrate=$2 ;;
        --icount) icount=$2 ;;
        --memory) memory=$2 ;;
        --timeout) limit=$2 ;;
        --in-memory) in_memory+=("$2") ;;
      esac
      shift 2
      ;;
    --) shift && break ;;
    -*) die "unknown option '$1'; see --help" ;;
    *) break ;;
  esac
done
$prepare || (($# > 0)) || die "give a command; see --help"

require_packages guest
cache=$root/build/guest
mkdir -p -- "$cache"

modules=(virtio_pci virtio_console 9pnet_virtio 9p overlay can can_raw vcan can_dev slcan sja1000 kvaser_pci)

# Kernel, its modules in the order of their dependencies, and the guest's first program, as one archive to boot from.
prepare_kernel() (
  cd -- "$cache"
  newest() { apt-cache depends linux-image-rt-amd64 2>/dev/null | sed -n 's/^ *Depends: *\(linux-image-[0-9].*-rt-amd64\)$/\1/p'; }
  [[ -n $(newest) ]] || apt-get -q update >&2 || true # a machine whose lists were cleaned away
  package=$(newest | head -1)
  [[ -n $package ]] || die "the package sources know no linux-image-rt-amd64; run apt-get update as root"
  compgen -G "${package}_*.deb" >/dev/null || apt-get download -q "$package" 2>&1 | grep -v '^W:' >&2
  rm -rf -- kernel first
  dpkg -x "${package}"_*.deb kernel
  version=$(ls kernel/lib/modules)
  depmod -b kernel "$version"
  mkdir -p first/{bin,modules,proc,sys,dev,host,writable,root}
  cp -- /bin/busybox first/bin/
  for module in "${modules[@]}"; do
    modprobe -d kernel -S "$version" --show-depends "$module" | sed -n 's/^insmod \([^ ]*\).*/\1/p'
  done | awk '!seen[$0]++' >order
  while read -r file; do
    cp -- "$file" first/modules/
    basename -- "$file"
  done <order >first/modules/order
  cp -- "$toolchain/guest_init.sh" first/init
  chmod +x first/init
  (cd first && find . | cpio -o -H newc --quiet | gzip -1) >first.cpio.gz
  # Booted unpacked: an emulated processor takes seconds to unpack it.
  local image=(kernel/boot/vmlinuz-*) start
  start=$(LC_ALL=C grep -abo -m1 $'\xfd7zXZ' "${image[0]}" | head -1 | cut -d: -f1)
  # The archive ends before the file does, which xz calls an error.
  tail -c "+$((start + 1))" "${image[0]}" | xz -dc >vmlinux 2>/dev/null || true
  [[ $(head -c 4 vmlinux | tail -c 3) == ELF ]] || cp -- "${image[0]}" vmlinux
  rm -rf -- kernel first order
  printf '%s\n' "$version" >version
)
exec 9>"$cache/lock"
flock 9
[[ -e $cache/version && ! $toolchain/guest_init.sh -nt $cache/version && ! ${BASH_SOURCE[0]} -nt $cache/version ]] ||
  prepare_kernel
flock -u 9
$prepare && exit 0

work=$(mktemp -d)
machine=
trap '[[ -z $machine ]] || kill "$machine" 2>/dev/null || true; rm -rf -- "$work"' EXIT
mkdir -- "$work/run"
{
  printf 'bitrate=%q\n' "$bitrate"
  printf 'cd %q || exit 125\n' "$PWD"
} >"$work/run/settings"
{
  cat "$work/run/settings"
  printf 'exec'
  printf ' %q' "$@"
  printf '\n'
} >"$work/run/command"
(cd "$work" && find run | cpio -o -H newc --quiet | gzip -1) >"$work/run.cpio.gz"
# The kernel takes an archive that is not packed where its place is a multiple of four: the first has one.
: >"$work/initrd"
if ((${#in_memory[@]} > 0)); then
  python3 -B "$toolchain/guest_files.py" "${in_memory[@]}" >"$work/files"
  mkdir -- "$work/memory"
  (cd / && cpio -0 -pdm --quiet "$work/memory") <"$work/files"
  (cd "$work" && find memory | cpio -o -H newc -R 0:0 --quiet) >"$work/initrd"
fi
cat -- "$cache/first.cpio.gz" "$work/run.cpio.gz" >>"$work/initrd"

options=(-accel tcg -cpu max -smp 1 -m "$memory" -M pc -nodefaults -display none -no-reboot -no-user-config
  -kernel "$cache/vmlinux" -initrd "$work/initrd"
  -append 'console=ttyS0 quiet loglevel=4 panic=-1 mitigations=off tsc=reliable nokaslr random.trust_cpu=on audit=0'
  -serial "file:$work/console"
  -fsdev local,id=host,path=/,security_model=none,readonly=on,multidevs=remap
  -device virtio-9p-pci,fsdev=host,mount_tag=host
  -device virtio-serial-pci,max_ports=4
  -chardev "file,id=output,path=$work/output" -device virtserialport,chardev=output,name=output,nr=1
  -chardev "file,id=code,path=$work/code" -device virtserialport,chardev=code,name=code,nr=2)
[[ $icount == none ]] || options+=(-icount "shift=$icount,sleep=off")
[[ -z $bitrate ]] || options+=(-object can-bus,id=bus -device kvaser_pci,canbus=bus -device kvaser_pci,canbus=bus)

mkfifo -- "$work/output"
exec 8<>"$work/output" # keeps the pipe open until the guest is gone
cat <"$work/output" 8>&- &
reader=$!
ended=0
timeout -k 5 "$limit" qemu-system-x86_64 "${options[@]}" </dev/null 8>&- &
machine=$!
wait "$machine" || ended=$?
machine=
exec 8>&-
wait "$reader" || true

code=$(cat -- "$work/code" 2>/dev/null || true)
[[ $code =~ ^[0-9]+$ ]] && exit "$code"
if ((ended == 124 || ended == 137)); then
  printf 'guest.sh: the guest did not end within %s s\n' "$limit" >&2
  exit 124
fi
printf 'guest.sh: the guest ended without an exit code; its last words:\n' >&2
tail -20 -- "$work/console" >&2
exit 125
