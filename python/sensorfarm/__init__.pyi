"""A 2-D multi-robot simulator with virtual sensors, stepped by your program (docs/python.md). Metres, seconds, radians."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

NONE: int
"""No model: the beam met nothing within its range."""

class Error(RuntimeError):
    """A fault that you can correct: one line, with file and line where there are some."""

class DeviceError(Error):
    """No usable Vulkan device: every device, and the reason for its refusal."""

class Pose(NamedTuple):
    """x forward, y left, z up [m], yaw [rad] counter-clockwise; in the world unless said otherwise."""
    x: float
    y: float
    z: float
    yaw: float

class Twist(NamedTuple):
    """forward, left [m/s] in the robot's frame, turn [rad/s] counter-clockwise."""
    forward: float
    left: float
    turn: float

class SensorInfo:
    """One sensor of a robot."""
    @property
    def type(self) -> str: ...
    @property
    def number(self) -> int:
        """0-based among the robot's sensors of this type."""
    @property
    def name(self) -> str: ...
    @property
    def X_RS(self) -> Pose:
        """The sensor in the robot's frame."""
    @property
    def rate(self) -> float:
        """[Hz]"""
    @property
    def elements(self) -> int:
        """Rows of a reading: beams of a laser."""
    @property
    def columns(self) -> list[str]:
        """Of a row, with units: "range_m"."""
    @property
    def limit(self) -> float:
        """Largest value of the first column: a laser's range [m]."""
    @property
    def bearings(self) -> list[float]:
        """[rad] of a laser's beams; empty for other types."""

class Robot:
    """A robot or tag, as it is at the start."""
    @property
    def name(self) -> str: ...
    @property
    def id(self) -> int:
        """Number in packets."""
    @property
    def row(self) -> int:
        """Row in `Simulation.poses`."""
    @property
    def pose(self) -> Pose: ...
    @property
    def radius(self) -> float:
        """[m] of the circle about its origin that holds its body."""
    @property
    def max_forward(self) -> float:
        """[m/s]"""
    @property
    def max_turn(self) -> float:
        """[rad/s]"""
    @property
    def sensors(self) -> list[SensorInfo]: ...
    @property
    def seed(self) -> int:
        """Of random choices; the same for all robots of a run."""
    @property
    def world(self) -> str:
        """Path of the world file."""

class Reading:
    """One reading of one sensor. A copy: it can be kept."""
    @property
    def type(self) -> str: ...
    @property
    def number(self) -> int: ...
    @property
    def time(self) -> float:
        """[s] of the measurement."""
    @property
    def X_WS(self) -> Pose:
        """The sensor at the measurement."""
    @property
    def values(self) -> NDArray[np.float64]:
        """(elements,), or (elements, columns) for several columns. A range without a return is the limit."""
    @property
    def hits(self) -> NDArray[np.uint32] | None:
        """(beams,) numbers of models, or NONE; None for types without beams."""
    @property
    def bound(self) -> float:
        """Largest error of the first column, of elements without a flag; infinity: not stated, as of noisy sensors."""
    @property
    def bound_without_noise(self) -> float:
        """The same before noise was added."""
    @property
    def sigma(self) -> float:
        """Largest standard deviation of the first column's noise; 0: no noise; infinity: not known."""
    @property
    def flags(self) -> NDArray[np.uint8]:
        """(elements,): 0, or the reason for which the bound does not hold (docs/accuracy.md)."""

class Neighbour:
    """Another robot, as it broadcasts itself (V2V)."""
    @property
    def id(self) -> int: ...
    @property
    def pose(self) -> Pose: ...
    @property
    def velocity(self) -> Twist: ...
    @property
    def follows(self) -> int | None:
        """Id of the robot that it follows."""

class Light:
    """One traffic light."""
    @property
    def name(self) -> str: ...
    @property
    def pose(self) -> Pose:
        """Its lamps face along x."""
    @property
    def state(self) -> str:
        """dark, red, yellow, green, flashing_red or flashing_yellow."""
    @property
    def left(self) -> float:
        """[s] until its next change; infinity: never."""

