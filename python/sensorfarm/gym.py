"""Gymnasium's vector interface over the robots of one world, or of many worlds side by side.

    env = sensorfarm.gym.VectorEnv("worlds/cave.world", num_envs=64, worlds=4)
    observations, infos = env.reset(seed=1)
    observations, rewards, terminations, truncations, infos = env.step(env.action_space.sample())

Gymnasium is not needed. Where it can be imported, VectorEnv is one of its vector environments, and
`gymnasium.make_vec("sensorfarm.gym:sensorfarm/Drive-v0", num_envs=64, vectorization_mode="vector_entry_point")` makes one.
"""

import numpy

from .spaces import batched
from .task import Task, simulation

try:
    import gymnasium
    from gymnasium.vector import VectorEnv as _Base
except ImportError:
    gymnasium, _Base = None, object

_NEXT_STEP = "NextStep"
if gymnasium is not None and hasattr(gymnasium.vector, "AutoresetMode"):
    _NEXT_STEP = gymnasium.vector.AutoresetMode.NEXT_STEP


class VectorEnv(_Base):
    """Sub-environment i is one robot: worlds one after another, in each its robots by row.

    An episode ends where `Task.terminated` says so, or is truncated after `max_steps`. In the step after that its action
    is ignored, its reward is 0 and its robot stands at a free start (autoreset in the next step). Other robots go on.

    world: a world file, or a name for the world that `text` is. num_envs: robots of all worlds together; None: the world's own robots. worlds: number of
    simulations, with seeds that follow each other. task: a subclass of Task. Further options are those of Simulation.
    """

    metadata = {"render_modes": [], "autoreset_mode": _NEXT_STEP}
    spec = None
    render_mode = None
    closed = False
    _np_random = None
    _np_random_seed = None

    def __init__(self, world="worlds/cave.world", num_envs=16, worlds=1, sensor="laser", max_steps=1000, task=Task,
                 seed=1, render_mode=None, text=None, **options):
        if render_mode is not None:
            raise ValueError(f"render_mode is {render_mode!r}; expected None: show `simulations[0]` instead")
        if worlds < 1 or max_steps < 1 or (num_envs is not None and (num_envs < 1 or num_envs % worlds)):
            raise ValueError(f"num_envs = {num_envs}, worlds = {worlds}, max_steps = {max_steps}; expected positive "
                             "numbers, and as many robots in each world")
        robots = 0 if num_envs is None else num_envs // worlds
        self.simulations = [simulation(world, text, robots=robots, seed=seed + k, **options) for k in range(worlds)]
        self.tasks = [task(sim, sensor) for sim in self.simulations]
        sizes = [len(one) for one in self.tasks]
        ends = numpy.cumsum(sizes)
        self._shares = [slice(end - size, end) for end, size in zip(ends, sizes)]
        self.num_envs, self.max_steps = int(ends[-1]), max_steps
        self.single_observation_space = self.tasks[0].observation_space
        self.single_action_space = self.tasks[0].action_space
        self.observation_space = batched(self.single_observation_space, self.num_envs)
        self.action_space = batched(self.single_action_space, self.num_envs)
        self._seed(seed)
        self._fresh = True  # the simulations have not moved since they were made with `seed`
        self._ended = numpy.zeros(self.num_envs, bool)
        self._ages = numpy.zeros(self.num_envs, int)

    def _seed(self, seed):
        self._np_random_seed, self._np_random = seed, numpy.random.default_rng(seed)

    @property
    def np_random(self):
        return self._np_random

    @property
    def np_random_seed(self):
        return self._np_random_seed

    @property
    def unwrapped(self):
        return self

    def _check_open(self):
        if self.closed:
            raise ValueError("the environment is closed")

    def reset(self, *, seed=None, options=None):
        """Begins all episodes anew. seed: an integer, or one per sub-environment, of which the first of each world
        counts; None: seeds that follow from the last one. The same seed gives the same episodes."""
        self._check_open()
        seeds = seed
        if seed is None and not self._fresh:
            seeds = int(self.np_random.integers(2 ** 31))
        elif seed is not None:
            self._seed(seed if numpy.isscalar(seed) else seed[0])
        if seeds is not None:
            given = not numpy.isscalar(seeds)
            if given and len(seeds) != self.num_envs:
                raise ValueError(f"{len(seeds)} seeds for {self.num_envs} sub-environments; expected as many")
            for k, (one, share) in enumerate(zip(self.tasks, self._shares)):
                own = seeds[share.start] if given else seeds + k
                one.sim.reset(own)
                one.begin()
        self._fresh = False
        self._ended[:] = False
        self._ages[:] = 0
        return self._observations(), self._infos()

    def step(self, actions):
        """One tick of every world. actions: (num_envs, 2) in [-1, 1].
        Returns observations, rewards, terminations, truncations, infos."""
        self._check_open()
        actions = numpy.asarray(actions, dtype=float)
        if actions.shape != self.action_space.shape or not numpy.isfinite(actions).all():
            raise ValueError(f"actions have the shape {actions.shape}; expected finite numbers of shape "
                             f"{self.action_space.shape}")
        self._fresh = False
        begins = self._ended
        rewards = numpy.zeros(self.num_envs)
        terminations = numpy.zeros(self.num_envs, bool)
        for one, share in zip(self.tasks, self._shares):
            for agent in numpy.flatnonzero(begins[share]):
                one.restart(agent, self.np_random)
            one.step(actions[share], begins[share])
            rewards[share], terminations[share] = one.reward(), one.terminated()
        rewards[begins], terminations[begins] = 0.0, False  # whatever the task says of the way to the start
        self._ages = numpy.where(begins, 0, self._ages + 1)
        truncations = (self._ages >= self.max_steps) & ~terminations
        self._ended = terminations | truncations
        return self._observations(), rewards, terminations, truncations, self._infos()

    def _observations(self):
        return numpy.concatenate([one.observe() for one in self.tasks])

    def _infos(self):
        poses = numpy.concatenate([one.sim.poses[one.rows] for one in self.tasks])
        return {"pose": poses, "_pose": numpy.ones(self.num_envs, bool)}

    def render(self):
        """None: `simulations[k].draw(file)` draws, and a notebook shows a simulation as a picture."""

    def close(self, **kwargs):
        """Frees the simulations; their arrays stay as they are."""
        self.simulations, self.tasks, self.closed = [], [], True


if gymnasium is not None:
    gymnasium.register(id="sensorfarm/Drive-v0", vector_entry_point="sensorfarm.gym:VectorEnv")
