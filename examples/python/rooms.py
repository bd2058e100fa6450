#!/usr/bin/env python3
"""A policy learns by PPO to drive through random rooms to a goal: 1 000 worlds at once, in minutes on two cores.

    PYTHONPATH=build/release/python /usr/bin/python3 examples/python/rooms.py --out out/rooms
    sensorfarm run examples/python/rooms.world --robots 1 --controller examples/python/rooms.py:Drive --view

Learning needs PyTorch (python3-torch of Debian is enough); testing and driving need only NumPy. A robot in each
world drives to a goal. It sees 36 ranges up to 4 m, its speeds, and the goal's distance and bearing. An episode ends at
the goal, at a contact or after 20 s; the next one has another seed, and so other places of crates, partitions, robot and
goal. The algorithm is that of Schulman et al., "Proximal Policy Optimization Algorithms" (2017), with generalised
advantages.
"""

import argparse
import os
import time

os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")  # PyTorch's threads that wait leave the cores to the simulation
import numpy  # noqa: E402

WORLD = os.path.join(os.path.dirname(os.path.abspath(__file__)), "rooms.world")
REACH = 8.0  # [m] a goal at this distance or farther is observed as 1
ARRIVED = 0.3  # [m]
LIMIT = 200  # steps of an episode, 0.1 s each
GOALS = numpy.random.default_rng(38).uniform(-3.4, 3.4, (4096, 2))  # [m] from which those of all rooms are chosen
UNSEEN = 1_000_000_000  # first seed of the rooms of the test


class Rooms:
    """A number of rooms, each with a robot and its goal. `seen.values` has the observations (rooms, columns)."""

    def __init__(self, copies, seed, **options):
        import sensorfarm
        self.worlds = sensorfarm.Worlds(WORLD, copies=copies, robots=1, seed=seed, **options)
        self.seen, = self.worlds.observe(goal_reach=REACH)
        robot = self.worlds.robots[0]
        self._speeds = robot.max_forward, robot.max_turn
        self._choose_goals(numpy.arange(copies))

    def _choose_goals(self, rooms):
        """Chooses the first of 64 places that is 0.45 m from all crates and 3 m from the start, or else the clearest."""
        part = self.worlds.parts[0]
        poses = part.poses.reshape(len(self.worlds), -1, 4)[rooms, :, :2]
        present = part.present.reshape(len(self.worlds), -1)[rooms, 1:]
        radii = numpy.array([crate.radius for crate in part.robots[1:poses.shape[1]]])
        places = GOALS[(self.worlds.seeds[rooms, None] * 977 + numpy.arange(64)) % len(GOALS)]
        away = numpy.linalg.norm(places[:, :, None] - poses[:, None], axis=3)  # (rooms, places, robot and crates)
        clear = numpy.where(present[:, None], away[:, :, 1:] - radii, numpy.inf).min(axis=2)
        good = (clear > 0.45) & (away[:, :, 0] > 3.0)
        chosen = numpy.where(good.any(axis=1), good.argmax(axis=1), clear.argmax(axis=1))
        self.seen.goals[rooms] = places[numpy.arange(len(rooms)), chosen]
        self.seen.update()

    def drive(self, actions):
        """Returns rewards, and which episodes ended at the goal, at a contact and by the limit of steps."""
        self.worlds.step(numpy.stack(twists(actions, *self._speeds), axis=-1)[:, None])
        arrived = self.seen.distances < ARRIVED
        contact = self.worlds.contacts[:, 0] & ~arrived
        late = (self.seen.ages >= LIMIT) & ~arrived & ~contact
        return self.seen.progress + 3.0 * arrived - 5.0 * contact, arrived, contact, late

    def restart(self, ended):
        if ended.any():
            self.worlds.reset(mask=ended)
            self._choose_goals(numpy.flatnonzero(ended))


def twists(actions, max_forward, max_turn):
    """Returns forward, left [m/s] and turn [rad/s] of actions (..., 2) in [-1, 1]: standing to full speed, right to
    left."""
    forward = max_forward * (1.0 + actions[..., 0]) / 2.0
    return forward, 0.0 * forward, max_turn * actions[..., 1]


