"""PettingZoo's parallel interface to the robots of one world.

    env = sensorfarm.pettingzoo.ParallelEnv("worlds/cave.world", robots=8)
    observations, infos = env.reset(seed=1)
    while env.agents:
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)

PettingZoo is optional. If it can be imported, ParallelEnv is one of its environments; if it has a registry (1.27),
importing this module registers "sensorfarm/Drive-v0" for `pettingzoo.make`.
"""

import numpy

from .environment import RENDER_MODES, Environment, finite, warn_of
from .spaces import Box, another
from .task import Task, simulation

try:
    import pettingzoo
    from pettingzoo import ParallelEnv as _Base
except ImportError:
    pettingzoo, _Base = None, object


class ParallelEnv(Environment, _Base):
    """The agents are the robots with sensors of one type, identified by name. An agent whose episode has ended leaves
    `agents`, and its robot stays where it is until the next reset. For the arguments see sensorfarm.gym.VectorEnv;
    robots=0: the world's own robots. state_space: the space of `state`, without bounds."""

    metadata = {"name": "sensorfarm_drive_v0", "render_modes": RENDER_MODES, "render_fps": 10, "is_parallelizable": True}
    spec = None
    closed = False
    _spaces = "observation_spaces", "action_spaces", "state_space"

    def __init__(self, world="worlds/cave.world", robots=0, sensor="laser", max_steps=1000, task=Task, seed=1,
                 render_mode=None, render_size=(640, 480), render_view=None, text=None, **options):
        seed = self._seed(seed)
        self.simulation = simulation(world, text, robots=robots, seed=seed, **options)
        self.task = task(self.simulation, sensor)
        self.possible_agents = list(self.task.names)
        self.agents = []
        self.max_steps = max_steps
        self._index = {name: i for i, name in enumerate(self.possible_agents)}
        self.observation_spaces = {name: another(self.task.observation_space) for name in self.possible_agents}
        self.action_spaces = {name: another(self.task.action_space) for name in self.possible_agents}
        self.state_space = Box(-numpy.inf, numpy.inf, (len(self.simulation), 7), numpy.float64)
        self._set_render(render_mode, render_size, render_view, self.simulation.interval)
        self._fresh, self._age = True, 0
        self._keep([seed])

    @property
    def num_agents(self):
        return len(self.agents)

    @property
    def max_num_agents(self):
        return len(self.possible_agents)

    def observation_space(self, agent):
        return self.observation_spaces[agent]

    def action_space(self, agent):
        return self.action_spaces[agent]

    def reset(self, seed=None, options=None):
        """Returns observations and infos by agent. seed=None: a seed derived from the last one."""
        warn_of(options)
        if seed is not None or not self._fresh:
            self._begin([self._next_seed() if seed is None else self._seed(seed)])
        self._fresh, self._age = False, 0
        self._keep(self._seeds)
        self.agents = list(self.possible_agents)
        return self._by_agent(self.task.observe()), self._infos()

    def _begin(self, seeds):
        self.simulation.reset(seeds[0])
        self.task.begin()
        self._seeds, self._age = seeds, 0
        self.agents = [] if self._fresh else list(self.possible_agents)

    def step(self, actions):
        """actions: by agent, one for each agent in `agents`. Returns observations, rewards, terminations, truncations
        and infos of these agents."""
        if set(actions) != set(self.agents):
            raise ValueError(f"actions of {sorted(actions)}; expected those of {sorted(self.agents)}")
        if not self.agents:
            return {}, {}, {}, {}, {}
        all_actions = numpy.zeros((self.max_num_agents, 2))
        for agent, action in actions.items():
            all_actions[self._index[agent]] = finite(action, (2,))
        self.task.step(all_actions)
        self._fresh, self._age = False, self._age + 1
        ended = self.task.terminated()
        late = numpy.full(len(ended), self._age >= self.max_steps) & ~ended
        answer = (self._by_agent(self.task.observe()), self._by_agent(self.task.reward(), float),
                  self._by_agent(ended, bool), self._by_agent(late, bool), self._infos())
        self.agents = [agent for agent in self.agents if not (ended | late)[self._index[agent]]]
        return answer

    def _by_agent(self, rows, kind=lambda row: row):
        rows = numpy.array(rows)  # those of observations change with the next step
        return {agent: kind(rows[self._index[agent]]) for agent in self.agents}

    def _infos(self):
        return {agent: {} for agent in self.agents}

    def state(self):
        """Returns (robots, 7): poses, then velocities, of all robots."""
        return numpy.concatenate([self.simulation.poses, self.simulation.velocities], axis=1)

    def render(self):
        """Returns (height, width, 3) uint8: the world from above. None without a render_mode."""
        return None if self.render_mode is None else self._frame(self.simulation)

    def close(self):
        """Ends all episodes."""
        self.agents = []


if hasattr(pettingzoo, "register"):
    pettingzoo.register("parallel", "sensorfarm/Drive-v0", "sensorfarm.pettingzoo:ParallelEnv")
