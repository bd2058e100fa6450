"""Env of sensorfarm.gym: one robot."""

import numpy

from .environment import RENDER_MODES, Environment, finite, warn_of
from .task import Task, simulation

try:
    from gymnasium import Env as _Base
except ImportError:
    _Base = object


class Env(Environment, _Base):
    """One robot, the first with sensors of this type, in its own simulation; other robots stay at rest. An episode ends
    when `Task.terminated` returns True, or is truncated after `max_steps`; then call reset.

    robots: clones in the world; 0: the world's own robots. seed: None: episodes differ from run to run until `reset` is
    given a seed. render_mode: None or "rgb_array"; render_size: (width, height) in pixels; render_view: as in
    Simulation.image. For the other arguments see VectorEnv.
    """

    metadata = {"render_modes": RENDER_MODES, "render_fps": 10}
    spec = None
    closed = False
    _spaces = "observation_space", "action_space"

    def __init__(self, world="worlds/cave.world", robots=1, sensor="laser", max_steps=1000, task=Task, seed=None,
                 render_mode=None, render_size=(640, 480), render_view=None, text=None, **options):
        if max_steps < 1:
            raise ValueError(f"max_steps = {max_steps}; expected a positive number")
        seed = self._seed(seed)
        self.simulation = simulation(world, text, robots=robots, seed=seed, **options)
        self.task = task(self.simulation, sensor)
        self.max_steps = max_steps
        self.observation_space, self.action_space = self.task.observation_space, self.task.action_space
        self._set_render(render_mode, render_size, render_view, self.simulation.interval)
        self._fresh, self._age = True, 0
        self._keep([seed])

    def reset(self, *, seed=None, options=None):
        """Begins an episode. seed: for the start and for noise; None: a seed derived from the last one.
        Returns the observation and infos."""
        self._check_open()
        warn_of(options)
        if seed is not None or not self._fresh:
            self._begin([self._next_seed() if seed is None else self._seed(seed)])
        self._fresh, self._age = False, 0
        self._keep(self._seeds)
        return self.task.observe()[0].copy(), self._info()

    def _begin(self, seeds):
        self.simulation.reset(seeds[0])
        self.task.begin()
        self._seeds, self._age = seeds, 0

    def step(self, action):
        """Advances by one tick. action: (2,) in [-1, 1]. Returns observation, reward, terminated, truncated, infos."""
        self._check_open()
        actions = numpy.zeros((len(self.task), 2))
        actions[0] = finite(action, self.action_space.shape)
        self._fresh, self._age = False, self._age + 1
        self.task.step(actions)
        terminated = bool(self.task.terminated()[0])
        truncated = self._age >= self.max_steps and not terminated
        return self.task.observe()[0].copy(), float(self.task.reward()[0]), terminated, truncated, self._info()

    def _info(self):
        return {"pose": self.simulation.poses[self.task.rows[0]].copy()}

    def render(self):
        """Returns (height, width, 3) uint8: the world from above. None without a render_mode."""
        return None if self.render_mode is None else self._frame(self.simulation)

    def close(self):
        """Frees the simulation; its arrays are unchanged."""
        self.simulation, self.task, self.closed = None, None, True
