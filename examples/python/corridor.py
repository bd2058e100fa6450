#!/usr/bin/env python3
"""A small policy learns to drive around a corridor without contact, in a minute or two on two cores.

    PYTHONPATH=build/release/python examples/python/corridor.py --out out/corridor

Needs only NumPy. The policy is a network of one hidden layer: ranges and speeds in, forward and turning speed out. It is
trained by an evolution strategy with mirrored samples (Salimans et al., "Evolution Strategies as a
Scalable Alternative to Reinforcement Learning", 2017). All candidates drive at once in one world: each on a floor of its
own, at its own height, between walls as high as all floors, so that they neither meet nor see each other.
"""

import argparse
import os
import time

import numpy
import sensorfarm
import sensorfarm.gym

FLOOR = 0.2  # [m] height of a floor
WIDTH = 1.3  # [m] of the corridor
HIDDEN = 8
FAR = 0.04  # [m] per step around the ring; a robot drives 0.05 m


def radius(angle):
    """Returns the radius [m] of the corridor's middle: a ring with five bends."""
    return 4.0 + 0.7 * numpy.sin(5 * angle) + 0.3 * numpy.cos(2 * angle)


def corridor(floors, sides=120):
    """Returns the world as text, with one robot per floor, at places spread over the ring."""
    angles = numpy.linspace(0, 2 * numpy.pi, sides + 1)
    unit = numpy.stack([numpy.cos(angles), numpy.sin(angles)], axis=1)
    middle = radius(angles)[:, None] * unit
    ahead = numpy.gradient(middle, axis=0)
    ahead[0] = ahead[-1] = ahead[0] + ahead[-1]
    left = numpy.stack([-ahead[:, 1], ahead[:, 0]], axis=1) / numpy.hypot(*ahead.T)[:, None]
    top = FLOOR * floors
    text = [f'name "corridor"\ninterval_sim 100\n']
    for name, offset, beyond in (("inner", WIDTH / 2, WIDTH / 2 + 0.1), ("outer", -WIDTH / 2, -WIDTH / 2 - 0.1)):
        near, far = middle + offset * left, middle + beyond * left
        blocks, corners = [], []
        for i in range(sides):
            quad = [near[i], near[i + 1], far[i + 1], far[i]]
            corners += quad
            blocks.append("block( points 4 " + " ".join(f"point[{k}] [{p[0]:.6f} {p[1]:.6f}]" for k, p in enumerate(quad))
                          + f" z [0 {top}] )")
        low, high = numpy.min(corners, axis=0), numpy.max(corners, axis=0)
        centre, size = (low + high) / 2, high - low
        text.append(f'model( name "{name}" color "gray60" pose [{centre[0]} {centre[1]} 0 0] size [{size[0]} {size[1]} {top}]\n'
                    + "\n".join(blocks) + "\n)")
    text.append('define body position ( size [0.3 0.3 0.1] color "cornflower blue" drive "diff" velocity_bounds [-0.5 0.5 0 0 0 0 -90 90]\n'
                '  block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 0.1] )\n'
                '  laser( size [0.05 0.05 0.02] pose [0 0 -0.06 0] samples 15 fov 210 range_max 4 rate 10 ) )')
    for floor in range(floors):
        at = 2 * numpy.pi * floor / floors
        place, then = radius(at) * numpy.array([numpy.cos(at), numpy.sin(at)]), at + 1e-4
        step = radius(then) * numpy.array([numpy.cos(then), numpy.sin(then)]) - place
        yaw = numpy.degrees(numpy.arctan2(step[1], step[0]))
        text.append(f'body( name "r{floor}" pose [{place[0]:.6f} {place[1]:.6f} {FLOOR * floor} {yaw:.6f}] )')
    return "\n".join(text) + "\n"


class Rounds(sensorfarm.gym.Task):
    """Reward: metres around the ring, the angle times the radius of the corridor's middle."""

    def begin(self, worlds=None):
        super().begin(worlds)
        self._angles = self._now()

    def _now(self):
        poses = self.sim.poses[self.rows]
        return numpy.arctan2(poses[:, 1], poses[:, 0])

    def reward(self):
        before, self._angles = self._angles, self._now()
        turned = (self._angles - before + numpy.pi) % (2 * numpy.pi) - numpy.pi
        return turned * radius(self._angles)


def act(policies, observations):
    """Returns the actions (n, 2) of n policies, each with its own observation."""
    inputs = observations.shape[1] + 1
    first = policies[:, :inputs * HIDDEN].reshape(-1, inputs, HIDDEN)
    second = policies[:, inputs * HIDDEN:].reshape(-1, HIDDEN, 2)
    seen = numpy.concatenate([observations, numpy.ones((len(observations), 1))], axis=1)
    hidden = numpy.tanh(numpy.einsum("ni,nih->nh", seen, first))
    return numpy.tanh(numpy.einsum("nh,nha->na", hidden, second))


def episodes(env, policies, steps):
    """Returns each policy's metres until its first contact, and whether it had none."""
    observations, _ = env.reset()
    metres, driving = numpy.zeros(env.num_envs), numpy.ones(env.num_envs, bool)
    for _ in range(steps):
        observations, rewards, terminations, _, _ = env.step(act(policies, observations))
        metres += rewards * driving
        driving &= ~terminations
        if not driving.any():
            break
    return metres, driving


