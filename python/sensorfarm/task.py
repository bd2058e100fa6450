"""Observations, actions and rewards of the robots of a world, in sensorfarm.gym and sensorfarm.pettingzoo."""

import numpy

from . import Error, Simulation
from .spaces import Box

_STANDS_APART = 1.05  # times the sum of two radii


def simulation(world, text, **options):
    """Creates the simulation of a world file, or of a world's text, which `world` then names."""
    return Simulation(world, **options) if text is None else Simulation.from_text(text, world, **options)


class Task:
    """Drive far without contact. Override `observe`, `reward` and `terminated` for your own task.

    A reset of some robots of a world observes them with a second task, which has its own simulation. Therefore
    `observe` may use only `sim` and attributes set by __init__ and `begin`.

    sim: the Simulation; rows: its robots with sensors of this type, which are the agents; starts: their poses at the
    last reset, (agents, 4).
    """

    def __init__(self, sim, sensor="laser"):
        self.sim, self.sensor = sim, sensor
        owners, counts = numpy.unique(sim.rows(sensor), return_counts=True)
        self.rows = owners.astype(int)
        if len(set(counts)) != 1:
            raise Error(f"robots have {min(counts)} to {max(counts)} sensors of type '{sensor}'; expected the same number")
        robots = sim.robots
        robots = [robots[row] for row in self.rows]
        self.names = [robot.name for robot in robots]
        self.limits = numpy.array([[s.limit for s in robot.sensors if s.type == sensor] for robot in robots])
        self.speeds = numpy.array([[robot.max_forward, robot.max_turn] for robot in robots])  # [m/s], [rad/s]
        self.speeds[~numpy.isfinite(self.speeds)] = 1.0
        self.radii = numpy.array([robot.radius for robot in robots])
        self._twists = numpy.zeros((len(sim), 3))
        size = self.observe().shape[1]
        self.observation_space = Box(-1.0, 1.0, (size,), numpy.float32)
        self.action_space = Box(-1.0, 1.0, (2,), numpy.float32)
        self.begin()

    def __len__(self):
        return len(self.rows)

    def observe(self):
        """Returns (agents, n) float32 in [-1, 1]: readings over their limits, then forward and turning speed over
        theirs."""
        values = self.sim.readings(self.sensor)
        agents, sensors = self.limits.shape
        values = values.reshape(agents, sensors, -1) / self.limits[:, :, None]
        speeds = self.sim.velocities[self.rows][:, [0, 2]] / numpy.maximum(self.speeds, 1e-9)
        seen = numpy.concatenate([values.reshape(agents, -1), speeds], axis=1)
        return numpy.clip(numpy.nan_to_num(seen, nan=1.0), -1.0, 1.0).astype(numpy.float32)

    def reward(self):
        """Returns (agents,) for the last step: metres driven forward, minus 1 for a contact."""
        return self.sim.velocities[self.rows, 0] * self.sim.interval - self.terminated()

    def terminated(self):
        """Returns (agents,) bool: whether the episode ends here. By default: at a contact."""
        return self.sim.contacts[self.rows]

    def begin(self):
        """Called after each reset of the simulation."""
        self.starts = self.sim.poses[self.rows].copy()

    def restart(self, agent, generator):
        """Places one agent at a free start, or at its own start if none is free. Sensors see it from the next step
        on."""
        starts = self.starts[self.starts[:, 2] == self.starts[agent, 2]]
        others = numpy.arange(len(self)) != agent
        poses = self.sim.poses[self.rows[others]]
        others_there = poses[:, 2] == self.starts[agent, 2]
        apart = _STANDS_APART * (self.radii[agent] + self.radii[others])[others_there]
        chosen = self.starts[agent]
        for start in starts[generator.permutation(len(starts))]:
            if (numpy.hypot(*(poses[others_there, :2] - start[:2]).T) > apart).all():
                chosen = start
                break
        self.sim.put(int(self.rows[agent]), chosen)

    def step(self, actions, standing=None):
        """Drives agents with actions in [-1, 1], (agents, 2): forward and turning speed over their limits. Agents in
        the mask `standing` do not move."""
        speeds = numpy.clip(actions, -1.0, 1.0) * self.speeds
        if standing is not None:
            speeds[standing] = 0.0
        self._twists[self.rows, 0], self._twists[self.rows, 2] = speeds[:, 0], speeds[:, 1]
        self.sim.step(self._twists)
