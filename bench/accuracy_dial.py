#!/usr/bin/env python3
"""What learners gain by less accurate readings, and lose, on the states that a policy visits.

    script/build release python_package
    PYTHONPATH=build/release/python /usr/bin/python3 bench/accuracy_dial.py [--policy out/rooms/policy.npz]

One simulation per accuracy, of the rooms of examples/python/rooms.py, with the same seeds and the same commands: those
of the policy (default: straight to the goal) by exact readings. All therefore visit the same states, and their readings
are compared with exact ones in double. The simulations take turns, so their rates are compared in one run. A reset of
finished rooms is not timed. `half`: half as many beams, for a policy trained with them. `none`: no laser, the bound for
anything that makes readings cheaper. `field`: ranges traced in a distance field, which the farm does not have.

With --rooms, the policy then drives by each kind of readings, in the same unseen rooms. `double`: observations in 64
bits, as NumPy computes them; the modes observe in 32. `half` reads between the beams of a laser with 18.
"""

import argparse
import os
import sys
import time

import numpy
import sensorfarm

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "examples", "python"))
import rooms  # noqa: E402

CHANGED = 1e-6  # [m] least difference that counts as a changed return
MODES = ("exact", "single", "skip2", "skip4", "skip8")
CELL = 0.05  # [m] of the distance field


class Variant:
    """Rooms with an accuracy, and with that many beams of the laser."""

    def __init__(self, name, accuracy, copies, samples, laser=True):
        with open(rooms.WORLD) as file:
            text = file.read().replace("samples 36", f"samples {samples}")
        text = text if laser else text.replace("laser(", "model( laser_return 0 obstacle_return 0 ) #")
        self.name, self.seconds, self.laser = name, [], laser
        self.worlds = sensorfarm.Worlds(rooms.WORLD, copies, robots=1, seed=1, text=text, accuracy=accuracy)

    def step(self, commands):
        wall, processor = time.perf_counter(), time.process_time()
        self.worlds.step(commands)
        self.seconds.append((time.perf_counter() - wall, time.process_time() - processor))

    def ranges(self):
        return self.worlds.readings("laser")[:, 0]


class Errors:
    """Differences [m] from exact ranges."""

    def __init__(self):
        self.squares, self.count, self.most, self.changed = 0.0, 0, 0.0, 0

    def add(self, ranges, exact):
        error = numpy.abs(ranges - exact)
        self.squares += float((error ** 2).sum())
        self.count += error.size
        self.most = max(self.most, float(error.max()))
        self.changed += int((error > CHANGED).sum())

    def row(self):
        return f"{(self.squares / self.count) ** 0.5:9.2g} | {self.most:9.2g} | {100 * self.changed / self.count:8.3g} %"


