"""The same way to drive in Python: a class for `run`, a loop (`avoid.py loop`), a client over UDP (`avoid.py PORT`)."""

import sys


def avoid(ranges):
    third = len(ranges) // 3
    return (0.25, 0, 0) if min(ranges[third:-third]) > 0.6 else (0, 0, 1)


class Avoid:
    stops_on_bumper = False

    def __init__(self, robot, settings):
        pass

    def step(self, input):
        return avoid(input.newest("laser").values)


def loop():
    import sensorfarm

    sim = sensorfarm.Simulation("worlds/cave.world", robots=5)
    for _ in range(99):
        sim.step([avoid(ranges) for ranges in sim.readings("laser")])
    print(f"{sim.hash:016x}")


def over_udp(port):
    from sensorfarm_lockstep import Lockstep

    fleet = Lockstep(range(1, 6), ("127.0.0.1", port), ["laser"])
    for _ in range(99):
        fleet.step({id: avoid(fleet.readings[id, "laser", 0].values) for id in fleet.robots})
    fleet.leave()


if __name__ == "__main__":
    loop() if sys.argv[1] == "loop" else over_udp(int(sys.argv[1]))
