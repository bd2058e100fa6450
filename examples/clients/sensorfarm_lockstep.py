#!/usr/bin/env python3
"""Drives robots that the farm simulates (`sensorfarm serve WORLD --lockstep`), tick by tick, using only
Python's standard library. Lost packets are repeated; a run has the same readings each time, bit for bit, on any
machine's network.

As a program: robots 1 to 5 drive forward and turn away from nearby obstacles.

    python3 sensorfarm_lockstep.py --robots 1-5 --farm 127.0.0.1:9000 --ticks 600

As a module:

    fleet = Lockstep([1, 2], ("127.0.0.1", 9000), ["laser"])
    while fleet.time < 60.0:
        fleet.step({id: drive(fleet.readings[id, "laser", 0].values) for id in fleet.robots})
    fleet.leave()
"""

import argparse
import array
import collections
import math
import select
import signal
import socket
import sys
import time

from sensorfarm_client import (CHALLENGE, EVERY_ROBOT, LEAVE, REFUSAL, REFUSALS, SENSORS, STATE, VALUES, Client,
                               Malformed, Window, decode, encode, encode_command, encode_fetch, encode_step,
                               encode_subscribe, read_farm, read_key, require, sign)

ROWS, WINDOW, PUSHED = 38, 64, 64  # robots of a COMMAND; datagrams of a FETCH; datagrams that arrive without a FETCH
PATIENCE = 0.02  # [s] of silence after which packets are repeated, doubled each time up to half a second

# x, y, z, yaw; forward, left, turn; 0 or 1; roll, pitch
State = collections.namedtuple("State", "pose velocity contact tilt")
# error: the largest error of the first column of all elements; None: no bound is stated. unsure: 1: the type's bound
# does not hold for all elements (noise, a bend of a lane edge, beams that graze or were not cast).
Reading = collections.namedtuple("Reading", "time_ns pose values error tick unsure")


