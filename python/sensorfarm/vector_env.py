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
    robots continue. With autoreset_mode="Disabled" you reset it (`reset_mask`) before the next step.

    world: a world file, or a name for the world in `text`. num_envs: robots of all worlds together; None: the worlds'
    own robots. worlds: number of simulations, with consecutive seeds. task: a subclass of Task. render_mode,
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
        self.tasks = [self._make_task(seed + k) for k in range(worlds)]
        self.simulations = [one.sim for one in self.tasks]
        self._twins = [None] * worlds  # see _sensed
        sizes = [len(one) for one in self.tasks]
        ends = numpy.cumsum(sizes)
        self._shares = [slice(end - size, end) for end, size in zip(ends, sizes)]
        self.num_envs, self.max_steps = int(ends[-1]), max_steps
        self.single_observation_space = self.tasks[0].observation_space
        self.single_action_space = self.tasks[0].action_space
        self.observation_space = batched(self.single_observation_space, self.num_envs)
        self.action_space = batched(self.single_action_space, self.num_envs)
        self._set_render(render_mode, render_size, render_view, self.simulations[0].interval)
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
        first = [share.start for share in self._shares]
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
        for k, seed in enumerate(seeds):
            self._begin_world(k, seed)
        self._seeds = list(seeds)

    def _begin_world(self, k, seed):
        self.simulations[k].reset(int(seed))
        self.tasks[k].begin()

    def _reset_some(self, mask, seed):
        observations = self._observations()
        own = [None if seed is None else seed + i if numpy.isscalar(seed) else seed[i] for i in range(self.num_envs)]
        for k, (one, share) in enumerate(zip(self.tasks, self._shares)):
            chosen = numpy.flatnonzero(mask[share])
            if len(chosen) == len(one):
                self._begin_world(k, self._known(own[share.start]))
                observations[share] = one.observe()
            elif len(chosen):
                for agent in chosen:
                    of_agent = own[share.start + agent]
                    one.restart(agent, self.np_random if of_agent is None else numpy.random.default_rng(of_agent))
                observations[share][chosen] = self._sensed(k)[chosen]
        self._fresh = False
        self._ended[mask], self._ages[mask] = False, 0
        return observations, self._infos(mask)

    def _sensed(self, k):
        """Returns observations of world k with all robots at their present poses, at rest. A second simulation, the
        twin, provides them: reading sensors takes simulated time, which must not pass in the first."""
        twin = self._twins[k] = self._twins[k] or self._make_task(self._seeds[k], record="")
        sim, placed = twin.sim, twin.sim.time
        for row, pose in enumerate(self.simulations[k].poses):
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
        rewards = numpy.zeros(self.num_envs)
        terminations = numpy.zeros(self.num_envs, bool)
        for one, share in zip(self.tasks, self._shares):
            for agent in numpy.flatnonzero(begins[share]):
                one.restart(agent, self.np_random)
            one.step(actions[share], begins[share])
            rewards[share], terminations[share] = one.reward(), one.terminated()
        rewards[begins], terminations[begins] = 0.0, False  # whatever the task returns for the way to the start
        self._ages = numpy.where(begins, 0, self._ages + 1)
        truncations = (self._ages >= self.max_steps) & ~terminations
        self._ended = terminations | truncations
        return self._observations(), rewards, terminations, truncations, self._infos()

    def _observations(self):
        return numpy.concatenate([one.observe() for one in self.tasks])

    def _infos(self, mask=None):
        poses = numpy.concatenate([one.sim.poses[one.rows] for one in self.tasks])
        return {"pose": poses, "_pose": numpy.ones(self.num_envs, bool) if mask is None else mask.copy()}

    def render(self):
        """Returns one picture per sub-environment, (height, width, 3) uint8, of its world from above; robots of one
        world share an array. None without a render_mode."""
        if self.render_mode is None:
            return None
        frames = [self._frame(sim) for sim in self.simulations]
        return tuple(frame for frame, one in zip(frames, self.tasks) for _ in range(len(one)))

    def close(self, **kwargs):
        """Frees the simulations; their arrays are unchanged."""
        self.simulations, self.tasks, self._twins, self.closed = [], [], [], True
