#!/usr/bin/env python3
"""A control centre: receives the V2V states of all robots of a farm, whatever the radio range, and prints them and the
mean speeds of stretches of road. Needs only the standard library and sensorfarm_client.py in the same folder.

    python3 sensorfarm_centre.py --farm 127.0.0.1:9000 --link north:0,7,11,7 --link south:11,0,0,0 --every 10

The farm permits it in its table of peers (docs/robots.md): [[peer]] centre = true, with an address, a key, or both.
A link is a line in driving direction. Its speed is the distance that robots drove on it since the last print over the
time that they spent there.
"""

import argparse
import math
import signal
import struct
import sys
import time

from sensorfarm_client import EVERY_ROBOT, NEIGHBOURS, SUBSCRIBE, Client, encode_subscribe, read_key

CENTRE = 2  # `sensor` in the header of SUBSCRIBE and LEAVE: the sender is the control centre
LONGEST_GAP = 2.0  # [s] between two states of a robot


class Centre(Client):
    """The states that a farm receives from its robots. `counts` has the datagrams accepted, and dropped by reason."""

    def __init__(self, farm, key=None):
        super().__init__(EVERY_ROBOT, farm, [], neighbours=True, key=key)

    def _send(self, data):
        super()._send(data[:8] + struct.pack("<H", CENTRE) + data[10:])

    def states(self, timeout):
        """Returns the V2V packets that arrive within `timeout` [s], and keeps the permission alive."""
        if time.monotonic() >= self.next_request:
            self.next_request = time.monotonic() + 0.5
            self._send(encode_subscribe(self.types, **self._header(SUBSCRIBE)))
        return [state for packet in self.receive(timeout) if packet["type"] == NEIGHBOURS for state in packet["states"]]


class Link:
    """A stretch of road: points in driving direction [m]."""

    def __init__(self, name, points, reach):
        self.name, self.points, self.reach = name, points, reach
        self.metres = self.seconds = 0.0

    def place(self, x, y, yaw):
        """Returns the distance [m] along the link of a robot on it, else None."""
        best, start = (self.reach, None), 0.0
        for (ax, ay), (bx, by) in zip(self.points, self.points[1:]):
            length = math.hypot(bx - ax, by - ay)
            along = ((bx - ax) / length, (by - ay) / length)
            s = min(max((x - ax) * along[0] + (y - ay) * along[1], 0.0), length)
            distance = math.hypot(x - ax - s * along[0], y - ay - s * along[1])
            if distance <= best[0] and math.cos(yaw) * along[0] + math.sin(yaw) * along[1] >= 0.5:
                best = distance, start + s
            start += length
        return best[1]

    def add(self, before, state):
        """Adds a robot's way between two states."""
        seconds = (state["time_ns"] - before["time_ns"]) / 1e9
        places = [self.place(packet["pose"][0], packet["pose"][1], packet["pose"][3]) for packet in (before, state)]
        if None not in places and 0 < seconds <= LONGEST_GAP:
            self.metres += places[1] - places[0]
            self.seconds += seconds

    def speed(self):
        """Returns the space-mean speed [m/s] since the last call; None if no robot was on the link."""
        metres, seconds, self.metres, self.seconds = self.metres, self.seconds, 0.0, 0.0
        return metres / seconds if seconds > 0 else None


def link_of(text, reach):
    name, _, numbers = text.rpartition(":")
    values = [float(number) for number in numbers.split(",")]
    points = list(zip(values[::2], values[1::2]))
    if not name or len(values) % 2 or len(points) < 2 or any(a == b for a, b in zip(points, points[1:])):
        raise ValueError("--link expects NAME:x,y,x,y,... with at least two points that differ: " + text)
    return Link(name, points, reach)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--farm", default="127.0.0.1:9000", help="HOST:PORT of `sensorfarm serve`")
    parser.add_argument("--key", type=read_key, metavar="FILE", help="64 hexadecimal digits: sign, and check signatures")
    parser.add_argument("--link", action="append", default=[], metavar="NAME:x,y,x,y,...", help="may be repeated")
    parser.add_argument("--reach", type=float, default=0.5, help="largest distance from a link [m] (0.5)")
    parser.add_argument("--every", type=float, default=1.0, help="time between prints [s] (1)")
    parser.add_argument("--duration", type=float, default=math.inf, help="[s] (until Ctrl-C)")
    options = parser.parse_args()
    try:
        host, _, port = options.farm.rpartition(":")
        centre = Centre((host, int(port)), options.key)
        links = [link_of(text, options.reach) for text in options.link]
    except (ValueError, OSError) as error:
        sys.exit(f"sensorfarm_centre: {error}")
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    newest, end, next_print = {}, time.monotonic() + options.duration, time.monotonic() + options.every
    try:
        while time.monotonic() < end:
            for state in centre.states(min(0.1, max(0.0, end - time.monotonic()))):
                before = newest.get(state["robot"])
                for link in links if before else ():
                    link.add(before, state)
                newest[state["robot"]] = state
            if time.monotonic() < next_print:
                continue
            next_print += options.every
            for robot, state in sorted(newest.items()):
                x, y, _, yaw = state["pose"]
                print(f"robot {robot} x {x:.3f} y {y:.3f} yaw {yaw:.3f} speed {state['velocity'][0]:.3f}")
            for link in links:
                speed = link.speed()
                print(f"link {link.name} " + ("-" if speed is None else f"{speed:.3f} m/s"))
            print(f"{len(newest)} robots; {dict(centre.counts)}", flush=True)
    except KeyboardInterrupt:
        pass
    centre.leave()


if __name__ == "__main__":
    main()