def corners_of(part, k):
    """Returns the ends (walls, 2) of the walls of room k: its own, and those of the crates that are there."""
    rows = len(part.robots)
    segments = [[(-4, -4), (4, -4)], [(4, -4), (4, 4)], [(4, 4), (-4, 4)], [(-4, 4), (-4, -4)]]
    for row in range(1, rows):
        if not part.present[k * rows + row]:
            continue
        x, y, _, yaw = part.poses[k * rows + row]
        width, depth = SIZES[part.robots[row].name]
        turn = numpy.array([[numpy.cos(yaw), -numpy.sin(yaw)], [numpy.sin(yaw), numpy.cos(yaw)]])
        box = [turn @ (sx * width / 2, sy * depth / 2) + (x, y) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        segments += [[box[i], box[(i + 1) % 4]] for i in range(4)]
    return numpy.array(segments)


def sizes_of_rooms():
    """Returns the sizes [m] of the objects of rooms.world by name."""
    sizes = {}
    with open(rooms.WORLD) as file:
        for line in file:
            if 'name "crate' in line or 'name "partition' in line:
                name = line.split('name "')[1].split('"')[0]
                numbers = line.split("size [")[1].split("]")[0] if "size [" in line else "1.8 0.1 0.5"
                sizes[name] = tuple(float(n) for n in numbers.split()[:2])
    return sizes


SIZES = sizes_of_rooms()


def field_of(walls):
    """Returns distances [m] to the nearest wall at the middles of cells, as a field in cells would have them."""
    middles = -4 + CELL * (numpy.arange(int(8 / CELL)) + 0.5)
    points = numpy.stack(numpy.meshgrid(middles, middles, indexing="ij"), axis=-1)[:, :, None]
    a, along = walls[:, 0], walls[:, 1] - walls[:, 0]
    part = numpy.clip(((points - a) * along).sum(-1) / (along ** 2).sum(-1), 0, 1)
    return numpy.linalg.norm(points - a - part[..., None] * along, axis=-1).min(axis=2)


def march(fields, poses, bearings, reach):
    """Returns ranges (rooms, beams) by sphere tracing in the fields (rooms, cells, cells), and reads per beam."""
    yaws = (poses[:, 3:] + bearings).ravel()
    directions = numpy.stack([numpy.cos(yaws), numpy.sin(yaws)], axis=1)
    origins, room = numpy.repeat(poses[:, :2], len(bearings), axis=0) + 4, numpy.repeat(numpy.arange(len(poses)), len(bearings))
    ranges, going, reads = numpy.zeros(len(yaws)), numpy.arange(len(yaws)), 0
    for _ in range(200):
        cells = ((origins[going] + ranges[going, None] * directions[going]) / CELL).astype(int).clip(0, fields.shape[1] - 1)
        near = fields[room[going], cells[:, 0], cells[:, 1]]
        reads += len(going)
        going, near = going[near > CELL / 2], near[near > CELL / 2]
        ranges[going] += near
        going = going[ranges[going] < reach]
        if not len(going):
            break
    return numpy.minimum(ranges, reach).reshape(len(poses), -1), reads / len(yaws)


class Fields:
    """Distance fields of the first rooms as they are now."""

    def __init__(self, worlds, count):
        self.part, self.count = worlds.parts[0], count
        self.bearings = numpy.array(worlds.robots[0].sensors[0].bearings)
        self.fields = numpy.stack([field_of(corners_of(self.part, k)).astype(numpy.float32) for k in range(count)])

    def ranges(self):
        return march(self.fields, self.part.poses[::len(self.part.robots)][:self.count], self.bearings, 4.0)


def policy_of(file):
    if file is None:
        return rooms.straight
    with numpy.load(file) as weights:
        weights = dict(weights)
    return lambda seen: rooms.act(weights, seen)


def in_double(driven, ranges=None, bearings=None):
    """Returns the observations in double. ranges [m]: those of a laser with other bearings, read between its beams."""
    worlds, seen = driven.worlds, driven.seen
    robot, pose, velocity = worlds.robots[0], worlds.poses[:, 0], worlds.velocities[:, 0]
    ranges = worlds.readings("laser")[:, 0] if ranges is None else ranges
    if bearings is not None:
        ranges = numpy.array([numpy.interp(robot.sensors[0].bearings, bearings, row) for row in ranges])
    away = seen.goals - pose[:, :2]
    bearing = numpy.arctan2(away[:, 1], away[:, 0]) - pose[:, 3]
    rest = [velocity[:, 0] / robot.max_forward, velocity[:, 2] / robot.max_turn,
            numpy.hypot(away[:, 0], away[:, 1]) / rooms.REACH, numpy.cos(bearing), numpy.sin(bearing)]
    return numpy.clip(numpy.column_stack([ranges / robot.sensors[0].limit, *rest]), -1, 1)


def drive(name, decide, count):
    """Drives an episode in each of `count` unseen rooms by one kind of readings. Returns how they ended."""
    driven = rooms.Rooms(count, rooms.UNSEEN, accuracy=name if name in MODES else "exact")
    if name == "double":
        return rooms.test(lambda _: decide(in_double(driven)), driven)
    if name == "field":
        fields = Fields(driven.worlds, count)
        return rooms.test(lambda _: decide(in_double(driven, fields.ranges()[0])), driven)
    if name == "half":
        bearings = numpy.array(driven.worlds.robots[0].sensors[0].bearings)
        kept = numpy.linspace(bearings[0], bearings[-1], len(bearings) // 2)
        with open(rooms.WORLD) as file:
            text = file.read().replace("samples 36", "samples 18")
        seer = rooms.Rooms(count, rooms.UNSEEN, text=text)
        assert numpy.allclose(seer.worlds.robots[0].sensors[0].bearings, kept)

        def step(_):
            return decide(in_double(driven, seer.worlds.readings("laser")[:, 0], kept))
        return test_beside(step, driven, seer)
    return rooms.test(decide, driven)


def test_beside(decide, driven, seer):
    """rooms.test, with rooms of another laser that do the same."""
    step = driven.worlds.step

    def both(commands):
        step(commands), seer.worlds.step(commands)
    driven.worlds.step = both
    return rooms.test(decide, driven)


def closed_loop(decide, count):
    print(f"ends of an episode in each of {count} unseen rooms, with the limits of 95 % confidence (Wilson)")
    for name in ("double", *MODES, "half", "field"):
        ends = drive(name, decide, count)
        low, high = rooms.wilson(ends[0], count)
        print(f"{name:10} | {100 * ends[0] / count:5.1f} % at the goal ({100 * low:.1f} to {100 * high:.1f} %) | "
              f"{100 * ends[1] / count:5.1f} % contact | {100 * ends[2] / count:5.1f} % late", flush=True)


def run(given):
    driven = rooms.Rooms(given.worlds, 1)
    decide, seen = policy_of(given.policy), driven.seen
    variants = [Variant(name, name, given.worlds, given.beams) for name in MODES]
    variants += [Variant("half", "exact", given.worlds, given.beams // 2),
                 Variant("none", "exact", given.worlds, given.beams, laser=False)]
    errors = {variant.name: Errors() for variant in variants}
    errors["float32"], errors["field"], reads = Errors(), Errors(), []
    limit = driven.worlds.robots[0].sensors[0].limit
    for step in range(given.steps):
        commands = numpy.stack(rooms.twists(decide(seen.values), *driven._speeds), axis=-1)[:, None]
        order = numpy.random.default_rng(step).permutation(len(variants))
        for i in order:
            variants[i].step(commands)
        driven.worlds.step(commands)
        exact, own = variants[0].ranges(), driven.worlds.readings("laser")[:, 0]
        assert (exact[:, [0, -1]] == own[:, [0, -1]]).all(), "the same commands, other readings"
        for variant in variants[:len(MODES)]:
            errors[variant.name].add(variant.ranges(), exact)
        errors["float32"].add(seen.values[:, :own.shape[1]].astype(float) * limit, own)
        if step % 20 == 10:
            ranges, mean = Fields(variants[0].worlds, given.fields).ranges()
            errors["field"].add(ranges, exact[:given.fields])
            reads.append(mean)
        ended = (seen.distances < rooms.ARRIVED) | driven.worlds.contacts[:, 0] | (seen.ages >= rooms.LIMIT)
        if ended.any():
            driven.restart(ended)
            for variant in variants:
                variant.worlds.reset(mask=ended, seeds=driven.worlds.seeds[ended])
    return variants, errors, numpy.mean(reads)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--policy", help="file of rooms.py; default: straight to the goal")
    parser.add_argument("--worlds", type=int, default=1000)
    parser.add_argument("--beams", type=int, default=36, help="of each laser")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--fields", type=int, default=20, help="rooms whose distance field is computed, every 20 steps")
    parser.add_argument("--rooms", type=int, default=0, help="of the closed loop: one episode in each, per accuracy")
    given = parser.parse_args()
    variants, errors, reads = run(given)
    base = numpy.array(variants[0].seconds)
    print(f"{variants[0].worlds.parts[0].description}; {given.worlds} rooms, {given.beams} beams, {given.steps} steps, policy: "
          f"{given.policy or 'straight to the goal'}")
    print("accuracy   | RMS [m]   | most [m]  | changed    | agent steps/s | gain (wall), (processor): medians of steps")
    for name in errors:
        row = f"{name:10} | {errors[name].row() if errors[name].count else ' ' * 34}"
        for variant in variants:
            if variant.name == name:
                own = numpy.array(variant.seconds)
                wall, processor = numpy.median(base / own, axis=0)
                row += f" | {given.worlds / numpy.median(own[:, 0]):13,.0f} | {wall:.2f}, {processor:.2f}"
        print(row)
    print(f"field: cells of {CELL} m, read {reads:.1f} times per beam")
    if given.rooms > 0:
        closed_loop(policy_of(given.policy), given.rooms)


if __name__ == "__main__":
    main()
