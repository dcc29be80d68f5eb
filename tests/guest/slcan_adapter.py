"""An slcan adapter: what the kernel's slcan driver says on one end of a pty goes to a CAN interface and back.

    slcan_adapter.py INTERFACE BITRATE

Makes the interface slcan0 and prints `ready`. Each line on standard input is told to the driver as it stands: `sb256128`, say,
which means that the adapter's controller went bus-off (s, state, three digits of transmit and of receive errors).
"""
import fcntl
import gc
import os
import pty
import select
import socket
import struct
import subprocess
import sys
import termios
import tty

N_SLCAN = 17
SIOCGIFNAME = 0x8910
FRAME = struct.Struct("=IB3x8s")


def attach():
    """The pty's adapter end; its other end is the driver's, under the name slcan0."""
    adapter, driver = pty.openpty()
    tty.setraw(adapter)
    tty.setraw(driver)
    fcntl.ioctl(driver, termios.TIOCSETD, struct.pack("i", N_SLCAN))
    name = fcntl.ioctl(driver, SIOCGIFNAME, bytes(40)).split(b"\0")[0].decode()
    subprocess.run(["ip", "link", "set", name, "name", "slcan0"], check=True)
    return adapter, driver


def to_can(bus, line):
    """True: it was a frame."""
    if line[:1] != b"t":
        return False
    size = int(line[4:5])
    bus.send(FRAME.pack(int(line[1:4], 16), size, bytes.fromhex(line[5:5 + 2 * size].decode())))
    return True


def to_slcan(frame):
    can_id, size, data = FRAME.unpack(frame)
    return b"t%03X%d%s\r" % (can_id, size, data[:size].hex().upper().encode())


def main():
    bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    bus.bind((sys.argv[1],))
    adapter, driver = attach()
    up = subprocess.Popen(f"ip link set slcan0 txqueuelen 100 type can bitrate {sys.argv[2]} && ip link set slcan0 up"
                          " && echo ready", shell=True)
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(75))
    gc.disable()
    text = b""
    while True:
        ready, _, _ = select.select([adapter, bus, sys.stdin], [], [])
        if adapter in ready:
            text += os.read(adapter, 4096)
            *lines, text = text.split(b"\r")
            for line in lines:
                if not to_can(bus, line):
                    os.write(adapter, b"\r")
        if bus in ready:
            os.write(adapter, to_slcan(bus.recv(FRAME.size)))
        if sys.stdin in ready:
            order = sys.stdin.readline()
            if not order:
                up.wait()
                os.close(driver)
                return
            os.write(adapter, order.strip().encode() + b"\r")


if __name__ == "__main__":
    main()
