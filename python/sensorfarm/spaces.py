"""Spaces of actions and observations: Gymnasium's Box if it can be imported, otherwise a class with the same
interface."""

import numpy

try:
    from gymnasium.spaces import Box
except ImportError:
    class Box:
        """Arrays of one shape and type with bounds per element."""

        def __init__(self, low, high, shape=None, dtype=numpy.float32, seed=None):
            shape = numpy.broadcast(low, high).shape if shape is None else tuple(shape)
            self.dtype, self.shape = numpy.dtype(dtype), shape
            self.low = numpy.broadcast_to(numpy.asarray(low, dtype), shape).copy()
            self.high = numpy.broadcast_to(numpy.asarray(high, dtype), shape).copy()
            self.seed(seed)

        def seed(self, seed=None):
            self._np_random = numpy.random.default_rng(seed)
            return seed

        def sample(self, mask=None):
            if not (numpy.isfinite(self.low).all() and numpy.isfinite(self.high).all()):
                raise ValueError(f"{self} has no bounds, so it has no samples")
            return self._np_random.uniform(self.low, self.high).astype(self.dtype)

        def contains(self, x):
            x = numpy.asarray(x)
            return bool(numpy.can_cast(x.dtype, self.dtype) and x.shape == self.shape and numpy.all(x >= self.low)
                        and numpy.all(x <= self.high))

        __contains__ = contains

        def __eq__(self, other):
            return (isinstance(other, Box) and self.shape == other.shape and self.dtype == other.dtype
                    and numpy.array_equal(self.low, other.low) and numpy.array_equal(self.high, other.high))

        def __repr__(self):
            return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"


def another(box):
    """Returns an equal space with its own random generator."""
    return Box(box.low, box.high, dtype=box.dtype)


def batched(box, count):
    """Returns the space of `count` samples of `box`, one per row."""
    return Box(numpy.repeat(box.low[None], count, axis=0), numpy.repeat(box.high[None], count, axis=0), dtype=box.dtype)
