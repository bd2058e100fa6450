"""A 2-D multi-robot simulator with virtual sensors, stepped by your program (docs/python.md). Metres, seconds,
radians."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

_ByRow = ArrayLike | Mapping[str, ArrayLike] | None
"""An array, or arrays by name."""

NONE: int
"""No model: the beam met nothing within its range."""
FLOOR: int
"""No model: a tilted beam met the floor, a road or terrain."""

class Error(RuntimeError):
    """An error that you can correct. The message is one line, with file and line number if available."""

class DeviceError(Error):
    """No usable Vulkan device. The message lists every device and the reason why it was refused."""

class Pose(NamedTuple):
    """x forward, y left, z up [m], yaw [rad] counter-clockwise; in the world frame unless stated otherwise."""
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
        """Pose of the sensor in the robot's frame."""
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
    """A robot or tag, as at the start."""
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
        """[m] radius of the circle about its origin that contains its body."""
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
    """One reading of one sensor. It is a copy and can be kept."""
    @property
    def type(self) -> str: ...
    @property
    def number(self) -> int: ...
    @property
    def time(self) -> float:
        """[s] of the measurement."""
    @property
    def X_WS(self) -> Pose:
        """Pose of the sensor at the measurement."""
    @property
    def values(self) -> NDArray[np.float64]:
        """(elements,), or (elements, columns) for several columns. A range without a return equals the limit."""
    @property
    def hits(self) -> NDArray[np.uint32] | None:
        """(beams,) indices of models, FLOOR or NONE; None for types without beams."""
    @property
    def bound(self) -> float:
        """Largest error of the first column, for elements without a flag; infinity: not stated, as for noisy
        sensors."""
    @property
    def bound_without_noise(self) -> float:
        """The same before noise is added."""
    @property
    def sigma(self) -> float:
        """Largest standard deviation of the first column's noise; 0: no noise; infinity: unknown."""
    @property
    def flags(self) -> NDArray[np.uint8]:
        """(elements,): 0, or the reason why the bound does not hold (docs/accuracy.md)."""

class Neighbour:
    """Another robot, by its V2V broadcasts."""
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
    """The input of one control step. It is a copy and can be kept."""
    @property
    def time(self) -> float:
        """[s] simulated, or on the robot's clock."""
    @property
    def pose(self) -> Pose:
        """Of the robot: true in a simulation, estimated in `sensorfarm robot`."""
    @property
    def velocity(self) -> Twist: ...
    @property
    def readings(self) -> list[Reading]:
        """The newest reading of each of its sensors."""
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
        """All lights of the world."""
    def newest(self, type: str, number: int = 0) -> Reading | None: ...

class Settings:
    """Settings by key, to be read in __init__. Values of another type or out of bounds, and keys that were not read,
    are errors that name their place."""
    def number(self, key: str, fallback: float, least: float = ..., most: float = ...) -> float: ...
    def flag(self, key: str, fallback: bool) -> bool: ...
    def text(self, key: str, fallback: str) -> str: ...
    def numbers(self, key: str, fallback: Sequence[float]) -> list[float]: ...

class Controller(Protocol):
    """Your own controller: a class of this shape, not a subclass. Optional: class attributes `rate` [Hz] (10),
    `on_scans` (False: steps at `rate`, not on each new scan) and `stops_on_bumper` (True); methods radio_range() [m],
    done(), error() and outputs() (bits of a real robot's digital outputs, docs/robots.md)."""
    def __init__(self, robot: Robot, settings: Settings) -> None: ...
    def step(self, input: Input) -> tuple[float, float, float]:
        """Returns forward [m/s], left [m/s], turn [rad/s] to drive until the next call."""

class ModelSite:
    """A model with a controller of models, as at the start."""
    @property
    def name(self) -> str: ...
    @property
    def row(self) -> int:
        """Row in `Simulation.poses`."""
    @property
    def pose(self) -> Pose: ...
    @property
    def radius(self) -> float:
        """[m] radius of the circle about its origin that contains its body."""
    @property
    def max_forward(self) -> float:
        """[m/s] in any direction."""
    @property
    def max_turn(self) -> float:
        """[rad/s]"""
    @property
    def interval(self) -> float:
        """[s] from one call of tick() to the next."""
    @property
    def seed(self) -> int: ...
    @property
    def world(self) -> str:
        """Path of the world file."""