class Lockstep(Client):
    """Robots of one process. After each call of `step`: tick, time [s], `robots` with the state of each by id,
    `readings` with the newest of each sensor by (id, type's name, number); its `tick` is the tick at which it arrived.
    `others` has the states of robots of other processes, if they are requested."""

    def __init__(self, robots, farm, sensors=None, others=False, keys=None, timeout=10.0):
        """sensors: names of types; None: all types. keys: by id, of robots that have one. timeout: [s] without a packet
        of the farm after which TimeoutError is raised."""
        super().__init__(robots[0], farm, [])
        self.sockets[0].setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2**22)  # the system may grant less
        self.keys, self.timeout = keys or {}, timeout
        self.counters, self.key_windows = dict.fromkeys(self.keys, self.counter), {}
        names = [sensor[0] for sensor in SENSORS.values()] if sensors is None else sensors
        self.types = sum(1 << type for type in SENSORS if SENSORS[type][0] in names) | int(others)
        self.ids, self.robots, self.others, self.readings = sorted(robots), {}, {}, {}
        self.tick = self.wanted = self.time = None
        self.parts, self.missing, self.asked, self.rows = [], 0, 0, {}
        self.driver_lost = False  # the farm has dropped another process: from then on runs may differ
        self._subscribe()

    def step(self, commands, ticks=1):
        """Simulates `ticks`. commands: by id forward, left [m/s], turn [rad/s]; robots without a command continue as
        before."""
        ids, sequence = sorted(commands), self.tick
        for id in ids:
            if id not in self.robots:
                raise ValueError("robot %d is not among those of this process" % id)
        plain = [id for id in ids if id not in self.keys]  # robots with a key get a separate packet
        chosen = [plain[i:i + ROWS] for i in range(0, len(plain), ROWS)] + [[id] for id in ids if id in self.keys]
        asks = [(some[0], encode_command(sequence, some, [v for id in some for v in commands[id]],
                                         **self._head(some[0]))) for some in chosen]
        asks.append((self.ids[0], encode_step(sequence, ticks, len(ids), **self._head(self.ids[0]))))
        self.wanted = sequence + ticks
        self._ask(asks)
        return self.tick

    def leave(self):
        for id in self.ids:
            self._post(id, encode(LEAVE, **self._head(id)))
        for opened in self.sockets:
            opened.close()

    def _head(self, id):
        return {"robot": id, "session": self.session, "token": self.token}

    def _post(self, id, data):
        if id in self.keys:
            data = self._signed(id, data)
        try:
            self.sockets[0].sendto(data, self.farm)
        except OSError:
            self.counts["not sent"] += 1

    def _signed(self, id, data):
        self.counters[id] += 1
        return sign(data, self.keys[id], self.counters[id] - 1)

    def _subscribe(self):
        """Subscribes until the farm has confirmed all robots, then receives the whole answer of its tick."""
        sequence, silent = 0, 0
        while len(self.robots) < len(self.ids):
            for id in [id for id in self.ids if id not in self.robots][:WINDOW]:
                self._post(id, encode_subscribe(self.types, **self._head(id), sequence=sequence))
            sequence += 1
            silent = 0 if self._receive(PATIENCE) else silent + 1
            if silent * PATIENCE > self.timeout:
                raise TimeoutError("no farm in lockstep answers at %s:%d for robot %d" % (
                    *self.farm, next(id for id in self.ids if id not in self.robots)))
        self.tick, self.parts = self.wanted, []
        self._fetch(0, PUSHED)
        self._ask([])

    def _ask(self, asks):
        """Sends requests, and repeats them until they are answered."""
        for ask in asks:
            self._post(*ask)
        wait, heard = PATIENCE, time.monotonic()
        while self.tick != self.wanted or not self.parts or self.missing:
            if self._receive(wait):
                wait, heard = PATIENCE, time.monotonic()
                self._fetch_ahead()
                continue
            if time.monotonic() - heard > self.timeout:
                raise TimeoutError("no packet from the farm at %s:%d for %g s at tick %d: it has ended, or left out "
                                   "this process" % (*self.farm, self.timeout, self.tick))
            wait = min(2 * wait, 0.5)
            if self.tick == self.wanted:
                self._fetch(self.parts.index(False) if self.parts else 0)
            else:
                for ask in asks:
                    self._post(*ask)

    def _fetch_ahead(self):
        """Requests the next datagrams when half of the previous ones have arrived."""
        have = len(self.parts) - self.missing
        while self.tick == self.wanted and self.asked < len(self.parts) and have >= self.asked - WINDOW // 2:
            self._fetch(self.asked)
            self.asked += WINDOW

    def _fetch(self, first, count=WINDOW):
        self._post(self.ids[0], encode_fetch(self.tick, first, count, **self._head(self.ids[0])))

    def _receive(self, timeout):
        """Receives all waiting packets. Returns whether any packet of the farm arrived."""
        came = False
        select.select(self.sockets, [], [], timeout)
        while True:
            try:
                data, sender = self.sockets[0].recvfrom(2048)
            except OSError:
                return came
            try:
                packet = self._accept(data, sender, self.windows[self.sockets[0]])
                self.counts["accepted"] += 1
                came = True
                if packet["type"] != CHALLENGE:
                    self._place(packet)
            except Malformed as reason:
                self.counts[str(reason)] += 1

    def _accept(self, data, sender, window):
        require(sender == self.farm, "wrong source")
        packet = decode(data)
        require(packet["token"] == self.session, "wrong source")
        require(packet["type"] != REFUSAL, REFUSALS.get(packet.get("reason")))
        if self.keys:
            key = self.keys.get(packet["robot"] if packet["robot"] in self.ids else self.ids[0])
            if key:
                self.key_windows.setdefault(key, Window()).check(data, key)
        if packet["type"] == CHALLENGE:
            self.token, self.farm_session = packet["challenge"], packet["session"]
            return packet
        require(packet["session"] == self.farm_session, "wrong source")
        require(packet["type"] in (STATE, VALUES), "wrong direction")
        return packet

    def _place(self, packet):
        """Stores one datagram of an answer, once."""
        if packet["type"] == STATE and len(self.robots) < len(self.ids) and packet["robot"] in self.ids:
            self.robots[packet["robot"]] = None
            self.wanted = packet["tick"]
        if packet["tick"] != self.wanted:
            return
        if self.tick != packet["tick"] or len(self.parts) != packet["datagrams"]:
            self.tick, self.missing = packet["tick"], packet["datagrams"]
            self.parts, self.asked, self.rows = [False] * self.missing, PUSHED, {}
        if self.parts[packet["index"]]:
            return
        self.parts[packet["index"]] = True
        self.missing -= 1
        if packet["type"] == STATE:
            own = self.robots if packet["robot"] in self.robots else self.others
            own[packet["robot"]] = State(packet["pose"], packet["velocity"], packet["contact"],
                                         packet.get("tilt", [0.0, 0.0]))
            self.time, self.driver_lost = packet["time_ns"] * 1e-9, packet["flags"] == 1
        else:
            self._place_values(packet)

    def _place_values(self, packet):
        key = packet["robot"], SENSORS[packet["values_type"]][0], packet["sensor"]
        values = self.rows.setdefault(key, array.array("d", bytes(8 * packet["total"])))
        values[packet["first"]:packet["first"] + len(packet["value"])] = array.array("d", packet["value"])
        self.readings[key] = Reading(packet["time_ns"], packet["sensor_pose"], values, packet["error"], packet["tick"],
                                     packet["unsure"])


