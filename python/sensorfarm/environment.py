"""Shared parts of the environments of sensorfarm.gym and sensorfarm.pettingzoo: seeds, pictures and copies."""

import copy
import secrets
import warnings

import numpy

RENDER_MODES = ["rgb_array"]


class Environment:
    """Mixin of the environments. A copy (copy.deepcopy, pickle) is the environment after its last full reset, or after
    its construction: class, arguments, seeds and generators. The same actions lead a copy through the same episode.
    Motion since then, and changes that a Task has made to itself, are not copied."""

    _spaces = ()  # names of attributes whose generators are copied unchanged
    _np_random = None
    _np_random_seed = None

    def __new__(cls, *arguments, **options):
        self = object.__new__(cls)
        self._arguments = arguments, options
        return self

    def __reduce__(self):
        arguments, options = self._arguments
        if options.get("record"):
            raise TypeError(f"an environment that records (record={options['record']!r}) cannot be copied: both would "
                            "write the same folder; create another one with its own folder")
        state = {"at_reset": self._at_reset, "spec": self.spec, "closed": self.closed,
                 "spaces": {name: getattr(self, name) for name in self._spaces}}
        return _made, (type(self), arguments, options), state

    def __setstate__(self, state):
        seeds, self._np_random_seed, generator, self._fresh = state["at_reset"]
        self._np_random = copy.deepcopy(generator)
        if not self._fresh or seeds != self._seeds:
            self._begin(seeds)
        self._keep(seeds)
        self.spec = state["spec"]
        for name, space in state["spaces"].items():
            setattr(self, name, space)
        if state["closed"]:
            self.close()

    def _keep(self, seeds):
        """Saves the data for copies. seeds: of the simulations."""
        self._seeds = list(seeds)
        self._at_reset = self._seeds, self._np_random_seed, copy.deepcopy(self._np_random), self._fresh

    def _seed(self, seed):
        """seed: for all random choices of the environment; None: an unpredictable one."""
        seed = secrets.randbits(31) if seed is None else int(seed)
        self._np_random_seed, self._np_random = seed, numpy.random.default_rng(seed)
        return seed

    def _next_seed(self):
        return int(self._np_random.integers(2 ** 31))

    @property
    def np_random(self):
        return self._np_random

    @np_random.setter
    def np_random(self, generator):
        self._np_random, self._np_random_seed = generator, -1

    @property
    def np_random_seed(self):
        return self._np_random_seed

    @property
    def unwrapped(self):
        return self

    def _check_open(self):
        if self.closed:
            raise ValueError("the environment is closed")

    def _set_render(self, mode, size, view, interval):
        """interval: [s] of a step."""
        if mode is not None and mode not in RENDER_MODES:
            raise ValueError(f"render_mode is {mode!r}; expected {' or '.join(map(repr, [None, *RENDER_MODES]))}")
        self.render_mode, self.render_size, self.render_view = mode, tuple(size), view
        self.metadata = {**self.metadata, "render_fps": max(1, round(1 / interval))}

    def _frame(self, simulation, world=0):
        width, height = self.render_size
        return simulation.image(width, height, self.render_view, world=world)


def _made(kind, arguments, options):
    return kind(*arguments, **options)


def finite(actions, shape):
    """Returns the actions as an array. Raises ValueError for another shape, and for numbers that are not finite."""
    actions = numpy.asarray(actions, dtype=float)
    if actions.shape != shape or not numpy.isfinite(actions).all():
        raise ValueError(f"actions have the shape {actions.shape}; expected finite numbers of shape {shape}")
    return actions


def warn_of(options, *expected):
    """Warns about options of `reset` that have no effect."""
    unknown = sorted(map(str, set(options or ()) - set(expected)))
    if unknown:
        known = ", ".join(expected) or "none"
        warnings.warn(f"options of reset without effect: {', '.join(unknown)}; expected: {known}", stacklevel=3)