class NearRobot:
    """A robot near a model, with its true state."""
    @property
    def name(self) -> str: ...
    @property
    def row(self) -> int:
        """Row in `Simulation.poses`."""
    @property
    def pose(self) -> Pose: ...
    @property
    def velocity(self) -> Twist: ...
    @property
    def radius(self) -> float:
        """[m] radius of the circle about its origin that contains its body."""
    @property
    def distance(self) -> float:
        """[m] between the origins of robot and model."""

class ModelContact:
    """The beginning of a contact: the other's surface is within 1 mm of the model's outline, or inside it."""
    @property
    def name(self) -> str:
        """Of the other: a robot, an object or a static model."""
    @property
    def row(self) -> int | None:
        """Row of the other in `Simulation.poses`; None: it is static."""
    @property
    def robot(self) -> bool:
        """The other is a robot."""
    @property
    def point(self) -> tuple[float, float]:
        """x and y [m] of the other's point that is nearest to the model's outline, or inside it."""

class WorldObject:
    """An object that moves, in one call: its state at this tick, and changes, which take effect after the calls of the
    tick. It can be used during the call only."""
    @property
    def pose(self) -> Pose:
        """Its last one while it is absent."""
    @property
    def velocity(self) -> Twist: ...
    @property
    def present(self) -> bool: ...
    @property
    def changeable(self) -> bool:
        """False: changes have no effect, because a robot's controller, the user or packets move it."""
    def set_pose(self, pose: Sequence[float]) -> None:
        """Places the object at (x, y, z [m], yaw [rad]), at rest."""
    def set_velocity(self, velocity: Sequence[float]) -> None:
        """Sets forward, left [m/s] and turn [rad/s] for all following ticks."""
    def set_present(self, present: bool) -> None:
        """Removes the object from the world, or restores it at its last pose."""
    def set_shape(self, name: str) -> None:
        """Gives the object a shape of the world file, with its size and colour, or "original"."""
    def set_size(self, size: Sequence[float]) -> None:
        """Scales the object's own outline to (x, y, z) [m]: one argument, a tuple or list of three lengths."""
    def set_color(self, color: str) -> None:
        """An X11 name, or "#RRGGBB"."""

class Model(WorldObject):
    """The controller's own model in one call."""
    @property
    def time(self) -> float:
        """[s] of the tick."""
    @property
    def robots(self) -> list[NearRobot]:
        """Robots within range(), the nearest first; at most 1024."""
    def object(self, name: str) -> WorldObject:
        """Returns another object that moves: a model named tag<N>, or one with `ctrl`. Raises ValueError for an unknown
        name, a robot, and a model that does not move."""
    def uniform(self) -> float:
        """Returns the model's next random number in (0, 1)."""
    def normal(self) -> float:
        """Returns the model's next random number of the standard normal distribution."""

class ModelController(Protocol):
    """Your own controller of a model that is not a robot: a class of this shape, not a subclass, in a file that `ctrl`
    names, or given to add_model_controller. Optional: contact(contact, model), and range() [m] of `Model.robots` (docs/own_controller.md)."""
    def __init__(self, model: ModelSite, settings: Settings) -> None: ...
    def tick(self, model: Model) -> None: ...

class Observations:
    """What a learner observes: rows of float32 in [-1, 1], one per agent, written in place after each step and restart
    of their simulation."""
    @property
    def values(self) -> NDArray[np.float32]:
        """(agents, columns): see Simulation.observe."""
    @property
    def rows(self) -> NDArray[np.uint32]:
        """(agents,): row of the agent's robot."""
    @property
    def goals(self) -> NDArray[np.float64]:
        """(agents, 2): x, y [m] of each goal; writable, effective from the next step, restart or update on. NaN:
        none."""
    @property
    def distances(self) -> NDArray[np.float64]:
        """(agents,) [m] to the goal; NaN without one."""
    @property
    def progress(self) -> NDArray[np.float64]:
        """(agents,) [m]: how much nearer the goal came in the last step; 0 after a restart or a change of the goal."""
    @property
    def ages(self) -> NDArray[np.uint32]:
        """(agents,): steps since the start of the agent's world."""
    def update(self) -> None:
        """Recomputes the observations after goals have changed."""
    def __len__(self) -> int:
        """Number of agents."""
    def __dlpack__(self, **options: Any) -> Any:
        """`values` without a copy, for torch.from_dlpack(observations). Do not write to it."""
    def __dlpack_device__(self) -> tuple[int, int]:
        """The host."""