def avoid(ranges):
    """Drives forward, and away from nearby obstacles: the left half of a scan comes last."""
    nearest, turn = min(ranges), 0.125 * (ranges[-1] - ranges[0])
    return 0.25 * min(nearest, 2.0), 0.0, 1.0 if nearest < 0.6 else turn


def read_ids(word):
    first, _, last = word.partition("-")
    ids = list(range(int(first), int(last or first) + 1))
    if not ids or ids[0] < 0 or ids[-1] >= EVERY_ROBOT + 1:
        raise argparse.ArgumentTypeError("'%s' is not a range of ids from 0 to 65535" % word)
    return ids


def read_key_of(word):
    id, _, file = word.partition("=")
    return int(id), read_key(file)


def main():
    parser = argparse.ArgumentParser(description="Drives robots of `sensorfarm serve --lockstep` by their lasers.")
    parser.add_argument("--robots", type=read_ids, required=True, metavar="FIRST-LAST", help="ids")
    parser.add_argument("--farm", type=read_farm, default=("127.0.0.1", 9000), metavar="HOST:PORT")
    parser.add_argument("--ticks", type=int, default=600, metavar="N")
    parser.add_argument("--key", type=read_key_of, action="append", default=[], metavar="ROBOT=FILE",
                        help="64 hexadecimal digits: the key of a robot (may be repeated)")
    parser.add_argument("--timeout", type=float, default=10.0, metavar="S", help="time to wait for a silent farm [s]")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    fleet = None
    try:
        fleet = Lockstep(options.robots, options.farm, ["laser"], keys=dict(options.key), timeout=options.timeout)
        begun, first = time.monotonic(), fleet.tick
        while fleet.tick - first < options.ticks:
            fleet.step({id: avoid(fleet.readings[id, "laser", 0].values) for id in fleet.robots})
        seconds = time.monotonic() - begun
        for id, state in fleet.robots.items():
            print("robot %d at tick %d: x = %.17g, y = %.17g, yaw = %.17g" % (id, fleet.tick, *state.pose[:2],
                                                                             state.pose[3]))
        print("%d ticks in %.3f s: %.0f a second" % (options.ticks, seconds, options.ticks / max(seconds, 1e-9)),
              file=sys.stderr)
    except KeyError as missing:
        sys.exit("robot %d has no laser" % missing.args[0][0])
    except (TimeoutError, OSError, Malformed) as error:
        sys.exit("sensorfarm_lockstep: %s" % error)
    except KeyboardInterrupt:
        pass
    finally:
        if fleet:
            fleet.leave()


if __name__ == "__main__":
    main()