class Input:
    """What a robot knows when its controller is called. A copy: it can be kept."""
    @property
    def time(self) -> float:
        """[s] simulated, or the robot's clock."""
    @property
    def pose(self) -> Pose:
        """The robot's own: true in a simulation, estimated in `sensorfarm robot`."""
    @property
    def velocity(self) -> Twist: ...
    @property
    def readings(self) -> list[Reading]:
        """The newest of each of its sensors."""
    @property
    def contact(self) -> bool: ...
    @property
    def started(self) -> bool:
        """The start signal was given."""
    @property
    def others(self) -> list[Neighbour]:
        """Robots within radio_range(), by id."""
    @property
    def lights(self) -> list[Light]:
        """All of the world."""
    def newest(self, type: str, number: int = 0) -> Reading | None: ...

class Settings:
    """Settings by key, to be read in __init__. Values of another kind or out of bounds, and keys that nothing has read,
    are errors with their place."""
    def number(self, key: str, fallback: float, least: float = ..., most: float = ...) -> float: ...
    def flag(self, key: str, fallback: bool) -> bool: ...
    def text(self, key: str, fallback: str) -> str: ...
    def numbers(self, key: str, fallback: Sequence[float]) -> list[float]: ...

class Controller(Protocol):
    """A controller of your own: this shape, not this class. Optional: `rate` [Hz] (10), `on_scans` (False: steps
    at `rate`, not on each new scan) and `stops_on_bumper` (True) of the class; methods radio_range() [m], done() and error()."""
    def __init__(self, robot: Robot, settings: Settings) -> None: ...
    def step(self, input: Input) -> tuple[float, float, float]:
        """Forward [m/s], left [m/s], turn [rad/s] until the next call."""