class Simulation:
    """A simulated fleet. Not thread-safe. Arrays are views without a copy, valid until the next step, put or reset:
    read them again after it, and copy the data that you keep. They are read-only unless `writable`."""

    def __init__(self, world: str, *, robots: int = 0, of: str = "", robot_from: str = "",
                 seed: int = 1, copies: int = 1, threads: int = 0, noise: bool = True, accuracy: str = "", device: str = "", caster: str = "auto",
                 require_vulkan: bool = False, controller: str | type[Controller] = "",
                 settings: Mapping[str, Any] = {}, record: str = "", record_readings: bool = False, record_world: int = 0,
                 ranks: bool = False, too_near_min: bool = False, compression: str = "zstd", positioning: str = "", faults: str = "",
                 writable: bool = False) -> None:
        """world: a world file or ROS map (.yaml), possibly one of the installed worlds. robots: clones of one robot
        (`of`; otherwise the first with sensors) at free poses; 0: the world's own robots. robot_from: "FILE:NAME", a
        robot of another world file, for a world without robots (a ROS map) or as the robot to clone. seed: of poses,
        noise and controllers. copies: that many worlds at once; world k has seed + k, its rows follow those of world
        k - 1, and it gives the bytes of that world alone; not with record, ranks, positioning and faults. threads: 0 for all cores. accuracy: mode of all sensors (docs/accuracy.md). device: row
        or part of a device's name, or "host". require_vulkan: raise DeviceError instead of using the host if no device
        is usable. caster: auto, or a name of `sensorfarm run --caster`, such as host or reference (docs/accuracy.md).
        controller: of all robots, by name, file (mine.py:Class, ./libmine.so) or class; empty: `ctrl` of the world
        file, or else twists; "none": twists drive all. record: folder of a recording. too_near_min: record ranges of
        surfaces that are too near as range_min, not as -infinity (docs/sensors.md). compression: of the recording, zstd
        or none (docs/recordings.md). positioning: of robots that localize themselves, by keys of a scenario's table
        [positioning], one per line (docs/scenarios.md). faults: of sensors, as [[fault]] tables of a scenario. ranks: processes of mpirun share the fleet; all make the same calls, and each has
        the readings of its own robots only and commands these (docs/cluster.md). Raises Error, DeviceError,
        TypeError."""
    @staticmethod
    def from_text(text: str, name: str = "given.world", **options: Any) -> Simulation:
        """Creates a simulation of a world given as text, with the options of the constructor. name: for messages; files
        that the text includes are looked up in its folder."""
    def step(self, twists: ArrayLike | None = None) -> None:
        """Advances by one tick: robots execute their twists, (robots, 3) of forward [m/s], left [m/s], turn [rad/s];
        then sensors are read. None: the previous twists apply. Twists of rows with a controller are ignored. Other
        Python threads run meanwhile."""
    def reset(self, seed: int | None = None) -> None:
        """Restarts at time 0. Arrays read before keep the old run. Of several worlds, world k gets seed + k."""
    def restart(self, worlds: Sequence[int], seeds: Sequence[int], starts: ArrayLike | None = None, *,
                present: ArrayLike | None = None, sizes: ArrayLike | None = None, slip: ArrayLike | None = None,
                acceleration: ArrayLike | None = None, noise: ArrayLike | None = None) -> None:
        """Restarts some of several worlds, at time 0 of their own clocks; the others are unchanged, and no time
        passes for them. Readings of the start are available at once. seeds: one per world. starts: (worlds, rows, 4)
        poses; sizes: (worlds, rows, 3) [m]; present, slip, acceleration, noise: (worlds, rows), see Worlds.reset. None,
        and where (x) is NaN: those of a world alone with that seed. Raises Error, with nothing changed."""
    def observe(self, sensor: str = "laser", *, every: int = 1, speeds: bool = True, goal_reach: float = 0.0,
                stack: int = 1) -> Observations:
        """Returns observations of the robots with sensors of this type, which each step and restart writes from now on.
        Columns: elements 0, every, 2 every, ... of the readings, over the sensors' limits (1 where there is no number);
        with speeds, forward and turning speed over the robot's largest; with goal_reach [m] > 0, the distance of the
        goal over it, and cosine and sine of its bearing; all of this for the last `stack` observations, the newest
        first. Raises Error for options out of range."""
    def hash_of(self, world: int) -> int:
        """Hash of the readings of one of several worlds, since its start."""
    def time_of(self, world: int) -> float:
        """[s] of the last tick, of one of several worlds."""
    def add_robot(self, name: str, like: str, pose: Sequence[float], *, controller: str | type = "",
                  settings: Mapping[str, Any] = ...) -> int:
        """Adds a copy of the robot `like` (its name, or the word of its type) at (x, y, z, yaw), at rest. Its sensors
        are read from the next step on. Returns its row: the last one, or that of a removed robot of the same name and
        kind, which returns. Other rows, and the bytes of readings that do not see it, are unchanged. name: 1 to 64
        letters, digits or '_'. Arrays read before keep their rows. A reset removes the robot. Raises Error, with
        nothing changed."""
    def remove_robot(self, row: int) -> None:
        """Removes a robot from the world: its pose is NaN, its readings are unchanged. Its row, id and name remain
        reserved. Raises Error for a row without a present robot."""
    def set_shape(self, row: int, shape: str = "", *, color: str = "",
                  size: tuple[float, float, float] | None = None) -> None:
        """Changes the shape ("original": its own), colour (X11 name or "#RRGGBB") or size (x, y, z) [m] of a robot or
        tag between two steps; what is not given remains, except that a shape brings its own size and colour. Sensors,
        contacts and images have it from the next step on. A reset restores all shapes. Raises Error, with nothing
        changed."""
    def set_lane(self, lane: str, use: str) -> None:
        """Requests the use of a lane such as "3.1": "open", "closed", "reversed", or "turn", "left" or "right" for one
        whose end only turns may leave. Robots with a route controller replan. A lane is reversed once it has been empty
        for 2 s; until then it is closed. A reset restores all lanes. Raises Error, with nothing changed."""
    def put(self, row: int, pose: Sequence[float]) -> None:
        """Places a robot at rest at (x, y, z, yaw), level, or at (x, y, z, w, qx, qy, qz), with the orientation of this
        unit quaternion. Its sensors see the new place from the next step on. It keeps its tilt while it drives; contacts
        and planar sensors are those of a level robot."""
    def draw(self, file: str, *, world: int = 0) -> None:
        """Writes a PNG of the world, or of one of several, at this time."""
    def image(self, width: int = 640, height: int = 480,
              view: tuple[float, float, float, float] | None = None, *, world: int = 0) -> NDArray[np.uint8]:
        """Returns a new array (height, width, 3) of red, green, blue: the world from above at this time, +y up, without
        texts and fields of view. view: (x_min, y_min, x_max, y_max) [m] that must be visible; None: the whole world.
        The first image of a size and view paints the static layer, which is cached for the last four combinations.
        Sides are 1 to 4096 pixels. Raises Error for options out of range, and without Cairo."""
    def finish_recording(self) -> None:
        """Ends the recording and writes its index."""
    def __len__(self) -> int:
        """Number of rows: robots, and tags if the world contains any."""
    @property
    def poses(self) -> NDArray[np.float64]:
        """(robots, 4): x, y, z [m], yaw [rad] of the last tick."""
    @property
    def poses7(self) -> NDArray[np.float64]:
        """(robots, 7): x, y, z [m] and a unit quaternion w, x, y, z of the last tick. A copy."""
    @property
    def velocities(self) -> NDArray[np.float64]:
        """(robots, 3): forward, left [m/s], turn [rad/s]."""
    @property
    def radii(self) -> NDArray[np.float64]:
        """(rows,) [m]: radius of the circle about its origin that contains the body; changes with its size. A copy."""
    @property
    def contacts(self) -> NDArray[np.bool_]:
        """(robots,): True if a wall or a robot stopped it."""
    @property
    def done(self) -> NDArray[np.bool_]:
        """(robots,): True if its controller is done."""
    @property
    def present(self) -> NDArray[np.bool_]:
        """(robots,): False if remove_robot removed it from the world."""
    @property
    def copies(self) -> int:
        """Number of worlds."""
    @property
    def robots(self) -> list[Robot]:
        """Of each row of a world, at the start."""
    @property
    def shapes(self) -> list[str]:
        """Names of the world's shapes, in the order of its file."""
    @property
    def types(self) -> list[str]:
        """Sensor types of this world: "laser", ..."""
    @property
    def models(self) -> list[str]:
        """Names, indexed by hits()."""
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
        """Of all readings so far; equals the hash of `sensorfarm run`, which prints it in hexadecimal digits."""
    @property
    def rank(self) -> int:
        """Number of this process, below `ranks`."""
    @property
    def ranks(self) -> int:
        """Number of processes that share the fleet; 1: only this one."""
    @property
    def owned(self) -> NDArray[np.bool_]:
        """(robots,): True if this rank has its readings and commands it."""
    @property
    def description(self) -> str:
        """Device and caster, in one line."""
    @property
    def warnings(self) -> list[str]:
        """About the world file and the device."""
    def readings(self, type: str) -> NDArray[np.float64]:
        """Returns (sensors, elements), or (sensors, elements, columns) for types with several columns: the newest
        reading of each sensor of the type. Shorter readings are padded with NaN. A range without a return equals the
        sensor's limit. The range of a surface nearer than the sensor's minimum equals this minimum, with flag 5."""
    def hits(self, type: str) -> NDArray[np.uint32]:
        """Returns (sensors, beams or pixels): index of the model that each one meets, FLOOR or NONE."""
    def flags(self, type: str) -> NDArray[np.uint8]:
        """Returns (sensors, elements): 0 if a stated bound holds (docs/accuracy.md); 5: the surface is too near."""
    def images(self, kind: str = "depth", type: str = "camera", robot: int | None = None, sensor: int = 0) -> NDArray[Any]:
        """Returns the newest images of all cameras: of "depth" (cameras, height, width) [m], "labels" (cameras, height,
        width), the hits, and "normals" (cameras, height, width, 3) without a copy, of "colour" (cameras, height, width, 3)
        and of "mono" (cameras, height, width) as new bytes. With `robot`, a row of `poses`, that of its camera number
        `sensor` alone, without the first axis. Raises Error without it if the cameras' images have different sizes."""
    def valid(self, type: str, without_noise: bool = False) -> NDArray[np.bool_]:
        """Returns a new array (sensors, elements): True if the element was measured and a stated bound holds.
        without_noise=True uses `bound_without_noise`, which noisy sensors also have."""
    def bounds(self, type: str) -> NDArray[np.float64]:
        """Returns (sensors,): largest error of the first column; infinity: not stated, as for noisy sensors."""
    def bound_without_noise(self, type: str) -> NDArray[np.float64]:
        """Returns (sensors,): the same before noise is added."""
    def sigma(self, type: str) -> NDArray[np.float64]:
        """Returns (sensors,): largest standard deviation of the first column's noise; 0: no noise; infinity:
        unknown."""
    def times(self, type: str) -> NDArray[np.float64]:
        """Returns (sensors,) [s] time of the measurement; NaN before the first."""
    def rows(self, type: str) -> NDArray[np.uint32]:
        """Returns (sensors,): row of the sensor's robot in `poses`."""
    def fresh(self, type: str) -> NDArray[np.bool_]:
        """Returns (sensors,): True if delivered in the last step."""