def train(env, generations, steps, seed, say=print):
    """Trains until the policy drives far without contact. Returns the policy and, per generation, best, mean and worst
    metres of its candidates and the share without contact."""
    generator = numpy.random.default_rng(seed)
    size = (env.single_observation_space.shape[0] + 1) * HIDDEN + 2 * HIDDEN
    policy, momentum, curve = numpy.zeros(size), numpy.zeros(size), []
    for generation in range(generations):
        calm = max(0.2, 1.0 - 0.015 * generation)  # steps that become smaller and smaller
        sigma, rate = 0.3 * calm, 0.12 * calm
        half = generator.standard_normal((env.num_envs // 2, size))
        noise = numpy.concatenate([half, -half])
        metres, free = episodes(env, policy + sigma * noise, steps)
        weights = (metres - metres.mean()) / (metres.std() + 1e-9)
        momentum = 0.8 * momentum + weights @ noise / (env.num_envs * 0.3)
        policy = policy + rate * momentum
        curve.append((metres.max(), metres.mean(), metres.min(), free.mean()))
        say(f"generation {generation + 1:3}: {metres.mean():6.2f} m on average, best {metres.max():6.2f} m, "
            f"{100 * free.mean():3.0f} % without contact")
        if generation % 4 == 3:
            metres, free = episodes(env, numpy.tile(policy, (env.num_envs, 1)), steps)
            if free.all() and metres.min() > FAR * steps:
                break  # the policy itself drives far without contact from every start
    return policy, numpy.array(curve)


def draw(curve, file):
    """Draws the learning curve as an SVG file: mean metres per generation, between best and worst."""
    width, height, margin = 720, 360, 56
    top = max(1.0, numpy.ceil(curve[:, 0].max() / 5) * 5)
    low = min(0.0, numpy.floor(curve[:, 2].min() / 5) * 5)
    x = margin + (width - 2 * margin) * numpy.arange(len(curve)) / max(1, len(curve) - 1)

    def y(metres):
        return height - margin - (height - 2 * margin) * (metres - low) / (top - low)

    def points(xs, ys):
        return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(xs, ys))
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">',
             f'<rect width="{width}" height="{height}" fill="white"/>']
    for metres in numpy.arange(low, top + 1, 5):
        parts.append(f'<path d="M{margin} {y(metres):.1f}H{width - margin}" stroke="#ddd"/>'
                     f'<text x="{margin - 8}" y="{y(metres) + 4:.1f}" text-anchor="end">{metres:.0f}</text>')
    for generation in range(0, len(curve), max(1, len(curve) // 10)):
        parts.append(f'<text x="{x[generation]:.1f}" y="{height - margin + 20}" text-anchor="middle">{generation + 1}</text>')
    band = points(numpy.concatenate([x, x[::-1]]), y(numpy.concatenate([curve[:, 0], curve[::-1, 2]])))
    parts += [f'<polygon points="{band}" fill="#0072b2" opacity="0.18"/>',
              f'<polyline points="{points(x, y(curve[:, 1]))}" fill="none" stroke="#0072b2" stroke-width="2"/>',
              f'<text x="{margin}" y="28" font-size="16">Metres round the ring until the first contact: mean of all '
              'candidates, best and worst</text>',
              f'<text x="{width / 2}" y="{height - 12}" text-anchor="middle">generation</text></svg>']
    with open(file, "w") as out:
        out.write("\n".join(parts) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", default="out/corridor", help="folder of the results")
    parser.add_argument("--generations", type=int, default=100, help="at most")
    parser.add_argument("--candidates", type=int, default=64, help="an even number")
    parser.add_argument("--seconds", type=float, default=60, help="longest episode, simulated")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if given.candidates < 2 or given.candidates % 2 or given.generations < 1 or given.seconds < 0.1:
        parser.error("expected an even number of candidates, and at least one generation of 0.1 s")
    os.makedirs(given.out, exist_ok=True)
    world = os.path.join(given.out, "corridor.world")
    with open(world, "w") as out:
        out.write(corridor(given.candidates))
    steps = round(10 * given.seconds)
    env = sensorfarm.gym.VectorEnv(world, num_envs=None, max_steps=steps + 1, task=Rounds, seed=given.seed)
    began = time.time()
    policy, curve = train(env, given.generations, steps, given.seed)
    print(f"trained in {time.time() - began:.0f} s ({time.process_time():.0f} s of all cores) on {env.simulation.description}")
    metres, free = episodes(env, numpy.tile(policy, (env.num_envs, 1)), steps)
    print(f"policy: {metres.mean():.2f} m in {given.seconds:g} s, {free.sum()} of {env.num_envs} starts without contact")
    numpy.save(os.path.join(given.out, "policy.npy"), policy)
    draw(curve, os.path.join(given.out, "learning_curve.svg"))
    env.simulation.draw(os.path.join(given.out, "corridor.png"))


if __name__ == "__main__":
    main()