class Simulation:
    """A simulated fleet. One thread at a time. Arrays are views without a copy, valid until the next step, put or reset:
    read them anew after it, and copy what you keep. They cannot be written to, unless `writable`."""

    def __init__(self, world: str, *, robots: int = 0, of: str = "", robot_from: str = "",
                 seed: int = 1, threads: int = 0, noise: bool = True, accuracy: str = "", device: str = "", caster: str = "auto",
                 require_vulkan: bool = False, controller: str | type[Controller] = "",
                 settings: Mapping[str, Any] = {}, record: str = "", record_readings: bool = False,
                 ranks: bool = False, too_near_min: bool = False, compression: str = "zstd", writable: bool = False) -> None:
        """world: a world file or ROS map (.yaml), also one of the installed worlds. robots: clones of one robot (`of`;
        else the first with sensors) at free poses; 0: the world's own. robot_from: "FILE:NAME", a robot of another
        world file, for a world without robots (a ROS map) or to be cloned. seed: of poses, noise and controllers. threads: 0
        for all cores. accuracy: mode of all sensors (docs/accuracy.md). device: row or part of a device's name, or
        "host". require_vulkan: without a usable device DeviceError, not the host. caster:
        auto, or a name of `sensorfarm run --caster`, such as host or reference (docs/accuracy.md). controller: of all robots, by name, file (mine.py:Class, ./libmine.so) or class; empty:
        twists drive them. record: folder of a recording. too_near_min: ranges of surfaces that
        are too near are recorded as range_min, not as -infinity (docs/sensors.md). compression: of the recording, zstd or none
        (docs/recordings.md). ranks: processes of mpirun share the fleet; all make the same
        calls, and each has the readings of its own robots alone and commands these (docs/cluster.md). Raises Error, DeviceError, TypeError."""
    @staticmethod
    def from_text(text: str, name: str = "given.world", **options: Any) -> Simulation:
        """A world given as text, with the options of the constructor. name: for messages; files that the text includes are
        looked for in its folder."""
    def step(self, twists: ArrayLike | None = None) -> None:
        """One tick: robots execute their twists, (robots, 3) of forward [m/s], left [m/s], turn [rad/s]; then sensors are
        read. None: twists stay as they are. Rows with a controller ignore theirs. Other threads of Python run meanwhile."""
    def reset(self, seed: int | None = None) -> None:
        """Begins anew at time 0. Arrays read before keep the old run."""
    def add_robot(self, name: str, like: str, pose: Sequence[float], *, controller: str | type = "",
                  settings: Mapping[str, Any] = ...) -> int:
        """Adds a copy of the robot `like` (its name, or the word of its type) at (x, y, z, yaw), at rest: its sensors are
        read from the next step on. Returns its row: the last one, or that of a removed robot of the same name and kind,
        which returns. Other rows and the bytes of readings that do not see it stay as they are. name: 1 to 64 letters,
        digits or '_'. Arrays read before keep the rows that they had. A reset forgets it. Raises Error, with nothing changed."""
    def remove_robot(self, row: int) -> None:
        """Takes a robot out of the world: its pose is NaN, its readings stay as they were. Its row, id and name stay its own.
        Raises Error for a row without a present robot."""
    def put(self, row: int, pose: Sequence[float]) -> None:
        """Places a robot at (x, y, z, yaw), at rest. Its sensors see it from the next step on."""
    def draw(self, file: str) -> None:
        """Writes a PNG of the world at this time."""
    def image(self, width: int = 640, height: int = 480,
              view: tuple[float, float, float, float] | None = None) -> NDArray[np.uint8]:
        """(height, width, 3) red, green, blue: the world from above at this time, +y up, without texts and fields of view;
        a new array. view: (x_min, y_min, x_max, y_max) [m] to show at least; None: the whole world. The first image of a
        size and view paints the static layer, which is kept for the last four. Sides are 1 to 4096 pixels.
        Raises Error for options out of range, and without Cairo."""
    def finish_recording(self) -> None:
        """Ends the recording, with its index."""
    def __len__(self) -> int:
        """Rows: robots, and tags if the world has some."""
    @property
    def poses(self) -> NDArray[np.float64]:
        """(robots, 4): x, y, z [m], yaw [rad] of the last tick."""
    @property
    def velocities(self) -> NDArray[np.float64]:
        """(robots, 3): forward, left [m/s], turn [rad/s]."""
    @property
    def contacts(self) -> NDArray[np.bool_]:
        """(robots,): a wall or a robot stopped it."""
    @property
    def done(self) -> NDArray[np.bool_]:
        """(robots,): its controller is done."""
    @property
    def present(self) -> NDArray[np.bool_]:
        """(robots,): False where remove_robot took it out of the world."""
    @property
    def robots(self) -> list[Robot]: ...
    @property
    def types(self) -> list[str]:
        """Sensor types of this world: "laser", ..."""
    @property
    def models(self) -> list[str]:
        """Names, by the numbers in hits()."""
    @property
    def interval(self) -> float:
        """[s] of a tick."""
    @property
    def time(self) -> float:
        """[s] of the last tick."""
    @property
    def tick(self) -> int: ...
    @property
    def hash(self) -> int:
        """Of all readings so far: that of `sensorfarm run`, which prints it in hexadecimal digits."""
    @property
    def rank(self) -> int:
        """Number of this process, below `ranks`."""
    @property
    def ranks(self) -> int:
        """Processes that share the fleet; 1: this one alone."""
    @property
    def owned(self) -> NDArray[np.bool_]:
        """(robots,): this rank has its readings and commands it."""
    @property
    def description(self) -> str:
        """Device and caster, in one line."""
    @property
    def warnings(self) -> list[str]:
        """Of the world file, and of the device."""
    def readings(self, type: str) -> NDArray[np.float64]:
        """(sensors, elements), or (sensors, elements, columns) for types with several columns: the newest reading of each
        sensor of the type. Shorter readings end in NaN. A range without a return is the sensor's limit, and that of a
        surface nearer than its minimum is this minimum, with the flag 5."""
    def hits(self, type: str) -> NDArray[np.uint32]:
        """(sensors, beams): number of the model that each beam met, or NONE."""
    def flags(self, type: str) -> NDArray[np.uint8]:
        """(sensors, elements): 0 where a stated bound holds (docs/accuracy.md); 5: the surface is too near."""
    def valid(self, type: str, without_noise: bool = False) -> NDArray[np.bool_]:
        """(sensors, elements): measured, and a stated bound holds; without_noise=True: by `bound_without_noise`, which
        noisy sensors have, too. A new array."""
    def bounds(self, type: str) -> NDArray[np.float64]:
        """(sensors,): largest error of the first column; infinity: not stated, as of noisy sensors."""
    def bound_without_noise(self, type: str) -> NDArray[np.float64]:
        """(sensors,): the same before noise was added."""
    def sigma(self, type: str) -> NDArray[np.float64]:
        """(sensors,): largest standard deviation of the first column's noise; 0: no noise; infinity: not known."""
    def times(self, type: str) -> NDArray[np.float64]:
        """(sensors,) [s] of the measurement; NaN before the first."""
    def rows(self, type: str) -> NDArray[np.uint32]:
        """(sensors,): row of the sensor's robot in `poses`."""
    def fresh(self, type: str) -> NDArray[np.bool_]:
        """(sensors,): delivered in the last step."""

def load_plugin(file: str) -> None:
    """Loads controllers from a shared library or Python file: `controller` can name them. Raises Error."""