def add_model_controller(controller: type[ModelController], name: str | None = None) -> None:
    """Adds a controller of models for the rest of the program: `ctrl "NAME KEY=VALUE ..."` of models that are not robots
    can name it in worlds loaded from now on. name: by default that of the class. Raises Error, TypeError."""

def load_plugin(file: str) -> None:
    """Loads controllers from a shared library or Python file, so that `controller` can name them. Raises Error."""

class _WorldStates:
    """States of the robots of many worlds."""
    @property
    def poses(self) -> NDArray[np.float64]:
        """(worlds, robots, 4): x, y, z [m], yaw [rad]."""
    @property
    def velocities(self) -> NDArray[np.float64]:
        """(worlds, robots, 3): forward, left [m/s], turn [rad/s]."""
    @property
    def contacts(self) -> NDArray[np.bool_]:
        """(worlds, robots): a wall or a robot stopped it."""

class DeviceArray:
    """Memory of DeviceWorlds (DeviceWorlds.shared), for torch.from_dlpack and numpy.from_dlpack."""
    @property
    def array(self) -> NDArray[Any] | None:
        """The same memory as an array of NumPy; None for memory of CUDA."""
    @property
    def copied(self) -> bool:
        """It is the host's copy of the device's memory."""
    def __dlpack__(self, **options: Any) -> Any:
        """The memory, which it keeps."""
    def __dlpack_device__(self) -> tuple[int, int]:
        """The host, or a device of CUDA."""