def act(weights, seen):
    """Returns the actions (..., 2) of a policy: tanh of a network of two hidden layers."""
    for k in range(3):
        seen = numpy.tanh(seen @ weights[f"w{k}"].T + weights[f"b{k}"])
    return seen


def straight(seen):
    """Returns the actions of the baseline, which turns to the goal and drives there."""
    bearing = numpy.arctan2(seen[..., -1], seen[..., -2])
    forward = 2.0 * numpy.maximum(numpy.cos(bearing), 0.0) - 1.0
    return numpy.stack([forward, numpy.clip(2.0 * bearing, -1.0, 1.0)], axis=-1)


class Drive:
    """The policy as a controller, which visits goals in turn. Settings: policy, a file; goals, x and y [m] of each."""
    rate = 10  # [Hz]
    stops_on_bumper = False

    def __init__(self, robot, settings):
        self.limits = robot.max_forward, robot.max_turn
        self.range = robot.sensors[0].limit
        with numpy.load(settings.text("policy", "out/rooms/policy.npz")) as file:
            self.weights = dict(file)
        self.goals = numpy.reshape(settings.numbers("goals", [3.3, 3.3, -3.3, -3.3, -3.3, 3.3, 3.3, -3.3]), (-1, 2))
        self.steps = 0

    def step(self, input):
        x, y = self.goals[0] - input.pose[:2]
        self.steps += 1
        if numpy.hypot(x, y) < ARRIVED or self.steps > LIMIT:
            self.goals, self.steps = numpy.roll(self.goals, -1, axis=0), 0
            x, y = self.goals[0] - input.pose[:2]
        bearing = numpy.arctan2(y, x) - input.pose.yaw
        seen = numpy.concatenate([input.newest("laser").values / self.range,
                                  [input.velocity.forward / self.limits[0], input.velocity.turn / self.limits[1],
                                   numpy.hypot(x, y) / REACH, numpy.cos(bearing), numpy.sin(bearing)]])
        return tuple(float(speed) for speed in twists(act(self.weights, numpy.clip(seen, -1, 1)), *self.limits))


def test(decide, rooms):
    """Drives one episode in each room. Returns how many ended at the goal, at a contact and by the limit of steps."""
    counts, open = numpy.zeros(3, int), numpy.ones(len(rooms.worlds), bool)
    while open.any():
        _, *ends = rooms.drive(decide(rooms.seen.values))
        counts += [(end & open).sum() for end in ends]
        open &= ~numpy.any(ends, axis=0)
    return counts


def wilson(hits, trials, z=1.96):
    """Returns the limits of the 95 % confidence interval (Wilson) of a probability."""
    middle, spread = hits + z * z / 2, z * numpy.sqrt(hits * (trials - hits) / trials + z * z / 4)
    return (middle - spread) / (trials + z * z), (middle + spread) / (trials + z * z)


# Learning ----------------------------------------------------------------------------------------------------------


def import_torch():
    try:
        import torch
    except ImportError:
        raise SystemExit("Learning needs PyTorch: apt install python3-torch, and run /usr/bin/python3") from None
    torch.set_num_threads(2)
    return torch


