"""PettingZoo's parallel interface over the robots of one world.

    env = sensorfarm.pettingzoo.ParallelEnv("worlds/cave.world", robots=8)
    observations, infos = env.reset(seed=1)
    while env.agents:
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)

PettingZoo is not needed. Where it can be imported, ParallelEnv is one of its environments.
"""

import numpy

from .task import Task, simulation

try:
    from pettingzoo import ParallelEnv as _Base
except ImportError:
    _Base = object


class ParallelEnv(_Base):
    """Agents are the robots with sensors of one type, by name. One that has ended leaves `agents`, and its robot stands
    where it is until the next reset. Arguments as of sensorfarm.gym.VectorEnv; robots = 0: the world's own."""

    metadata = {"name": "sensorfarm_drive_v0", "render_modes": [], "is_parallelizable": True}
    render_mode = None

    def __init__(self, world="worlds/cave.world", robots=0, sensor="laser", max_steps=1000, task=Task, seed=1, text=None,
                 **options):
        self.simulation = simulation(world, text, robots=robots, seed=seed, **options)
        self.task = task(self.simulation, sensor)
        self.possible_agents = list(self.task.names)
        self.agents = []
        self.max_steps = max_steps
        self._index = {name: i for i, name in enumerate(self.possible_agents)}
        self._random = numpy.random.default_rng(seed)
        self._fresh, self._age = True, 0
        self.observation_spaces = {name: self.task.observation_space for name in self.possible_agents}
        self.action_spaces = {name: self.task.action_space for name in self.possible_agents}

    @property
    def num_agents(self):
        return len(self.agents)

    @property
    def max_num_agents(self):
        return len(self.possible_agents)

    @property
    def unwrapped(self):
        return self

    def observation_space(self, agent):
        return self.observation_spaces[agent]

    def action_space(self, agent):
        return self.action_spaces[agent]

    def reset(self, seed=None, options=None):
        """Returns observations and infos by agent. None: a seed that follows from the last one."""
        if seed is not None:
            self._random = numpy.random.default_rng(seed)
        if seed is not None or not self._fresh:
            self.simulation.reset(int(self._random.integers(2 ** 31)) if seed is None else seed)
            self.task.begin()
        self._fresh, self._age = False, 0
        self.agents = list(self.possible_agents)
        return self._by_agent(self.task.observe()), self._infos()

    def step(self, actions):
        """actions: by agent, of all in `agents`. Returns observations, rewards, terminations, truncations and infos of
        these agents."""
        if set(actions) != set(self.agents):
            raise ValueError(f"actions of {sorted(actions)}; expected those of {sorted(self.agents)}")
        if not self.agents:
            return {}, {}, {}, {}, {}
        all_actions = numpy.zeros((self.max_num_agents, 2))
        for agent, action in actions.items():
            all_actions[self._index[agent]] = action
        self.task.step(all_actions)
        self._fresh, self._age = False, self._age + 1
        ended = self.task.terminated()
        late = numpy.full(len(ended), self._age >= self.max_steps) & ~ended
        answer = (self._by_agent(self.task.observe()), self._by_agent(self.task.reward(), float),
                  self._by_agent(ended, bool), self._by_agent(late, bool), self._infos())
        self.agents = [agent for agent in self.agents if not (ended | late)[self._index[agent]]]
        return answer

    def _by_agent(self, rows, kind=lambda row: row):
        return {agent: kind(rows[self._index[agent]]) for agent in self.agents}

    def _infos(self):
        return {agent: {} for agent in self.agents}

    def state(self):
        """(robots, 7): poses, then velocities, of all robots."""
        return numpy.concatenate([self.simulation.poses, self.simulation.velocities], axis=1)

    def render(self):
        """None: `simulation.draw(file)` draws."""

    def close(self):
        """Ends all episodes."""
        self.agents = []
