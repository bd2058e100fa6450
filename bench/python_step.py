#!/usr/bin/env python3
"""Cost of Python: compares a step from Python with one from C++, and the farm with ray casting in NumPy.

    script/build bench library_step python_package
    PYTHONPATH=build/bench/python /usr/bin/python3 bench/python_step.py --program build/bench/library_step

Methods run in turns; hashes and ranges of both are compared.
"""

import argparse
import os
import subprocess
import tempfile
import time

import numpy
import sensorfarm

BEAMS, RANGE, SIDE = 181, 8.0, 40.0


def drive(sim, twists):
    near = sim.readings("laser").min(axis=1) < 0.5
    twists[:, 0], twists[:, 2] = numpy.where(near, 0, 0.3), numpy.where(near, 0.8, 0)


def steps_in_python(sim, steps):
    """Returns the seconds per step, with its readings and poses, in wall and CPU time of all threads, and the hash."""
    sim.reset(1)
    twists, spent, cpu = numpy.zeros((len(sim), 3)), 0.0, 0.0
    for _ in range(steps):
        drive(sim, twists)
        cpu_start, start = time.process_time(), time.perf_counter()
        sim.step(twists)
        sim.readings("laser"), sim.poses, sim.contacts
        spent += time.perf_counter() - start
        cpu += time.process_time() - cpu_start
    return (spent / steps, cpu / steps), sim.hash


