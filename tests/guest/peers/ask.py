"""python-can asks the second drive (node 2) what it is, while another is being controlled on the same bus.

    ask.py INTERFACE

Prints `ready` and begins when it is told a line.
"""
import sys

import can

DRIVE = 2


def exchange(bus, data):
    bus.send(can.Message(arbitration_id=0x600 + DRIVE, data=data, is_extended_id=False))
    answer = bus.recv(timeout=2)
    # The filter is set once the socket is open: what came before waits in it.
    while answer is not None and answer.arbitration_id != 0x580 + DRIVE:
        answer = bus.recv(timeout=2)
    if answer is None:
        raise SystemExit("no answer")
    return bytes(answer.data)


def main():
    with can.Bus(interface="socketcan", channel=sys.argv[1],
                 can_filters=[{"can_id": 0x580 + DRIVE, "can_mask": 0x7FF, "extended": False}]) as bus:
        print("ready", flush=True)
        sys.stdin.readline()
        for _ in range(200):
            answer = exchange(bus, bytes.fromhex("4000100000000000"))
            if answer != bytes.fromhex("4300100092010200"):
                raise SystemExit(f"device type: {answer.hex()}")
    print("200 answers")


main()
