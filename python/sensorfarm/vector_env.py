"""VectorEnv of sensorfarm.gym: the robots of one or more worlds."""

import numpy

from .environment import RENDER_MODES, Environment, finite, warn_of
from .spaces import batched
from .task import Task, simulation

_MODES = {"NextStep": "NextStep", "Disabled": "Disabled"}
try:
    from gymnasium import vector as _vector
    _Base = _vector.VectorEnv
    if hasattr(_vector, "AutoresetMode"):
        _MODES = {mode: _vector.AutoresetMode(mode) for mode in _MODES}
except ImportError:
    _Base = object

_SECONDS = 10  # maximum time that a sensor may take for its first reading of a robot that was placed


class VectorEnv(Environment, _Base):
    """Sub-environment i is one robot. Worlds follow one after another, and within each world its robots by row.

    An episode ends when `Task.terminated` returns True, or is truncated after `max_steps`. In the following step its
    action is ignored, its reward is 0 and its robot is placed at a free start (autoreset in the next step). Other
    robots continue, except that one of several worlds whose robots have all ended is reset with a new seed. With autoreset_mode="Disabled" you reset it (`reset_mask`) before the next step.

    world: a world file, or a name for the world in `text`. num_envs: robots of all worlds together; None: the worlds'
    own robots. worlds: number of worlds, simulated at once, with consecutive seeds. task: a subclass of Task. render_mode,
    render_size, render_view: as for Env. Further options are those of Simulation.
    """

    metadata = {"render_modes": RENDER_MODES, "render_fps": 10, "autoreset_mode": _MODES["NextStep"]}
    spec = None
    closed = False
    _spaces = "single_observation_space", "single_action_space", "observation_space", "action_space"

    def __init__(self, world="worlds/cave.world", num_envs=16, worlds=1, sensor="laser", max_steps=1000, task=Task,
                 seed=1, render_mode=None, render_size=(640, 480), render_view=None, text=None, autoreset_mode="NextStep",
                 **options):
        if worlds < 1 or max_steps < 1 or (num_envs is not None and (num_envs < 1 or num_envs % worlds)):
            raise ValueError(f"num_envs = {num_envs}, worlds = {worlds}, max_steps = {max_steps}; expected positive "
                             "numbers, and as many robots in each world")
        mode = getattr(autoreset_mode, "value", autoreset_mode)
        if mode not in _MODES:
            raise ValueError(f"autoreset_mode is {autoreset_mode!r}; expected {' or '.join(map(repr, _MODES))}")
        robots = 0 if num_envs is None else num_envs // worlds
        seed = self._seed(seed)
        self._make_task = lambda seed, **other: task(
            simulation(world, text, robots=robots, seed=seed, **{**options, **other}), sensor)
        self.task = self._make_task(seed, copies=worlds)
        self.simulation = self.task.sim
        self._twins = [None] * worlds  # see _sensed
        self.num_envs, self.max_steps, self.worlds = len(self.task), max_steps, worlds
        self.single_observation_space, self.single_action_space = self.task.observation_space, self.task.action_space
        self.observation_space = batched(self.single_observation_space, self.num_envs)
        self.action_space = batched(self.single_action_space, self.num_envs)
        self._set_render(render_mode, render_size, render_view, self.simulation.interval)
        self._autoreset = mode == "NextStep"
        self.metadata["autoreset_mode"] = _MODES[mode]
        self._fresh = True  # the simulations have not moved since they were created with `seed`
        self._ended = numpy.zeros(self.num_envs, bool)
        self._ages = numpy.zeros(self.num_envs, int)
        self._keep(range(seed, seed + worlds))

    def reset(self, *, seed=None, options=None):
        """Begins episodes: all, or those of options={"reset_mask": mask}, a bool array (num_envs,).

        seed: an integer s, for s + k in world k; or one per sub-environment, of which the first of each world counts;
        None: seeds derived from the last one. The same seed gives the same episodes.

        With a mask, a world whose robots are all in the mask is reset as without a mask. In other worlds the robots of
        the mask are placed at free starts, chosen by seed s + i, or the i-th seed, for sub-environment i. No time
        passes, and the rest of the world, including noise, continues unchanged. Observations of the other robots are
        their previous ones.
        """
        self._check_open()
        warn_of(options, "reset_mask")
        if seed is not None and not numpy.isscalar(seed) and len(seed) != self.num_envs:
            raise ValueError(f"{len(seed)} seeds for {self.num_envs} sub-environments; expected as many")
        mask = self._mask_of((options or {}).get("reset_mask"))
        if mask is not None and not mask.all():
            return self._reset_some(mask, seed)
        first = range(0, self.num_envs, self.num_envs // self.worlds)
        if seed is None and not self._fresh:
            seed = self._next_seed()
        elif seed is not None:
            self._seed(seed if numpy.isscalar(seed) else seed[0])
        if seed is not None:
            self._begin([seed + k if numpy.isscalar(seed) else self._known(seed[i]) for k, i in enumerate(first)])
        self._fresh = False
        self._ended[:] = False
        self._ages[:] = 0
        self._keep(self._seeds)
        return self._observations(), self._infos()

    def _known(self, seed):
        return self._next_seed() if seed is None else int(seed)

    def _mask_of(self, mask):
        if mask is None:
            return None
        if not isinstance(mask, numpy.ndarray) or mask.dtype != numpy.bool_:
            raise TypeError(f"reset_mask is {mask!r}; expected a NumPy array of bool")
        if mask.shape != (self.num_envs,) or not mask.any():
            raise ValueError(f"reset_mask has the shape {mask.shape}, {mask.sum()} of it true; expected "
                             f"({self.num_envs},), and at least one")
        return mask

    def _begin(self, seeds):
        self._seeds = list(seeds)
        self._begin_worlds(numpy.arange(self.worlds), self._seeds)

    def _begin_worlds(self, worlds, seeds):
        for k, seed in zip(worlds, seeds):
            self._seeds[k] = int(seed)
        if self.worlds == 1:
            self.simulation.reset(self._seeds[0])
        else:
            self.simulation.restart(worlds, seeds)
        self.task.begin(worlds)

    def _reset_some(self, mask, seed):
        observations = self._observations()
        own = [None if seed is None else seed + i if numpy.isscalar(seed) else seed[i] for i in range(self.num_envs)]
        by_world = mask.reshape(self.worlds, -1)
        whole = numpy.flatnonzero(by_world.all(axis=1))
        if len(whole):
            self._begin_worlds(whole, [self._known(own[k * by_world.shape[1]]) for k in whole])
            begun = by_world.all(axis=1, keepdims=True).repeat(by_world.shape[1], axis=1).ravel()
            observations[begun] = self._observations()[begun]
        for k in numpy.flatnonzero(by_world.any(axis=1) & ~by_world.all(axis=1)):
            chosen = k * by_world.shape[1] + numpy.flatnonzero(by_world[k])
            for agent in chosen:
                of_agent = own[agent]
                self.task.restart(agent, self.np_random if of_agent is None else numpy.random.default_rng(of_agent))
            observations[chosen] = self._sensed(k)[chosen - k * by_world.shape[1]]
        self._fresh = False
        self._ended[mask], self._ages[mask] = False, 0
        return observations, self._infos(mask)

    def _sensed(self, k):
        """Returns observations of world k with all robots at their present poses, at rest. A second simulation, the
        twin, provides them: reading sensors takes simulated time, which must not pass in the first."""
        twin = self._twins[k] = self._twins[k] or self._make_task(self._seeds[k], record="")
        sim, placed = twin.sim, twin.sim.time
        for row, pose in enumerate(self.simulation.poses.reshape(self.worlds, -1, 4)[k]):
            sim.put(row, pose)
        while not (sim.times(twin.sensor) > placed).all():
            if sim.time > placed + _SECONDS:
                raise ValueError(f"a sensor of type '{twin.sensor}' has no reading within {_SECONDS} s; expected "
                                 "faster ones for a reset of some robots of a world")
            sim.step(numpy.zeros((len(sim), 3)))
        return twin.observe()

    def step(self, actions):
        """Advances every world by one tick. actions: (num_envs, 2) in [-1, 1].
        Returns observations, rewards, terminations, truncations, infos."""
        self._check_open()
        actions = finite(actions, self.action_space.shape)
        begins = self._ended
        if begins.any() and not self._autoreset:
            raise ValueError(f"episodes of the sub-environments {numpy.flatnonzero(begins).tolist()} have ended; expected "
                             "reset(options={'reset_mask': ...}) of them first, as autoreset_mode is 'Disabled'")
        self._fresh = False
        whole = begins.reshape(self.worlds, -1).all(axis=1) & (self.worlds > 1)
        for agent in numpy.flatnonzero(begins & ~whole.repeat(self.num_envs // self.worlds)):
            self.task.restart(agent, self.np_random)
        self.task.step(actions, begins)
        rewards, terminations = self.task.reward(), self.task.terminated()
        if whole.any():
            self._begin_worlds(numpy.flatnonzero(whole), self.np_random.integers(2 ** 31, size=whole.sum()))
        if begins.any():  # whatever the task returns for the way to the start
            rewards, terminations = numpy.where(begins, 0.0, rewards), terminations & ~begins
        self._ages = numpy.where(begins, 0, self._ages + 1)
        truncations = (self._ages >= self.max_steps) & ~terminations
        self._ended = terminations | truncations
        return self._observations(), rewards, terminations, truncations, self._infos()

    def _observations(self):
        return self.task.observe().copy()

    def _infos(self, mask=None):
        poses = self.simulation.poses[self.task.rows]
        return {"pose": poses, "_pose": numpy.ones(self.num_envs, bool) if mask is None else mask.copy()}

    def render(self):
        """Returns one picture per sub-environment, (height, width, 3) uint8, of its world from above; robots of one
        world share an array. None without a render_mode."""
        if self.render_mode is None:
            return None
        frames = [self._frame(self.simulation, k) for k in range(self.worlds)]
        return tuple(frame for frame in frames for _ in range(self.num_envs // self.worlds))

    def close(self, **kwargs):
        """Frees the simulations; their arrays are unchanged."""
        self.simulation, self.task, self._twins, self.closed = None, None, [], True