class DeviceWorlds(_WorldStates):
    """Worlds that stay on a Vulkan device: a step is one submission, and nothing is copied back until it is asked for.
    For robots with lasers that commands drive; all else is refused. Arrays are copies, as those of Worlds."""
    def __init__(self, world: str, copies: int = 1, seed: int = 1, text: str | None = None, **options: Any) -> None:
        """options: robots, of, robot_from, noise, accuracy, device and controller="none", as those of Simulation."""
    def readings(self, type: str = "laser") -> NDArray[np.float64]:
        """(worlds, lasers, beams): the newest ranges [m]."""
    def observe(self, *, sensor: str = "laser", every: int = 1, speeds: bool = True, goal_reach: float = 0.0,
                stack: int = 1) -> None:
        """From now on each step also computes `observations`, as Simulation.observe."""
    @property
    def observations(self) -> NDArray[np.float32]:
        """(worlds, agents, columns) in [-1, 1], as Observations.values."""
    @property
    def distances(self) -> NDArray[np.float64]:
        """(worlds, agents) [m] to the goal."""
    @property
    def progress(self) -> NDArray[np.float64]:
        """(worlds, agents) [m]: how much nearer the goal came in the last step."""
    def shared(self, what: str) -> DeviceArray:
        """Returns memory that all steps use, without a copy where host and device share it. what: "observations",
        "distances" or "progress", up to date after `update`; "commands", which step() executes."""
    def update(self) -> None:
        """Brings shared memory up to date after steps, resets and new goals."""
    def set_goals(self, goals: ArrayLike) -> None:
        """goals: (worlds, agents, 2) of x, y [m]; NaN: none."""
    def step(self, commands: ArrayLike | None = None) -> None:
        """One tick of all worlds. commands: (worlds, robots, 3) of forward, left [m/s], turn [rad/s]; None:
        unchanged."""
    def reset(self, seed: int | None = None, mask: ArrayLike | None = None, seeds: ArrayLike | None = None,
              starts: _ByRow = None, present: _ByRow = None, noise: _ByRow = None) -> None:
        """Restarts worlds, as Worlds.reset, but without sizes, slip and acceleration."""
    def __len__(self) -> int:
        """Number of worlds."""

