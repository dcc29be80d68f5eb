#!/bin/busybox sh
# The guest's first program: drivers, the host's files under a layer that takes what is written, then the command.
busybox=/bin/busybox
fail() {
  echo "guest: $*" >/dev/ttyS0
  $busybox dmesg | $busybox tail -15 >/dev/ttyS0
  $busybox poweroff -f
}
$busybox mount -t proc proc /proc
$busybox mount -t sysfs sys /sys
$busybox mount -t devtmpfs dev /dev
exec >/dev/ttyS0 2>&1
while read -r module; do $busybox insmod "/modules/$module" || echo "no $module"; done </modules/order

$busybox mount -t 9p -o trans=virtio,version=9p2000.L,msize=512000,cache=loose,ro host /host || fail "no files from the host"
$busybox mount -t tmpfs -o mode=755 writable /writable
$busybox mkdir /writable/upper /writable/work
# What is in memory hides the same file of the host.
below=/host
[ ! -d /memory ] || below=/memory:/host
$busybox mount -t overlay -o lowerdir=$below,upperdir=/writable/upper,workdir=/writable/work,xino=off,index=off,metacopy=off \
  overlay /root || fail "no layer to write to"
for folder in proc sys dev; do $busybox mount --move "/$folder" "/root/$folder"; done
$busybox mkdir -p /root/dev/shm /root/dev/pts /root/run
for folder in dev/shm run; do $busybox mount -t tmpfs -o mode=1777 tmpfs "/root/$folder"; done
$busybox mount -t devpts devpts /root/dev/pts
$busybox cp /run/command /run/settings /root/run/

# The ports' device names depend on the order in which they were found.
for attempt in 1 2 3 4 5 6 7 8 9 10; do
  for port in /root/sys/class/virtio-ports/*; do
    case "$($busybox cat "$port/name" 2>/dev/null)" in
      output) output=/dev/${port##*/} ;;
      code) code=/dev/${port##*/} ;;
    esac
  done
  [ -n "$output" ] && [ -n "$code" ] && break
  $busybox sleep 0.05
done
[ -n "$code" ] || fail "no ports to the host"

write_main() {
  $busybox cat <<'MAIN'
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8
. /run/settings
ip link set lo up
for name in vcan0 vcan1; do ip link add dev $name type vcan && ip link set $name txqueuelen 1000 up; done
if [ -n "$bitrate" ]; then
  for name in can0 can1; do ip link set $name txqueuelen 100 type can bitrate $bitrate restart-ms 100 && ip link set $name up; done
fi
exec 3>"$CODE"
/bin/bash /run/command </dev/null >"$OUTPUT" 2>&1
echo $? >&3
exec 3>&-
sync
echo o >/proc/sysrq-trigger
sleep 10
MAIN
}
write_main >/root/run/main
export OUTPUT="$output" CODE="$code"
exec $busybox chroot /root /bin/bash /run/main
