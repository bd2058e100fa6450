"""Checks sensorfarm_client.py against tests/netio/vectors: decoding gives their text, encoding their bytes.

Usage: vectors.py FOLDER_OF_THE_CLIENT FILE...
"""

import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[1])
import sensorfarm_client as client


def vectors(path):
    """Yields (lines of text, bytes) for each packet in a file."""
    for block in pathlib.Path(path).read_text().strip().split("\n\n"):
        lines = [line for line in block.splitlines() if not line.startswith("#")]
        if "hex =" in lines:
            at = lines.index("hex =")
            yield lines[:at], bytes.fromhex("".join(lines[at + 1:]))
        else:
            yield lines[:1], edited(path, lines[1:])


def edited(path, lines):
    """The bytes of a packet of statuses.txt (tests/netio/vectors.h)."""
    for line in lines:
        key, value = line.split(" = ")
        if key == "like":
            name, row = value.split()
            data = bytearray(list(vectors(pathlib.Path(path).with_name(name + ".txt")))[int(row)][1])
        elif key == "size":
            data = (data + bytes(int(value)))[:int(value)]
        else:
            piece, _, times = value.partition(" x ")
            piece = bytes.fromhex(piece) * int(times or 1)
            at = int(key.split()[1])
            data[at:at + len(piece)] = piece
    return bytes(data)


def decoded(data):
    try:
        return client.decode(data), "accepted"
    except client.Malformed as reason:
        return None, str(reason)


def encoded(packet):
    """Encodes a packet to the farm again."""
    header = {key: packet.pop(key) for key in ("robot", "sequence", "time_ns", "session", "token")}
    type = packet.pop("type")
    if type == client.OWN_READINGS:
        return client.encode_own_readings(**packet, **header)
    del packet["sensor"]
    make = {client.V2V: client.encode_v2v, client.TAG: client.encode_tag, client.SUBSCRIBE: client.encode_subscribe,
            client.OBJECT: client.encode_object,
            client.COMMAND: client.encode_command, client.STEP: client.encode_step, client.FETCH: client.encode_fetch}
    return make[type](**packet, **header) if type in make else client.encode(type, **header)


def judge(lines, data):
    packet, status = decoded(data)
    if lines[0].startswith("status = "):
        return lines == ["status = " + status]
    text = ["%s = %s" % pair for pair in client.fields(packet).items()] if packet else [status]
    if text != lines:
        print("\n".join(text))
        return False
    sent = packet["type"] in (client.V2V, client.TAG, client.SUBSCRIBE, client.START, client.LEAVE, client.OBJECT,
                              client.COMMAND, client.STEP, client.FETCH, client.OWN_READINGS)
    return encoded(packet) == data if sent else True


count = 0
for path in sys.argv[2:]:
    for lines, data in vectors(path):
        count += 1
        if not judge(lines, data):
            sys.exit("%s: packet of %s" % (path, lines))
print("%d packets" % count)