class Worlds(_WorldStates):
    """Worlds with equally many robots, simulated at once; arrays have an axis of worlds. World k has seed + k, and
    gives the bytes of a Simulation of that world alone. Arrays of one file are views, of several files copies."""
    def __init__(self, world: str | Sequence[str], copies: int | Sequence[int] = 1, seed: int = 1,
                 text: str | None = None, **options: Any) -> None:
        """world: a world file, or several; text: the world's text, which `world` then names. copies: of each, or one
        number per file. options: those of Simulation, except ranks, positioning and faults; record: of one file."""
    @property
    def poses7(self) -> NDArray[np.float64]:
        """(worlds, robots, 7): x, y, z [m] and a unit quaternion w, x, y, z. A copy."""
    @property
    def done(self) -> NDArray[np.bool_]:
        """(worlds, robots): its controller is done."""
    @property
    def times(self) -> NDArray[np.float64]:
        """(worlds,): [s] since the start of each."""
    def readings(self, type: str) -> NDArray[np.float64]:
        """(worlds, sensors, elements[, columns]): the newest readings, by world and robot."""
    def observe(self, sensor: str = "laser", **options: Any) -> list[Observations]:
        """Returns one Observations per world file (Simulation.observe)."""
    def step(self, commands: ArrayLike | None = None) -> None:
        """One tick of all worlds. commands: (worlds, robots, 3) of forward, left [m/s], turn [rad/s]; None:
        unchanged."""
    def reset(self, seed: int | None = None, mask: ArrayLike | None = None, seeds: ArrayLike | None = None,
              starts: _ByRow = None, present: _ByRow = None, sizes: _ByRow = None, slip: _ByRow = None,
              acceleration: _ByRow = None, noise: _ByRow = None) -> None:
        """Restarts worlds; the others are unchanged, and no time passes for them. mask: bool (worlds,); None: all.
        seed: world k gets seed + k; seeds: one per world of the mask instead; None: seeds that were not used before.
        The others, of the worlds of the mask, for the first robots or for rows by name: starts (worlds, robots, 4),
        present (worlds, robots), sizes (worlds, robots, 3), slip, acceleration and noise (worlds, robots); NaN and None:
        what the seed chooses."""
    def hash(self, world: int) -> int:
        """Returns the hash of a world's readings since its start."""
    def image(self, world: int, width: int = 640, height: int = 480,
              view: tuple[float, float, float, float] | None = None) -> NDArray[np.uint8]:
        """Returns (height, width, 3): one world from above, as Simulation.image."""
    def __len__(self) -> int:
        """Number of worlds."""