def overhead(program, world, robots, steps, rounds):
    sim = sensorfarm.Simulation(world, robots=robots)
    other = subprocess.Popen([program, world, str(robots), str(steps)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    mine, theirs = [], []
    for _ in range(rounds):
        other.stdin.write("\n")
        other.stdin.flush()
        *seconds, code = other.stdout.readline().split()
        own, own_code = steps_in_python(sim, steps)
        assert int(code, 16) == own_code, "C++ and Python differ"
        mine.append(own), theirs.append([float(s) for s in seconds])
    other.stdin.close()
    other.wait()
    print(f"{robots} robots, {steps} steps, {rounds} rounds in turns:")
    for k, clock in enumerate(("wall clock", "time of all threads")):
        python, cpp = numpy.array(mine)[:, k], numpy.array(theirs)[:, k]
        print(f"  {clock}: {1e3 * cpp.min():.3f} ms a step in C++, {1e3 * python.min():.3f} ms in Python (least); ratio "
              f"{python.min() / cpp.min():.3f} of the least, {numpy.median(python / cpp):.3f} median of rounds")


def resident():
    """[bytes] of this process."""
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def many(program, world, worlds, robots, steps, rounds):
    """Agent steps per second of many worlds, in Python and in C++, in turns. Checks the hash of one world."""
    before, start = resident(), time.perf_counter()
    all_worlds = sensorfarm.Worlds(world, worlds, robots=robots, noise=False)
    made, memory = time.perf_counter() - start, resident() - before
    other = subprocess.Popen([program, world, str(robots), str(steps), str(worlds)], stdin=subprocess.PIPE,
                             stdout=subprocess.PIPE, text=True)
    twists, agents, mine, theirs = numpy.zeros((worlds, robots, 3)), worlds * robots, [], []
    for _ in range(rounds):
        other.stdin.write("\n")
        other.stdin.flush()
        theirs.append(float(other.stdout.readline().split()[0]))
        all_worlds.reset(seed=1)
        spent = 0.0
        for _ in range(steps):
            near = all_worlds.readings("laser").min(axis=2) < 0.5
            twists[..., 0], twists[..., 2] = numpy.where(near, 0, 0.3), numpy.where(near, 0.8, 0)
            start = time.perf_counter()
            all_worlds.step(twists)
            spent += time.perf_counter() - start
        mine.append(spent / steps)
    other.stdin.close()
    other.wait()
    k = worlds - 1
    alone = sensorfarm.Simulation(world, robots=robots, noise=False, seed=1 + k)
    drive_alone = numpy.zeros((robots, 3))
    for _ in range(steps):
        drive(alone, drive_alone)
        alone.step(drive_alone)
    assert all_worlds.hash(k) == alone.hash, "a world differs from that world alone"
    print(f"{worlds} worlds of {robots} robots: created in {made:.2f} s, {memory / worlds / 1024:.0f} KiB a world; "
          f"{agents / min(mine):,.0f} agent steps/s from Python, {agents / min(theirs):,.0f} from C++; "
          f"{1e9 * min(mine) / agents / BEAMS:.1f} ns a beam, with motion and contacts")


def views(world):
    sim, least = sensorfarm.Simulation(world, robots=1000), float("inf")
    for _ in range(1000):
        start = time.perf_counter()
        sim.readings("laser"), sim.poses, sim.contacts
        least = min(least, time.perf_counter() - start)
    print(f"views of readings, poses and contacts: {1e6 * least:.1f} us")


def boxes(count, generator):
    """Corners (count, 4, 2) of boxes in a square of SIDE metres, and of the square itself."""
    centres = generator.uniform(-SIDE / 2, SIDE / 2, (count, 2))
    angles, sizes = generator.uniform(0, numpy.pi, count), generator.uniform(0.2, 1.0, (count, 2))
    unit = numpy.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    turn = numpy.stack([numpy.stack([numpy.cos(angles), -numpy.sin(angles)], 1),
                        numpy.stack([numpy.sin(angles), numpy.cos(angles)], 1)], 1)
    corners = numpy.einsum("nij,nkj->nki", turn, unit * sizes[:, None]) + centres[:, None]
    wall = SIDE / 2 + 0.5
    around = [[[-wall, y - 0.1], [wall, y - 0.1], [wall, y + 0.1], [-wall, y + 0.1]] for y in (-wall, wall)]
    around += [[[x - 0.1, -wall], [x + 0.1, -wall], [x + 0.1, wall], [x - 0.1, wall]] for x in (-wall, wall)]
    return centres, angles, sizes, numpy.concatenate([corners, around])


def world_of(centres, angles, sizes):
    wall = SIDE / 2 + 0.5
    text = ["interval_sim 100", "define box model( size [1 1 1] )"]
    text += [f"box( pose [{x!r} {y!r} 0 {numpy.degrees(a)!r}] size [{w!r} {h!r} 1] )"
             for (x, y), a, (w, h) in zip(centres.tolist(), angles.tolist(), sizes.tolist())]
    text += [f"box( pose [0 {y} 0 0] size [{2 * wall} 0.2 1] )" for y in (-wall, wall)]
    text += [f"box( pose [{x} 0 0 0] size [0.2 {2 * wall} 1] )" for x in (-wall, wall)]
    text.append('position( name "r" size [0.3 0.3 0.1] drive "diff" laser_return 0 pose [0 0 0 0] '
                'block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 0.1] ) '
                f'laser( size [0.01 0.01 0.01] laser_return 0 pose [0 0 -0.05 0] samples {BEAMS} fov 180 range_max {RANGE} rate 10 ) )')
    return "\n".join(text) + "\n"


def cast(poses, starts, edges, bearings):
    """Returns ranges (robots, beams): tests each beam of a robot against each wall near it."""
    ranges = numpy.full((len(poses), len(bearings)), RANGE)
    middles, reach = starts + 0.5 * edges, 0.5 * numpy.hypot(*edges.T)
    for i, (x, y, _, yaw) in enumerate(poses):
        near = numpy.hypot(*(middles - (x, y)).T) <= RANGE + reach
        to, along = starts[near] - (x, y), edges[near]
        beams = numpy.stack([numpy.cos(yaw + bearings), numpy.sin(yaw + bearings)], axis=1)
        with numpy.errstate(divide="ignore", invalid="ignore"):
            slope = numpy.outer(beams[:, 0], along[:, 1]) - numpy.outer(beams[:, 1], along[:, 0])
            far = (to[:, 0] * along[:, 1] - to[:, 1] * along[:, 0]) / slope
            part = (numpy.outer(beams[:, 1], to[:, 0]) - numpy.outer(beams[:, 0], to[:, 1])) / slope
        far[~((far >= 0) & (part >= 0) & (part <= 1))] = RANGE
        ranges[i] = numpy.minimum(far.min(axis=1, initial=RANGE), RANGE)
    return ranges


def beside_numpy(robots, steps, rounds):
    centres, angles, sizes, corners = boxes(260, numpy.random.default_rng(1))
    starts = corners.reshape(-1, 2)
    edges = (numpy.roll(corners, -1, axis=1) - corners).reshape(-1, 2)
    sim = sensorfarm.Simulation.from_text(world_of(centres, angles, sizes), robots=robots, noise=False)
    bearings = numpy.array(sim.robots[0].sensors[0].bearings)
    twists, worst, farm, plain = numpy.zeros((robots, 3)), 0.0, [], []
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(steps):
            drive(sim, twists)
            sim.step(twists)
        farm.append((time.perf_counter() - start) / steps)
        start = time.perf_counter()
        ranges = cast(sim.poses, starts, edges, bearings)
        plain.append(time.perf_counter() - start)
        error = numpy.abs(ranges - sim.readings("laser"))
        worst = max(worst, float(numpy.quantile(error, 0.9999)))
        differ = (error > 1e-6).sum()
    print(f"{robots} robots, {BEAMS} beams, {len(starts)} walls: farm {robots / min(farm):,.0f} agent-steps/s with motion and "
          f"contacts, NumPy {robots / min(plain):,.0f} with ray casting alone; factor {min(plain) / min(farm):.0f}; "
          f"ranges differ by {worst:.1e} m (99.99 %), {differ} of {ranges.size} by more than 1e-6 m")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True, help="library_step of the same build")
    parser.add_argument("--rounds", type=int, default=15)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        world = os.path.join(folder, "boxes.world")
        with open(world, "w") as out:
            out.write(world_of(*boxes(260, numpy.random.default_rng(1))[:3]))
        print(sensorfarm.Simulation(world).description)
        for robots, steps in ((1000, 20), (50, 200)):
            overhead(given.program, world, robots, steps, given.rounds)
        views(world)
        for worlds, robots in ((1, 1000), (50, 20), (1000, 1)):
            many(given.program, world, worlds, robots, 50, given.rounds)
    for robots in (10, 100, 1000):
        beside_numpy(robots, max(2, 1000 // robots), 5 if robots < 1000 else 3)


if __name__ == "__main__":
    main()
