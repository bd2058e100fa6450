#!/usr/bin/env python3
"""A robot's side of the sensor farm, using only Python's standard library. docs/packets.md specifies every byte.

As a program: robot 7 reports its pose (x, y [m], yaw [degrees]; or x, y, z, roll, pitch, yaw) ten times a second and
prints its readings.

    python3 sensorfarm_client.py --robot 7 --farm 127.0.0.1:9000 --pose 1.5,-2.25,30 --sensor laser --sensor gps.0

As a module:

    client = Client(7, ("127.0.0.1", 9000), [("laser", 0)])
    client.send_state((1.5, -2.25, 0.0, 0.5))   # at least once a second
    for packet in client.receive(0.1): ...      # dictionaries of `decode`
    client.leave()

Parts of large scans and maps are delivered one by one, each with its place in the whole.
"""

import argparse
import collections
import hmac
import math
import re
import os
import select
import signal
import socket
import struct
import sys
import time

LASER, LANE_EDGE, MAGNETOMETER, SONAR, INFRARED, BUMPER, GPS, OCCUPANCY, IMU, LASER_EXTENDED = 1, 2, 3, 4, 5, 6, 10, 12, 46, 65
LIDAR, LIDAR_EXTENDED = 44, 108
CAMERA, CAMERA_EXTENDED = 45, 109
# The reason why the farm drops packets of this client. Anyone may have sent it, so it is only counted.
REFUSALS = {1: "refused: not signed", 2: "refused: wrong signature", 3: "refused: clock behind",
            4: "refused: wrong address"}
(V2V, TAG, SUBSCRIBE, START, LEAVE, CHALLENGE, V2I, OBJECT, REFUSAL, NEIGHBOURS, DRIVE, LANE, TEAM_MAP, OWN_READINGS,
 DROPPED) = (128, 129, 130, 131, 132, 133, 137, 138, 139, 140, 143, 144, 145, 146, 147)
COMMAND, STEP, FETCH, STATE, VALUES = 134, 135, 136, 141, 142  # lockstep
NONE = 2**32 - 1  # V2V: no leader, no checkpoint
EVERY_ROBOT = 65535  # START: recipient
HEADER_BYTES, V2V_BYTES, TILT_BYTES, MAX_PAYLOAD, SIGNATURE_BYTES = 64, 132, 16, 1256, 24
HEADER = struct.Struct("<4sBBHHHIqIII6fHH")
STATES = {V2V: "<7d3I", TAG: "<13d", SUBSCRIBE: "<I", START: "<", LEAVE: "<", CHALLENGE: "<I",
          OBJECT: "<I", REFUSAL: "<I", DRIVE: "<3d", LANE: "<3I", DROPPED: "<3I"}  # payloads

