"""Tests the signatures of the Python client. Usage: signatures.py FOLDER_OF_CLIENTS"""

import sys

sys.path.insert(0, sys.argv[1])
from sensorfarm_client import LEAVE, Malformed, Window, encode, sign

KEY = bytes(range(32))
LEAVE_OF_7 = encode(LEAVE, robot=7, time_ns=26375139328)


def status(window, counter, key=KEY, flipped=None):
    data = bytearray(sign(LEAVE_OF_7, key, counter))
    if flipped is not None:
        data[flipped // 8] ^= 1 << flipped % 8
    try:
        window.check(bytes(data), KEY)
        return "accepted"
    except Malformed as reason:
        return str(reason)


window = Window()
expected = [(0, "accepted"), (0, "replayed"), (100, "accepted"), (37, "accepted"), (36, "replayed"), (37, "replayed"),
            (101, "accepted"), (38, "accepted"), (37, "replayed"), (10000, "accepted"), (9937, "accepted"),
            (9936, "replayed"), (2**64 - 1, "accepted"), (2**64 - 1, "replayed"), (10001, "replayed")]
for counter, wanted in expected:
    assert status(window, counter) == wanted, (counter, wanted)
assert status(Window(), 1, bytes(32)) == "wrong signature"
size = 8 * len(sign(LEAVE_OF_7, KEY, 1))
for bit in range(size):
    assert status(Window(), 1, flipped=bit) in ("wrong signature", "not signed"), bit
print("sound")
