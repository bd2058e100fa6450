"""Observations, actions and rewards of the robots of a world, in sensorfarm.gym and sensorfarm.pettingzoo."""

import numpy

from . import Simulation
from .spaces import Box

_STANDS_APART = 1.05  # times the sum of two radii


def simulation(world, text, **options):
    """Creates the simulation of a world file, or of a world's text, which `world` then names."""
    return Simulation(world, **options) if text is None else Simulation.from_text(text, world, **options)


class Task:
    """Drive far without contact. Override `observe`, `reward` and `terminated` for your own task.

    A reset of some robots of a world observes them with a second task, which has its own simulation. Therefore
    `observe` may use only `sim` and attributes set by __init__ and `begin`.

    All arrays have one row per agent, those of world 0 first, then of world 1, and so on.

    sim: the Simulation, of one or more worlds; rows: its robots with sensors of this type, which are the agents;
    starts: their poses at the last reset, (agents, 4); seen: the Observations that `observe` returns, of which
    subclasses may make another (Simulation.observe).
    """

    def __init__(self, sim, sensor="laser"):
        self.sim, self.sensor, self.seen = sim, sensor, sim.observe(sensor)
        self.rows = self.seen.rows.astype(int)
        robots = sim.robots
        of_agent = [robots[row % len(robots)] for row in self.rows]
        self.names = [robot.name for robot in of_agent]
        self.limits = numpy.array([[s.limit for s in robot.sensors if s.type == sensor] for robot in of_agent])
        self.speeds = numpy.array([[robot.max_forward, robot.max_turn] for robot in of_agent])  # [m/s], [rad/s]
        self.speeds[~numpy.isfinite(self.speeds)] = 1.0
        self.radii = numpy.array([robot.radius for robot in of_agent])
        self._twists = numpy.zeros((len(sim), 3))
        self.starts = sim.poses[self.rows].copy()
        size = self.observe().shape[1]
        self.observation_space = Box(-1.0, 1.0, (size,), numpy.float32)
        self.action_space = Box(-1.0, 1.0, (2,), numpy.float32)
        self.begin()

    def __len__(self):
        return len(self.rows)

    def observe(self):
        """Returns (agents, n) float32 in [-1, 1]: readings over their limits, then forward and turning speed over
        theirs. The array may change with the next step."""
        return self.seen.values

    def reward(self):
        """Returns (agents,) for the last step: metres driven forward, minus 1 for a contact."""
        return self.sim.velocities[self.rows, 0] * self.sim.interval - self.terminated()

    def terminated(self):
        """Returns (agents,) bool: whether the episode ends here. By default: at a contact."""
        return self.sim.contacts[self.rows]

    def begin(self, worlds=None):
        """Called after each reset of the simulation. worlds: those reset; None: all."""
        if worlds is None:
            self.starts = self.sim.poses[self.rows].copy()
            return
        agents = self.agents_of(worlds)
        self.starts[agents] = self.sim.poses[self.rows[agents]]

    def agents_of(self, worlds):
        """Returns the agents of some worlds."""
        each = len(self) // self.sim.copies
        return (numpy.asarray(worlds)[:, None] * each + numpy.arange(each)).ravel()

    def restart(self, agent, generator):
        """Places one agent at a free start of its world, or at its own start if none is free. Sensors see it from the
        next step on."""
        own = self.agents_of([agent // (len(self) // self.sim.copies)])
        others = own[own != agent]
        starts = self.starts[own]
        starts = starts[starts[:, 2] == self.starts[agent, 2]]
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