# Sensor types: name, base of the ports, columns of a row with the unit of each number on the wire.
SENSORS = {
    1: ("laser", 10000, [("range_m", 1e-3)]),
    2: ("laneedge", 20000, []),
    3: ("magnetometer", 30000, [("field_T", 1e-8), ("vector_T", 1e-8), ("vector_T", 1e-8), ("vector_T", 1e-8)]),
    4: ("sonar", 36000, [("range_m", 1e-3)]),
    5: ("infrared", 38000, [("range_m", 1e-6), ("value", 1)]),
    6: ("bumper", 40000, [("pressed", 1)]),
    7: ("cliff", 42000, [("cliff", 1)]),
    8: ("encoder", 44000, [("left_m", 1e-5), ("right_m", 1e-5), ("left_counts", 1), ("right_counts", 1)]),
    9: ("gyro", 46000, [("rate_rad_s", 1e-6)]),
    10: ("gps", 48000, [("x_m", 5e-3), ("y_m", 5e-3), ("hdop", 1e-3), ("satellites", 1), ("altitude_m", 5e-3),
                        ("vdop", 1e-3)]),
    11: ("irreceiver", 50000, [("virtual_wall", 1), ("ir_byte", 1)]),
    12: ("occupancy", 52000, []),
    27: ("fiducial", 62000, [("id", 1), ("fiducial_type", 1), ("range_m", 1e-3), ("bearing_rad", 1e-6),
                             ("orientation_rad", 1e-6)]),
    28: ("lightsensor", 54000, [("illuminance_lx", 1e-3), ("value", 1)]),
    29: ("battery", 56000, [("voltage_V", 1e-3), ("current_A", 1e-3), ("charge_Ah", 1e-6), ("docked", 1)]),
    30: ("analog", 58000, [("voltage_V", 1e-4), ("value", 1)]),
    31: ("ptz", 60000, [("pan_rad", 1e-6), ("tilt_rad", 1e-6), ("fov_rad", 1e-6)]),
    32: ("localization", 64000, [("x_m", 5e-3), ("y_m", 5e-3), ("yaw_rad", 1e-6), ("valid", 1), ("xx_m2", None),
                                 ("xy_m2", None), ("x_yaw_m_rad", None), ("yy_m2", None), ("y_yaw_m_rad", None),
                                 ("yaw_yaw_rad2", None)]),  # None: f32
    33: ("sideslip", 34000, [("sideslip_rad", 1e-6), ("front_force_n", 1e-2), ("rear_force_n", 1e-2), ("valid", 1),
                             ("sideslip_sideslip_rad2", None), ("sideslip_front_rad_n", None),
                             ("sideslip_rear_rad_n", None), ("front_front_n2", None), ("front_rear_n2", None),
                             ("rear_rear_n2", None)]),
    34: ("model", 6000, [("value", None), ("valid", 1), ("variance", None)]),
    35: ("monitor", 4000, [("x_m", 5e-3), ("y_m", 5e-3), ("yaw_rad", 1e-6), ("valid", 1), ("xx_m2", None),
                           ("xy_m2", None), ("x_yaw_m_rad", None), ("yy_m2", None), ("y_yaw_m_rad", None),
                           ("yaw_yaw_rad2", None), ("forward_m_s", None), ("turn_rad_s", None), ("encoder_state", 1),
                           ("gyro_state", 1), ("gps_state", 1), ("encoder_residual", None), ("gyro_residual", None),
                           ("gps_residual", None)]),
    41: ("location", 24000, [("x_m", 5e-3), ("y_m", 5e-3), ("valid", 1), ("xx_m2", None), ("xy_m2", None),
                            ("yy_m2", None), ("source", 1), ("age_s", None)]),
    42: ("thermometer", 22000, [("temperature_C", 1e-3)]),
    47: ("compass", 16000, [("field_T", None), ("field_x_T", None), ("field_y_T", None), ("field_z_T", None),
                            ("heading_rad", 1e-6)]),
    48: ("altimeter", 32000, [("height_m", 1e-3)]),
    49: ("inclinometer", 13000, [("roll_rad", 1e-6), ("pitch_rad", 1e-6), ("saturated", 1)]),
    50: ("radar", 17000, [("range_m", 1e-3), ("bearing_rad", 1e-6), ("closing_m_s", 1e-4), ("elevation_rad", 1e-6)]),
    46: ("imu", 12000, [("rate_x_rad_s", None), ("rate_y_rad_s", None), ("rate_z_rad_s", None), ("force_x_m_s2", None),
                        ("force_y_m_s2", None), ("force_z_m_s2", None), ("saturated", 1), ("orientation_w", None),
                        ("orientation_x", None), ("orientation_y", None), ("orientation_z", None)]),
    44: ("lidar", 14000, [("range_m", 1e-3)]),
    45: ("camera", 15000, [("depth_m", 1e-3)]),
    43: ("aggregate", 18000, [("value", None), ("valid", 1), ("variance", None), ("source", 1), ("age_s", None)]),
    36: ("loop", 8000, [("count", 1), ("occupancy", 1e-6), ("speed_m_s", 1e-4), ("vehicles", 1)]),
    37: ("link-speed", 2000, [("speed_m_s", None), ("travel_time_s", None), ("valid", 1), ("speed_speed_m2_s2", None),
                              ("speed_time_m", None), ("time_time_s2", None), ("age_s", None)]),
    38: ("features", 26000, [("x_m", 0.001), ("y_m", 0.001), ("direction_rad", 1e-6), ("valid", 1), ("xx_m2", None),
                             ("xy_m2", None), ("x_direction_m_rad", None), ("yy_m2", None),
                             ("y_direction_m_rad", None), ("direction_direction_rad2", None), ("kind", 1),
                             ("half_length_m", 0.001), ("id", 1), ("age_s", 1e-6)]),
    39: ("tracks", 28000, [("x_m", 0.005), ("y_m", 0.005), ("vx_m_s", None), ("vy_m_s", None), ("valid", 1),
                           ("xx_m2", None), ("xy_m2", None), ("x_vx_m2_s", None), ("x_vy_m2_s", None),
                           ("yy_m2", None), ("y_vx_m2_s", None), ("y_vy_m2_s", None), ("vx_vx_m2_s2", None),
                           ("vx_vy_m2_s2", None), ("vy_vy_m2_s2", None), ("identity", 1), ("kind", 1), ("tag", 1),
                           ("ahead_m", None), ("contact_s", None)]),
}
TYPE_NAMES = {**{k: s[0] for k, s in SENSORS.items()}, 65: "laser", 108: "lidar", 109: "camera", 128: "V2V", 129: "TAG", 130: "SUBSCRIBE",
              131: "START", 132: "LEAVE", 133: "CHALLENGE", 134: "COMMAND", 135: "STEP", 136: "FETCH",
              137: "V2I", 138: "OBJECT", 139: "REFUSAL", 140: "NEIGHBOURS", 141: "STATE", 142: "VALUES", 143: "DRIVE",
              144: "LANE", 145: "TEAM_MAP", 146: "OWN_READINGS", 147: "DROPPED"}
SHAPED_OBJECT = "<2I3d64s"  # payload of an OBJECT that changes a shape
SHAPE_NAME = re.compile(rb"[A-Za-z0-9_.-]{1,64}")
LIGHT_STATES = ("dark", "red", "yellow", "green", "flashing red", "flashing yellow")


class Malformed(ValueError):
    """A datagram that is dropped; its text is the reason in the words of docs/packets.md."""


def require(fine, reason="out of range"):
    if not fine:
        raise Malformed(reason)


def unpack(form, payload):
    """Unpacks the numbers of a payload of exactly this form."""
    size = struct.calcsize(form)
    require(len(payload) >= size, "too short")
    require(len(payload) <= size, "too long")
    return struct.unpack(form, payload)


def unpack_rows(form, word, payload):
    """Unpacks the numbers of a payload's head, whose last number is the count of the words after it, and these
    words."""
    size = struct.calcsize(form)
    require(len(payload) >= size, "too short")
    head = struct.unpack_from(form, payload)
    return head, unpack("<" + head[-1] * word, payload[size:])


def require_numbers(numbers, limit):
    require(all(math.isfinite(number) for number in numbers), "not finite")
    require(all(abs(number) <= limit for number in numbers))


def split_tilt(size, payload):
    """Returns the first `size` bytes, and the `tilt` after them: roll, pitch [rad], which a level robot does not send."""
    if len(payload) != size + TILT_BYTES:
        return payload, {}
    tilt = list(struct.unpack("<2d", payload[size:]))
    return payload[:size], {"tilt": tilt} if any(tilt) else {}


