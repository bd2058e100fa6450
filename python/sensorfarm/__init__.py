"""A 2-D multi-robot simulator with virtual sensors, stepped by your program (docs/python.md).

    import numpy, sensorfarm
    sim = sensorfarm.Simulation("worlds/cave.world", robots=50, seed=1)
    twists = numpy.zeros((len(sim), 3))              # forward [m/s], left [m/s], turn [rad/s]
    for _ in range(100):
        ranges = sim.readings("laser")               # [m] (sensors, beams): a view, without a copy
        twists[sim.rows("laser"), 0] = 0.3 * (ranges.min(axis=1) > 0.5)
        sim.step(twists)
"""

import os as _os
import sys as _sys
import tempfile as _tempfile

import numpy as _numpy

from ._sensorfarm import (FLOOR, NONE, DeviceArray, DeviceError, Error, Input, Light, Model, ModelContact, ModelSite, NearRobot,
                          Neighbour, Observations, Pose, Reading, Robot, SensorInfo, Settings, Simulation, Twist, WorldObject,
                          _abort_ranks, add_model_controller, load_plugin)
from .worlds import DeviceWorlds, Worlds

__all__ = ["FLOOR", "NONE", "DeviceArray", "DeviceError", "DeviceWorlds", "Error", "Input", "Light", "Model", "ModelContact", "ModelSite",
           "NearRobot", "Neighbour", "Observations", "Pose", "Reading", "Robot", "SensorInfo", "Settings", "Simulation", "Twist",
           "WorldObject", "Worlds", "add_model_controller", "load_plugin"]


def _valid(self, type, without_noise=False):
    """Returns a new bool array (sensors, elements): True if the element was measured and a stated error bound holds for
    it. With without_noise=True, it suffices that the bound holds before noise is added."""
    values = self.readings(type)
    measured = _numpy.isfinite(values)
    if values.ndim == 3:
        without = _numpy.arange(values.shape[2]) >= self._widths(type)[:, None, None]  # columns of other sensors
        measured = (measured | without).all(axis=2)
    stated = _numpy.isfinite(self.bound_without_noise(type) if without_noise else self.bounds(type))
    return measured & (self.flags(type) == 0) & stated[:, None]


def _camera(self, type, robot, sensor):
    """Returns the row of a robot's camera in the tables of its type."""
    rows = _numpy.flatnonzero(self.rows(type) == robot)
    if not 0 <= sensor < len(rows):
        raise Error(f"robot {robot} has {len(rows)} sensors '{type}'; expected one of them, numbered from 0, and not {sensor}")
    return rows[sensor]


def _images(self, kind="depth", type="camera", robot=None, sensor=0):
    """Returns the newest images of all cameras: of "depth" (cameras, height, width) [m], of "labels" (cameras, height,
    width), the hits, and of "normals" (cameras, height, width, 3) views without a copy; of "colour" a new array of bytes
    (cameras, height, width, 3), and of "mono" (cameras, height, width). With `robot`, a row of `poses`, that of its camera
    number `sensor` alone, without the first axis."""
    kinds = "depth", "labels", "colour", "normals", "mono"
    if kind not in kinds:
        raise Error(f"there are no images of '{kind}'; expected one of {', '.join(kinds)}")
    sizes, values = self._image_sizes(type).reshape(-1, 2), self.readings(type)
    if len(sizes) == 0:
        raise Error(f"'{type}' has no images; expected the type of a camera")
    if robot is None and (sizes != sizes[0]).any():
        raise Error(f"images of '{type}' have no common size; expected images(kind, robot=ROW, sensor=NUMBER) for one of them")
    row = 0 if robot is None else _camera(self, type, robot, sensor)
    part = slice(None) if robot is None else slice(row, row + 1)
    columns = self._widths(type)[part].max()
    pixels = int(sizes[row].prod())
    shape = -1, sizes[row][1], sizes[row][0]

    def of(images):
        return images if robot is None else images[0]

    if kind == "labels":
        return of(self.hits(type)[part, :pixels].reshape(shape))
    images = values[part, :pixels]
    images = images.reshape(len(images), *shape[1:], -1)
    if kind == "depth":
        return of(images[..., 0])
    if kind == "colour" and columns > 1:
        numbers = _numpy.nan_to_num(images[..., 1]).astype("<u4", order="C")
        return of(numbers.view(_numpy.uint8).reshape(*numbers.shape, 4)[..., 2::-1])
    if kind == "mono" and columns > 1:
        colours = self.images("colour", type, robot, sensor)
        if (colours != colours[..., :1]).any():
            raise Error(f"'{type}' has colours; expected 'mono 1' in all cameras")
        return colours[..., 0].copy()
    if kind == "normals" and columns > 2:
        return of(images[..., 2:5])
    raise Error(f"'{type}' has no images of '{kind}'; expected 'rgb 1' for colour, 'mono 1' for mono, or 'normals 1' for normals")


def _png(self):
    """Returns the picture of `draw` as bytes of a PNG file, for display in a notebook."""
    with _tempfile.TemporaryDirectory() as folder:
        file = _os.path.join(folder, "now.png")
        self.draw(file)
        with open(file, "rb") as picture:
            return picture.read()


def _end_all_by_errors():
    """From now on an exception that ends this process also ends all other ranks, which would wait for it forever."""
    before = _sys.excepthook
    if getattr(before, "ends_all", False):
        return

    def hook(type, value, trace):
        before(type, value, trace)
        for stream in (_sys.stdout, _sys.stderr):
            stream.flush()
        _abort_ranks(1)

    hook.ends_all = True
    _sys.excepthook = hook


Simulation.valid, Simulation.images, Simulation._repr_png_ = _valid, _images, _png