class Learner:
    """PPO: a network that acts, one that values, and their optimiser."""

    def __init__(self, torch, columns, seed, rate=1e-3, discount=0.99, trace=0.95, clip=0.2, epochs=4, batches=4):
        torch.manual_seed(seed)
        self.torch, self.discount, self.trace, self.clip = torch, discount, trace, clip
        self.epochs, self.batches, self.rate = epochs, batches, rate
        self.simulated = 0.0  # [s] spent in the simulation
        self.actor, self.critic = self._network(columns, 2, 0.01), self._network(columns, 1, 1.0)
        self.log_sigma = torch.nn.Parameter(torch.full((2,), -0.5))
        self.parameters = [*self.actor.parameters(), *self.critic.parameters(), self.log_sigma]
        self.optimizer = torch.optim.Adam(self.parameters, lr=rate, eps=1e-5)

    def _network(self, columns, outputs, gain):
        nn = self.torch.nn
        layers = [nn.Linear(columns, 64), nn.Linear(64, 64), nn.Linear(64, outputs)]
        for layer, scale in zip(layers, (2 ** 0.5, 2 ** 0.5, gain)):
            nn.init.orthogonal_(layer.weight, scale)
            nn.init.zeros_(layer.bias)
        return nn.Sequential(layers[0], nn.Tanh(), layers[1], nn.Tanh(), layers[2])

    def weights(self):
        """Returns the arrays of the network that acts."""
        return {name + str(k): getattr(self.actor[2 * k], long).detach().numpy().copy()
                for k in range(3) for name, long in (("w", "weight"), ("b", "bias"))}

    def densities(self, seen):
        return self.torch.distributions.Normal(self.actor(seen), self.log_sigma.exp())

    def collect(self, rooms, steps):
        """Drives all rooms for some steps. Returns the columns of what happened, and how the episodes ended."""
        torch = self.torch
        made, ended_as = [], numpy.zeros(3, int)
        for _ in range(steps):
            seen = torch.tensor(rooms.seen.values)
            density, value = self.densities(seen), self.critic(seen)[:, 0]
            action = density.sample()
            began = time.perf_counter()
            reward, *ends = rooms.drive(torch.tanh(action).numpy())
            self.simulated += time.perf_counter() - began
            late = numpy.flatnonzero(ends[2])
            if len(late):  # bootstrap truncated episodes from the critic
                reward[late] += self.discount * self.critic(torch.tensor(rooms.seen.values[late]))[:, 0].numpy()
            ended = numpy.any(ends, axis=0)
            ended_as += [end.sum() for end in ends]
            made.append((seen, action, density.log_prob(action).sum(1), value, torch.tensor(reward).float(),
                         torch.tensor(ended).float()))
            began = time.perf_counter()
            rooms.restart(ended)
            self.simulated += time.perf_counter() - began
        return [torch.stack(column) for column in zip(*made)], ended_as

    def advantages(self, values, rewards, ended, last):
        """Returns the generalised advantages (steps, rooms); `last`: the values after the last step."""
        result, gained, following = self.torch.zeros_like(values), 0.0, last
        for t in reversed(range(len(values))):
            goes_on = 1.0 - ended[t]
            surprise = rewards[t] + self.discount * following * goes_on - values[t]
            gained = surprise + self.discount * self.trace * goes_on * gained
            result[t], following = gained, values[t]
        return result

    def loss(self, seen, actions, before, gains, targets):
        density = self.densities(seen)
        ratio = (density.log_prob(actions).sum(1) - before).exp()
        clipped = ratio.clamp(1.0 - self.clip, 1.0 + self.clip)
        gains = (gains - gains.mean()) / (gains.std() + 1e-8)
        errors = self.critic(seen)[:, 0] - targets
        return (0.5 * errors.square().mean() - self.torch.min(ratio * gains, clipped * gains).mean()
                - 0.001 * density.entropy().sum(1).mean())

    def update(self, rooms, steps, left):
        """Collects and learns once; left: the part of the training that is left. Returns the episodes' ends."""
        with self.torch.no_grad():
            (seen, actions, before, values, rewards, ended), ends = self.collect(rooms, steps)
            gains = self.advantages(values, rewards, ended, self.critic(self.torch.tensor(rooms.seen.values))[:, 0])
        data = [column.flatten(0, 1) for column in (seen, actions, before, gains, gains + values)]
        for group in self.optimizer.param_groups:
            group["lr"] = self.rate * left
        for _ in range(self.epochs):
            for batch in self.torch.randperm(len(data[0])).chunk(self.batches):
                self.optimizer.zero_grad()
                self.loss(*(column[batch] for column in data)).backward()
                self.torch.nn.utils.clip_grad_norm_(self.parameters, 0.5)
                self.optimizer.step()
        return ends