def decode_laser(extended, payload):
    if not extended:
        (count,), words = unpack_rows("<H", "H", payload)
        require(1 <= count <= 361)
        return {"range_m": [word / 1e3 for word in words]}
    require(len(payload) >= 16, "too short")
    (total, first, part, parts, count), words = unpack_rows("<IIHHH", "I", payload[:14] + payload[16:])
    require(1 <= total <= 1000000 and parts == -(-total // 310) and part < parts)
    require(first == 310 * part and count == min(310, total - first))
    ranges = [math.inf if word == 2**32 - 1 else word / 1e4 for word in words]
    return {"total": total, "first": first, "part": part, "parts": parts, "range_m": ranges}


def decode_image(payload):
    """A part of the file with a camera's colours: PNG (form 1) or JPEG (form 2)."""
    total, first, part, parts, count, form = struct.unpack_from("<IIHHHH", payload)
    require(len(payload) >= 16 + count, "too short")
    require(len(payload) <= 16 + count, "too long")
    require(form <= 2 and 1 <= total <= 4000000 and parts == -(-total // 1240) and part < parts)
    require(first == 1240 * part and count == min(1240, total - first))
    return {"total": total, "first": first, "part": part, "parts": parts, "form": form, "image": list(payload[16:])}


class Images:
    """Assembles the newest image of each camera. Images of which a part was lost are dropped."""

    def __init__(self):
        self.parts = {}  # by camera: sequence, and bytes by part

    def add(self, packet):
        """Returns the bytes of a PNG or JPEG file whose last missing part is in the packet, else None."""
        if "image" not in packet:
            return None
        camera = packet["robot"], packet["sensor"]
        if self.parts.get(camera, (None,))[0] != packet["sequence"]:
            self.parts[camera] = packet["sequence"], {}
        parts = self.parts[camera][1]
        parts[packet["part"]] = bytes(packet["image"])
        if len(parts) < packet["parts"]:
            return None
        del self.parts[camera]
        return b"".join(parts[i] for i in range(packet["parts"]))


LIDAR_COLUMNS = [("range_m", "I", 1e4), ("intensity", "H", 1e3), ("incidence_rad", "H", 1e4), ("second_range_m", "I", 1e4),
                 ("second_intensity", "H", 1e3)]


def decode_lidar(extended, payload):
    """Ranges as of lasers, or with more numbers per beam."""
    more = struct.unpack_from("<H", payload, 14)[0] if extended and len(payload) >= 16 else 0
    if more == 0:
        return decode_laser(extended, payload)
    require(more in (1, 2, 4))
    columns = LIDAR_COLUMNS[:more + 1]
    row = "".join(word for _, word, _ in columns)
    most = 1240 // struct.calcsize("<" + row)
    (total, first, part, parts, count), words = unpack_rows("<IIHHH", row, payload[:14] + payload[16:])
    require(1 <= total <= 1000000 and parts == -(-total // most) and part < parts)
    require(first == most * part and count == min(most, total - first))
    body = {"total": total, "first": first, "part": part, "parts": parts}
    for i, (name, _, per_unit) in enumerate(columns):
        body[name] = [math.inf if word == 2**32 - 1 else word / per_unit for word in words[i::len(columns)]]
    return body


def decode_lane_edge(payload):
    distance, points, residual, sigma = unpack("<HHII", payload)
    metres = lambda word: None if word == 2**32 - 1 else word / 1e6
    return {"distance_m": None if distance == 65535 else distance / 1e3, "points": points,
            "residual_m": metres(residual), "sigma_m": metres(sigma)}


def decode_rows(type, payload):
    columns = SENSORS[type][2]
    require(len(payload) >= 4, "too short")
    count = struct.unpack_from("<H", payload)[0]
    for short, numbers in (GPS, 4), (IMU, 7):  # without an altitude, without an orientation
        if type == short and len(payload) == 4 + 4 * numbers * count:
            columns = columns[:numbers]
    words = unpack("<%di" % (count * len(columns)), payload[4:])
    require(1 <= count and len(words) <= 313 and (type != MAGNETOMETER or count <= 16))
    body = {}
    for word, (name, unit) in zip(words, columns * count):
        real = struct.unpack("<f", struct.pack("<i", word))[0]
        missing = math.isnan(real) if unit is None else word == -2**31 and type != MAGNETOMETER
        body.setdefault(name, []).append(None if missing else real if unit is None else word * unit)
    return body


def decode_occupancy(payload):
    names = ("left_m", "top_m", "cell_m", "part", "parts", "word_columns", "word_rows", "flags")
    head, words = unpack_rows("<3d6H", "I", payload)
    left, top, cell, part, parts, columns, rows, flags, count = head
    all_words = columns * rows
    require(abs(left) <= 1e7 and abs(top) <= 1e7 and 1e-4 <= cell <= 1e3 and flags <= 1)
    require(1 <= columns <= 4096 and 1 <= rows <= 4096 and all_words <= 2**20)
    require(parts == -(-all_words // 305) and part < parts and count == min(305, all_words - 305 * part))
    require(all(word & word >> 1 & 0x55555555 == 0 for word in words))
    return {**dict(zip(names, head)), "word": list(words)}


def decode_v2i(payload):
    """States of an intersection's lights: per approach its group, its state and the next one (rows of LIGHT_STATES),
    the seconds until the change, and the light's x, y, z [m], yaw [rad]; per stop line the group of its approach, its
    way-point and its middle's x, y [m], heading [rad], width of the lane [m]."""
    require(len(payload) >= 8, "too short")
    approaches, stops = struct.unpack_from("<HH", payload)
    size = 8 + 32 * (approaches + stops)
    require(len(payload) >= size, "too short")
    require(len(payload) <= size, "too long")
    rows = list(struct.iter_unpack("<BBBxI2d2f", payload[8:8 + 32 * approaches]))
    lines = list(struct.iter_unpack("<Bx3H2d2f", payload[8 + 32 * approaches:]))
    require(all(map(math.isfinite, (n for row in rows + lines for n in row[4:]))), "not finite")
    require(rows and all(1 <= row[0] <= 254 for row in rows + lines))
    require(all(row[1] < 6 and (row[2] < 6 or row[2] == 255) for row in rows))
    for row in rows + lines:
        require_numbers(row[4:6], 1e7)
    require(all(abs(row[6]) <= 1e7 and abs(row[7]) <= 1e6 for row in rows))
    require(all(abs(row[6]) <= 1e6 and 0 <= row[7] <= 1e7 for row in lines))
    flat = lambda parts: [number for part in parts for number in part]
    return {"group": [row[0] for row in rows], "state": [row[1] for row in rows],
            "next": [None if row[2] == 255 else row[2] for row in rows],
            "left_s": [None if row[3] == NONE else row[3] / 1e3 for row in rows], "light": flat(row[4:] for row in rows),
            "stop_group": [row[0] for row in lines], "stop_point": flat(row[1:4] for row in lines),
            "stop_line": flat(row[4:] for row in lines)}


def decode_team_map(payload):
    """A robot's part of its team's map. acks: robot, session, number of pieces and bits of later ones of each
    acknowledgement; claim: cells
    to skip and to take, of each run; data: a piece of measurements."""
    names = ("left_m", "top_m", "cell_m", "word_columns", "word_rows", "piece", "flags")
    require(len(payload) >= 44, "too short")
    left, top, cell, columns, rows, piece, size, acks, runs, flags = struct.unpack_from("<3d3I4H", payload)
    words = unpack("<%dI%dH%dB" % (4 * acks, 2 * runs, size), payload[44:])
    robots, claim, data = words[:4 * acks:4], words[4 * acks:4 * acks + 2 * runs], words[4 * acks + 2 * runs:]
    require(all(map(math.isfinite, (left, top, cell))), "not finite")
    require_numbers((left, top), 1e7)
    require(1e-4 <= cell <= 1e3 and 1 <= columns <= 4096 and 1 <= rows <= 4096 and columns * rows <= 2**20)
    require(acks <= 12 and all(robot <= 65535 for robot in robots) and sum(claim) <= 16 * columns * rows)
    require(flags < 8 and (flags & 2 or not claim and not flags & 4) and (data or piece == 0 and not flags & 1))
    return {**dict(zip(names, (left, top, cell, columns, rows, piece, flags))), "acks": list(words[:4 * acks]),
            "claim": list(claim), "data": list(data)}


def decode_own_readings(payload):
    """A part of a reading of a robot's own sensor. value: ranges [m], math.inf without an echo, None if not measured;
    of bumpers 0 or 1."""
    require(len(payload) >= 16, "too short")
    type, count, total, first, fov = struct.unpack_from("<2H3I", payload)
    words = unpack("<%dI" % (1 if type == BUMPER else count), payload[16:])
    most = {LASER: 1000000, SONAR: 64, INFRARED: 64, BUMPER: 32}.get(type, 0)
    require(1 <= total <= most and first < total and first % 310 == 0 and count == min(310, total - first))
    require(fov <= (6283186 if type == LASER else 0) and (type != BUMPER or words[0] >> count == 0))
    if type == BUMPER:
        values = [words[0] >> k & 1 for k in range(count)]
    else:
        values = [None if word == NONE else math.inf if word == NONE - 1 else word / 1e4 for word in words]
    return {"readings_type": type, "total": total, "first": first, "fov_urad": fov, "value": values}


def decode_command(payload):
    require(len(payload) >= 16, "too short")
    tick, count = struct.unpack_from("<QI", payload)
    require(len(payload) >= 16 + 32 * count, "too short")
    require(len(payload) == 16 + 32 * count, "too long")
    rows = struct.unpack("<" + "3d2I" * count, payload[16:])
    twists = [number for i in range(0, len(rows), 5) for number in rows[i:i + 3]]
    require(1 <= count <= 38)
    require(all(map(math.isfinite, twists)), "not finite")
    require(all(abs(number) <= 1e3 for number in twists) and max(rows[3::5]) <= 65535)
    return {"tick": tick, "robots": list(rows[3::5]), "twists": twists}


def decode_values(payload):
    require(len(payload) >= 72, "too short")
    tick, index, datagrams, type, count, total, first = struct.unpack_from("<QIIHHII", payload)
    x, y, z, yaw, error = struct.unpack_from("<5d", payload, 32)
    values = unpack("<%dd" % count, payload[72:])
    require(all(map(math.isfinite, (x, y, z, yaw))) and not math.isnan(error), "not finite")
    require(1 <= total <= 2**24 and first < total and first % 148 == 0 and count == min(148, total - first))
    require(1 <= type <= 63 and index < datagrams and error >= 0)
    return {"tick": tick, "index": index, "datagrams": datagrams, "values_type": type, "total": total, "first": first,
            "sensor_pose": [x, y, z, yaw], "error": None if math.isinf(error) else error, "value": list(values)}


def decode_lockstep(type, payload):
    if type == COMMAND:
        return decode_command(payload)
    if type == VALUES:
        return decode_values(payload)
    if type == STATE:
        payload, tilt = split_tilt(80, payload)
        tick, index, datagrams, *numbers, contact, flags = unpack("<QII7dII", payload)
        require(all(map(math.isfinite, numbers + tilt.get("tilt", []))), "not finite")
        require(index < datagrams and contact <= 1 and flags <= 1)
        return {"tick": tick, "index": index, "datagrams": datagrams, "contact": contact, "flags": flags,
                "pose": numbers[:4], "velocity": numbers[4:], **tilt}
    tick, first, second = unpack("<QII", payload)
    require(1 <= first <= 1000 and second <= 65536 if type == STEP else 1 <= second <= 64)
    return dict(zip(("tick", "ticks", "commands") if type == STEP else ("tick", "first", "count"), (tick, first, second)))


def decode_shaped(robot, payload):
    """Decodes an OBJECT that changes a shape, colour or size. None: unchanged."""
    flags, color, *size, name = struct.unpack(SHAPED_OBJECT, payload)
    require_numbers(size, math.inf)
    name, padding = name.split(b"\0", 1)[0], name[len(name.split(b"\0", 1)[0]):]
    require(1 < flags < 16 and robot > 0 and not padding.strip(b"\0"))
    require(SHAPE_NAME.fullmatch(name) if flags & 2 else not name)
    require(flags & 4 or color == 0)
    require(all(0 < length <= 1000 for length in size) if flags & 8 else payload[8:32] == bytes(24))
    return {"present": flags & 1, "shape": name.decode() if flags & 2 else None, "color": color if flags & 4 else None,
            "size_m": size if flags & 8 else [None] * 3}


def decode_state(type, robot, payload):
    if type == V2I:
        return decode_v2i(payload)
    if type == TEAM_MAP:
        return decode_team_map(payload)
    if type == OWN_READINGS:
        return decode_own_readings(payload)
    if type == NEIGHBOURS:
        require(len(payload) <= 9 * V2V_BYTES, "too long")
        require(len(payload) > 0 and len(payload) % V2V_BYTES == 0, "too short")
        states = [decode(payload[at:at + V2V_BYTES]) for at in range(0, len(payload), V2V_BYTES)]
        require(all(state["type"] == V2V for state in states), "wrong direction")
        return {"states": states}
    if type == OBJECT and len(payload) == struct.calcsize(SHAPED_OBJECT):
        return decode_shaped(robot, payload)
    payload, tilt = split_tilt(V2V_BYTES - HEADER_BYTES, payload) if type == V2V else (payload, {})
    numbers = unpack("<Q" if type == SUBSCRIBE and len(payload) == 8 else STATES[type], payload)
    if type == V2V:
        roll, pitch = tilt.get("tilt", (0.0, 0.0))
        require(all(map(math.isfinite, (*numbers[:7], roll, pitch))), "not finite")
        for part, limit in ((numbers[:3], 1e7), (numbers[3:4], 1e6), (numbers[4:7], 1e3), ([roll], math.pi),
                            ([pitch], math.pi / 2)):
            require_numbers(part, limit)
        require((numbers[7] <= 65535 or numbers[7] == NONE) and numbers[9] <= 1)
        follows, checkpoint = (None if number == NONE else number for number in numbers[7:9])
        return {"follows": follows, "checkpoint": checkpoint, "docking": numbers[9], "pose": list(numbers[:4]),
                "velocity": list(numbers[4:7]), **tilt}
    if type == TAG:
        require_numbers(numbers, 1e7)
        require_numbers(numbers[7:], 1e3)
        require(abs(math.hypot(*numbers[3:7]) - 1) <= 1e-3 and robot > 0)
        return {"position": list(numbers[:3]), "orientation": list(numbers[3:7]), "linear": list(numbers[7:10]),
                "angular": list(numbers[10:])}
    if type == DRIVE:
        require_numbers(numbers, 1e3)
        return {"velocity": list(numbers)}
    if type == LANE:
        require(numbers[2] < 16 and numbers[2] % 8 <= 4)
        return dict(zip(("segment", "lane", "use"), numbers))
    if type == DROPPED:
        require(1 <= numbers[0] <= 63)
        return dict(zip(("readings_type", "processor", "network"), numbers))
    require(type != OBJECT or numbers[0] <= 1 and robot > 0)
    require(type != REFUSAL or 1 <= numbers[0] <= 4)
    name = {SUBSCRIBE: "types", OBJECT: "present", REFUSAL: "reason"}.get(type, "challenge")
    return {name: number for number in numbers}


def decode(data):
    """Decodes any bytes to a dictionary, in SI units. None means that there is no number. Raises Malformed."""
    require(len(data) >= HEADER_BYTES, "too short")
    fields = HEADER.unpack_from(data)
    magic, version, type, robot, sensor, accuracy, sequence, time_ns, session, token, age = fields[:11]
    covariance, trailer, flags = fields[11:17], fields[17], fields[18]
    require(magic == b"SFPK", "bad magic")
    require(version == 2, "unknown version")
    require(len(data) >= HEADER_BYTES + trailer, "too short")
    require(type in TYPE_NAMES, "unknown type")
    payload = data[HEADER_BYTES:len(data) - trailer]
    require(len(payload) <= MAX_PAYLOAD, "too long")
    packet = {"type": type, "robot": robot, "sensor": sensor, "sequence": sequence, "time_ns": time_ns,
              "session": session, "token": token}
    if type < 128 or type == VALUES:
        bound = None if accuracy < 32 else 2.0**(((accuracy >> 5) - 1024) / 16)
        packet.update(mode=accuracy & 15, unsure=accuracy >> 4 & 1, bound=bound)
    if type < 128 and flags & 4:
        packet.update(fused=1)  # includes a reading of the robot's own sensor
    if type < 128 or type in (V2V, TAG) and age:
        known = all(map(math.isfinite, covariance)) and min(covariance[0], covariance[3], covariance[5]) >= 0
        packet.update(age_us=age, stale=flags & 1 if age else 0,
                      covariance=list(covariance) if age and known else [0.0] * 6)
    if type in (COMMAND, STEP, FETCH, STATE, VALUES):
        packet.update(decode_lockstep(type, payload))
    elif type >= 128:
        packet.update(decode_state(type, robot, payload))
    elif type in (LASER, LASER_EXTENDED):
        packet.update(decode_laser(type == LASER_EXTENDED, payload))
    elif type == CAMERA_EXTENDED and len(payload) >= 16 and payload[14:16] != b"\0\0":
        packet.update(decode_image(payload))
    elif type in (CAMERA, CAMERA_EXTENDED):
        image = decode_laser(type == CAMERA_EXTENDED, payload)
        packet.update({"depth_m" if key == "range_m" else key: value for key, value in image.items()})
    elif type in (LIDAR, LIDAR_EXTENDED):
        packet.update(decode_lidar(type == LIDAR_EXTENDED, payload))
    elif type == LANE_EDGE:
        packet.update(decode_lane_edge(payload))
    elif type == OCCUPANCY:
        packet.update(decode_occupancy(payload))
    else:
        packet.update(decode_rows(type, payload))
    require(0 <= time_ns <= 2**62 and trailer <= 80)
    return packet


def encode(type, payload=b"", robot=0, sequence=0, time_ns=0, session=0, token=0, age_us=0, stale=0,
           covariance=(0.0,) * 6, sensor=0):
    """Encodes a packet to the farm; START and LEAVE have no payload. V2V and TAG: `age_us` (at least 1) of an estimate
    and the covariance of its pose. Raises Malformed for numbers that the farm would drop."""
    head = HEADER.pack(b"SFPK", 2, type, robot, sensor, 0, sequence, time_ns, session, token, age_us, *covariance, 0,
                       stale)
    decode(head + payload)
    return head + payload


def encode_v2v(pose, velocity=(0.0, 0.0, 0.0), follows=None, checkpoint=None, docking=0, tilt=(0.0, 0.0), **header):
    """Encodes a robot's state. pose: x, y, z [m], yaw [rad] in the world frame; velocity: forward, left [m/s], turn
    [rad/s]; tilt: roll, pitch [rad] (positive: left side higher, front lower)."""
    ids = [NONE if number is None else number for number in (follows, checkpoint)]
    tilted = struct.pack("<2d", *tilt) if any(tilt) else b""
    return encode(V2V, struct.pack(STATES[V2V], *pose, *velocity, *ids, docking) + tilted, **header)


def encode_tag(position, orientation, linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0), **header):
    """Encodes the state of tag `robot` in the world frame [m, m/s, rad/s]. orientation: quaternion x, y, z, w."""
    return encode(TAG, struct.pack(STATES[TAG], *position, *orientation, *linear, *angular), **header)


def encode_object(present, shape=None, color=None, size_m=None, **header):
    """Removes the object of tag `robot` from the world, or puts it back. shape: name of a shape of the world, or
    "original"; color: 0xAARRGGBB; size_m: x, y, z; None: unchanged."""
    size = None if size_m is None or None in size_m else size_m
    flags = present | (shape is not None) << 1 | (color is not None) << 2 | (size is not None) << 3
    if flags == present:
        return encode(OBJECT, struct.pack("<I", present), **header)
    return encode(OBJECT, struct.pack(SHAPED_OBJECT, flags, color or 0, *(size or (0.0,) * 3),
                                      (shape or "").encode()), **header)


def encode_lane(segment, lane, use, **header):
    """Requests the use of a lane. use: 0 open, 1 closed, 2 turn, 3 left, 4 right; plus 8 if it is reversed."""
    return encode(LANE, struct.pack("<3I", segment, lane, use), **header)


def encode_subscribe(types=0, **header):
    """types: bit k for sensor type k, bit 0 for states of others; 0: all sensor types."""
    return encode(SUBSCRIBE, struct.pack("<Q" if types >> 32 else "<I", types), **header)


def encode_own_readings(readings_type, total, first, value, fov_urad=0, **header):
    """A part of a reading of the robot's own sensor `sensor` of this type. value: up to 310 ranges [m] from number
    `first` on, a multiple of 310, of `total`: math.inf without an echo, None if not measured; of bumpers 0 or 1.
    fov_urad: of a laser, from its first beam to its last."""
    if readings_type == BUMPER:
        words = [sum(pressed << k for k, pressed in enumerate(value))]
    else:
        words = [NONE if v is None else min(NONE - 1, math.floor(v * 1e4 + 0.5)) if v < 429497 else NONE - 1
                 for v in value]
    head = struct.pack("<2H3I", readings_type, len(value), total, first, fov_urad)
    return encode(OWN_READINGS, head + struct.pack("<%dI" % len(words), *words), **header)


def encode_command(tick, robots, twists, **header):
    """Lockstep: commands of robots from this tick on. robots: 1 to 38 ids; twists: forward, left [m/s], turn [rad/s] of
    each, one after another."""
    rows = [struct.pack("<3d2I", *twists[3 * i:3 * i + 3], robot, 0) for i, robot in enumerate(robots)]
    return encode(COMMAND, struct.pack("<QII", tick, len(rows), 0) + b"".join(rows), **header)


def encode_step(tick, ticks=1, commands=0, **header):
    """Lockstep: simulates `ticks` more. commands: robots for which this process has sent a COMMAND of this tick."""
    return encode(STEP, struct.pack("<QII", tick, ticks, commands), **header)


def encode_fetch(tick, first, count, **header):
    """Lockstep: requests `count` datagrams of this tick's answer, from number `first` on."""
    return encode(FETCH, struct.pack("<QII", tick, first, count), **header)


def sign(data, key, counter):
    """Returns the packet with a signature appended: a counter, and half the HMAC-SHA-256 of all preceding bytes."""
    head = data[:60] + struct.pack("<H", SIGNATURE_BYTES) + data[62:] + struct.pack("<Q", counter)
    return head + hmac.digest(key, head, "sha256")[:16]


class Window:
    """Counters of received signatures: each is accepted once, in any order within the newest 64."""

    def __init__(self):
        self.newest, self.seen = 0, 0  # bit k of seen: newest - k was received

    def check(self, data, key):
        require(data[60:62] == struct.pack("<H", SIGNATURE_BYTES), "not signed")
        require(hmac.compare_digest(hmac.digest(key, data[:-16], "sha256")[:16], data[-16:]), "wrong signature")
        counter = struct.unpack("<Q", data[-24:-16])[0]
        if counter > self.newest:
            self.seen <<= min(counter - self.newest, 64)
            self.newest = counter
        bit = 1 << min(self.newest - counter, 64)
        require(bit < 2**64 and not self.seen & bit, "replayed")
        self.seen = (self.seen | bit) % 2**64


class Client:
    """One robot that communicates with the farm. `counts` has the number of packets accepted, and dropped by reason."""

    def __init__(self, robot, farm, sensors, neighbours=False, key=None):
        """farm: host, port. sensors: (type's name, number[, own port]) of each. neighbours: also request states of
        others. key: the farm's key for this robot, 32 bytes (docs/packets.md, Signatures); None: nothing is signed."""
        self.key, self.counter = key, time.time_ns() // 1000
        self.robot, self.farm = robot, (socket.gethostbyname(farm[0]), farm[1])
        self.session, self.token, self.farm_session = int.from_bytes(os.urandom(4), "little") | 1, 0, 0
        self.types, self.sent, self.next_request = int(neighbours), collections.Counter(), 0.0
        self.newest, self.counts = {}, collections.Counter()
        self.sockets = [self._open(0)]  # the first one sends: its address and port bind the id
        for name, number, *port in sensors:
            type = next(type for type in SENSORS if SENSORS[type][0] == name)
            self.types |= 1 << type
            self.sockets.append(self._open(port[0] if port else SENSORS[type][1] + 8 * robot + number))
        self.windows = {opened: Window() for opened in self.sockets}

    def _open(self, port):
        opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        opened.bind(("127.0.0.1" if self.farm[0].startswith("127.") else "", port))
        opened.setblocking(False)
        return opened

    def _header(self, type):
        self.sent[type] += 1
        return {"robot": self.robot, "sequence": (self.sent[type] - 1) % 2**32, "time_ns": time.monotonic_ns(),
                "session": self.session, "token": self.token}

    def _send(self, data):
        if self.key:
            data, self.counter = sign(data, self.key, self.counter), self.counter + 1
        try:
            self.sockets[0].sendto(data, self.farm)
        except OSError:
            self.counts["not sent"] += 1

    def send_state(self, pose, velocity=(0.0, 0.0, 0.0), **state):
        """Sends V2V, and SUBSCRIBE twice a second."""
        if time.monotonic() >= self.next_request:
            self._send(encode_subscribe(self.types, **self._header(SUBSCRIBE)))
            self.next_request = time.monotonic() + 0.5
        self._send(encode_v2v(pose, velocity, **state, **self._header(V2V)))

    def leave(self):
        self._send(encode(LEAVE, **self._header(LEAVE)))
        for opened in self.sockets:
            opened.close()

    def receive(self, timeout):
        """Returns accepted readings, NEIGHBOURS, V2I, DROPPED and START that arrive within `timeout` [s]; bounded in number."""
        packets = []
        for opened in select.select(self.sockets, [], [], max(0.0, timeout))[0]:
            for _ in range(64):
                try:
                    data, sender = opened.recvfrom(2048)
                except OSError:
                    break
                try:
                    packet = self._accept(data, sender, self.windows[opened])
                    self.counts["accepted"] += 1
                    packets += [packet] if packet["type"] != CHALLENGE else []
                except Malformed as reason:
                    self.counts[str(reason)] += 1
        return packets

    def _accept(self, data, sender, window):
        require(sender == self.farm, "wrong source")
        packet = decode(data)
        require(packet["token"] == self.session, "wrong source")
        require(packet["type"] != REFUSAL, REFUSALS.get(packet.get("reason")))
        require(packet["type"] == CHALLENGE or packet["session"] == self.farm_session, "wrong source")
        if self.key:
            window.check(data, self.key)
        if packet["type"] == CHALLENGE:
            if packet["session"] != self.farm_session:
                self.newest.clear()  # another farm
            self.token, self.farm_session, self.next_request = packet["challenge"], packet["session"], 0.0
            return packet
        require(packet["type"] < 128 or packet["type"] in (START, NEIGHBOURS, V2I, DROPPED), "wrong direction")
        require(packet["type"] == V2I or packet["robot"] in (self.robot, EVERY_ROBOT), "unknown robot")
        require(packet["type"] == START or self._is_newer(packet), "stale")
        return packet

    def _is_newer(self, packet):
        """Compares sequences. Parts of one reading share theirs, and after two seconds of silence any packet is
        newer."""
        key, now = (packet["type"], packet["robot"], packet["sensor"]), time.monotonic()
        sequence, when = self.newest.get(key, (0, -math.inf))
        first = 0 if "part" in packet else 1
        newer = now - when > 2.0 or first <= (packet["sequence"] - sequence) % 2**32 < 2**31
        if newer:
            self.newest[key] = packet["sequence"], now
        return newer


def text(value):
    if isinstance(value, list):
        return " ".join(map(text, value))
    if isinstance(value, str):
        return value
    return "none" if value is None or value != value else "%d" % value if isinstance(value, int) else "%.10g" % value


def fields(packet):
    """Returns the keys and values of `decode` as text, in order."""
    pairs = {key: text(value) for key, value in packet.items() if key != "states"}
    for i, state in enumerate(packet.get("states", [])):
        pairs.update(("%d.%s" % (i, key), value) for key, value in fields(state).items())
    return pairs


def rounded_up(bound):
    """Returns three digits, never less than the bound."""
    nearest = "%.3g" % bound
    return nearest if float(nearest) >= bound else "%.3g" % (bound + 0.5 * 10.0**(math.floor(math.log10(bound)) - 2))


def words(packet):
    """Returns one line about a packet; NEIGHBOURS: one for each state."""
    if packet["type"] == NEIGHBOURS:
        return "\n".join(map(words, packet["states"]))
    whose = {V2I: "intersection", OBJECT: "tag"}.get(packet["type"], "robot")
    line = "%s %d of %s %d" % (TYPE_NAMES[packet["type"]], packet["sensor"], whose, packet["robot"])
    body = list(fields(packet).items())[13 if packet["type"] < 128 else 10 if packet["type"] == VALUES or "age_us" in packet else 7:]
    line += " at %.3f s" % (packet["time_ns"] * 1e-9) + "".join("; %s = %s" % pair for pair in body)
    if "mode" in packet:
        line += "; mode %d" % packet["mode"] + (", not for every element" if packet["unsure"] else "")
        line += "; error up to " + rounded_up(packet["bound"]) if packet["bound"] else ""
    if packet.get("age_us"):
        line += ("; no state of the robot has arrived yet" if packet["age_us"] == 2**32 - 1 and packet["stale"] else
                 "; state %.1f ms old" % (packet["age_us"] * 1e-3) + (", stale" if packet["stale"] else ""))
        sigmas = [math.sqrt(packet["covariance"][i]) for i in (0, 3, 5)]
        line += ", sigma %.3g m, %.3g m, %.3g rad" % tuple(sigmas) if any(sigmas) else ""
    return line


def read_sensor(word):
    """TYPE[.NUMBER][=PORT]"""
    name, _, port = word.partition("=")
    name, _, number = name.partition(".")
    if name not in [sensor[0] for sensor in SENSORS.values()]:
        raise argparse.ArgumentTypeError("'%s' is not a sensor type" % name)
    return (name, int(number or 0)) + ((int(port),) if port else ())


def read_pose(word):
    """X,Y,YAW, or X,Y,Z,ROLL,PITCH,YAW. Returns the arguments of encode_v2v."""
    numbers = [float(number) for number in word.split(",")]
    if len(numbers) not in (3, 6):
        raise ValueError
    z, *tilt = numbers[2:-1] or (0.0, 0.0, 0.0)
    return {"pose": (*numbers[:2], z, math.radians(numbers[-1])), "tilt": tuple(map(math.radians, tilt))}


def read_key(file):
    with open(file) as opened:
        key = bytes.fromhex(opened.read(1000).strip())
    if len(key) != 32:
        raise argparse.ArgumentTypeError("%s holds %d bytes of 32" % (file, len(key)))
    return key


def read_farm(word):
    host, _, port = word.rpartition(":")
    return host or "127.0.0.1", int(port)


def main():
    parser = argparse.ArgumentParser(description="Connects a robot to a sensor farm: sends its pose, prints its readings.")
    parser.add_argument("--robot", type=int, required=True, help="id, 0 to 65535")
    parser.add_argument("--farm", type=read_farm, default=("127.0.0.1", 9000), metavar="HOST:PORT")
    parser.add_argument("--pose", type=read_pose, default={"pose": (0.0,) * 4}, metavar="X,Y,DEGREES",
                        help="or X,Y,Z,ROLL,PITCH,YAW in metres and degrees")
    parser.add_argument("--rate", type=float, default=10.0, metavar="HZ", help="states per second, 1 to 1000")
    parser.add_argument("--sensor", type=read_sensor, action="append", metavar="TYPE[.NUMBER][=PORT]")
    parser.add_argument("--key", type=read_key, metavar="FILE", help="64 hexadecimal digits: sign, and check signatures")
    parser.add_argument("--images", metavar="FOLDER", help="write each camera's newest image there, as camera-NUMBER.png or .jpg")
    parser.add_argument("--neighbours", action="store_true", help="print the states of other robots, too")
    # "-1,0.5,30" is a value of --pose, not an option.
    options = parser.parse_args("\0".join(sys.argv[1:]).replace("--pose\0", "--pose=").split("\0"))
    if not (0 <= options.robot <= 65535 and 1.0 <= options.rate <= 1000.0):
        parser.error("expected --robot from 0 to 65535 and --rate from 1 to 1000")
    try:
        encode_v2v(**options.pose)
        client = Client(options.robot, options.farm, options.sensor or [("laser", 0)], options.neighbours,
                        options.key)
    except (OSError, OverflowError, Malformed) as error:
        parser.error(str(error))
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    images = Images()
    try:
        due = time.monotonic()
        while True:
            if time.monotonic() >= due:
                client.send_state(**options.pose)
                due = max(due + 1.0 / options.rate, time.monotonic())
            for packet in client.receive(due - time.monotonic()):
                image = images.add(packet) if options.images else None
                if image:
                    suffix = "jpg" if packet["form"] == 2 else "png"
                    with open("%s/camera-%d.%s" % (options.images, packet["sensor"], suffix), "wb") as file:
                        file.write(image)
                if not (options.images and "image" in packet):
                    print(words(packet), flush=True)
    except (KeyboardInterrupt, BrokenPipeError):
        pass
    finally:
        client.leave()
        print(", ".join("%s %d" % pair for pair in client.counts.items()) or "nothing received", file=sys.stderr)


if __name__ == "__main__":
    main()