def train(rooms, updates, steps, seed):
    """Returns the weights of the policy, and per update: agent steps, seconds, and shares of episodes that ended at the
    goal, at a contact and by the limit of steps. Ctrl-C ends the training early."""
    learner, began, curve = Learner(import_torch(), rooms.seen.values.shape[1], seed), time.perf_counter(), []
    for update in range(updates):
        try:
            ends = learner.update(rooms, steps, 1.0 - update / updates)
        except KeyboardInterrupt:
            if not curve:
                raise
            break
        seconds, agent_steps = time.perf_counter() - began, (update + 1) * steps * len(rooms.worlds)
        curve.append((agent_steps, seconds, *(ends / max(1, ends.sum()))))
        print(f"update {update + 1:3}: {agent_steps / 1e6:5.2f} million steps, {seconds:4.0f} s, {ends.sum():5} episodes: "
              f"{100 * curve[-1][2]:5.1f} % at the goal, {100 * curve[-1][3]:5.1f} % at a contact", flush=True)
    print(f"trained in {seconds:.0f} s ({time.process_time():.0f} s of all cores): agent steps per second "
          f"{agent_steps / learner.simulated:.0f} of simulation, "
          f"{agent_steps / (seconds - learner.simulated):.0f} of the rest, {agent_steps / seconds:.0f} of both")
    return learner.weights(), numpy.array(curve)


def draw(curve, file):
    """Draws the learning curve as an SVG file: shares of the episodes of each update, over agent steps."""
    width, height, margin, most = 720, 360, 56, curve[-1, 0] / 1e6
    x, y = margin + (width - 2 * margin) * curve[:, 0] / 1e6 / most, height - margin - (height - 2 * margin) * curve[:, 2:]
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">',
             f'<rect width="{width}" height="{height}" fill="white"/>',
             f'<text x="{margin}" y="28" font-size="16">Ends of the episodes of each update, {curve[-1, 1]:.0f} s in all</text>',
             f'<text x="{width / 2}" y="{height - 12}" text-anchor="middle">million steps of all robots</text>']
    for k in range(5):
        level, at = height - margin - (height - 2 * margin) * k / 4, margin + (width - 2 * margin) * k / 4
        parts.append(f'<path d="M{margin} {level}H{width - margin}" stroke="#ddd"/>'
                     f'<text x="{margin - 8}" y="{level + 4}" text-anchor="end">{25 * k} %</text>'
                     f'<text x="{at}" y="{height - margin + 20}" text-anchor="middle">{most * k / 4:.3g}</text>')
    for k, (name, color) in enumerate((("goal", "#0072b2"), ("contact", "#d55e00"), ("20 s", "#009e73"))):
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y[:, k]))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="2"/>'
                     f'<text x="{width - margin + 6}" y="{y[-1, k] + 4 + 12 * (k == 2):.1f}" fill="{color}">{name}</text>')
    with open(file, "w") as out:
        out.write("\n".join(parts) + "\n</svg>\n")


def report(name, decide, copies):
    ends = test(decide, Rooms(copies, UNSEEN))
    low, high = wilson(ends[0], copies)
    print(f"{name}: at the goal in {ends[0]} of {copies} unseen rooms (with 95 % confidence {100 * low:.1f} to "
          f"{100 * high:.1f} %), {ends[1]} contacts, {ends[2]} late")


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--train", action="store_true", help="only train")
    parser.add_argument("--test", action="store_true", help="only test the policy of --out")
    parser.add_argument("--out", default="out/rooms", help="folder of the policy and its learning curve")
    parser.add_argument("--worlds", type=int, default=1000)
    parser.add_argument("--updates", type=int, default=250)
    parser.add_argument("--steps", type=int, default=32, help="of each world per update")
    parser.add_argument("--rooms", type=int, default=1000, help="of the test")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if min(given.worlds, given.updates, given.steps, given.rooms) < 1:
        parser.error("expected at least one world, update, step and room")
    if given.seed < 0:
        parser.error(f"argument --seed: {given.seed} is negative; expected a whole number from 0 on")
    return given


def main():
    given = options()
    os.makedirs(given.out, exist_ok=True)
    policy = os.path.join(given.out, "policy.npz")
    if given.train or not given.test:
        weights, curve = train(Rooms(given.worlds, given.seed), given.updates, given.steps, given.seed)
        numpy.savez(policy, **weights)
        numpy.savetxt(os.path.join(given.out, "learning_curve.csv"), curve, "%.6g", ",",
                      header="agent_steps,seconds,at_goal,at_contact,late", comments="")
        draw(curve, os.path.join(given.out, "learning_curve.svg"))
    if given.test or not given.train:
        with numpy.load(policy) as file:
            weights = dict(file)
        report("policy", lambda seen: act(weights, seen), given.rooms)
        report("straight to the goal", straight, given.rooms)


if __name__ == "__main__":
    main()
