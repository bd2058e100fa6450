"""Many worlds at once, as arrays with an axis of worlds."""

import numpy

from ._sensorfarm import Simulation, _DeviceTable, _DeviceWorlds


_SHAPES = {"starts": (4,), "present": (), "sizes": (3,), "slip": (), "acceleration": (), "noise": ()}


def _checked(what, given, worlds, robots):
    """Returns the arrays of an argument of `reset` with a row per world."""
    if given is None:
        return None
    shape = _SHAPES[what]
    if not isinstance(given, dict):
        given = numpy.asarray(given, dtype=float)
        if given.shape[:1] != (worlds,) or given.ndim != 2 + len(shape) or given.shape[2:] != shape or given.shape[1] < robots:
            raise ValueError(f"{what} has the shape {given.shape}; expected {(worlds, robots, *shape)}, or a dict by name")
        return given
    try:
        return {name: numpy.broadcast_to(numpy.asarray(values, dtype=float), (worlds, *shape))
                for name, values in given.items()}
    except ValueError as error:
        raise ValueError(f"{what} by name: {error}; expected the shape {(worlds, *shape)} for each name") from None


def _all_checked(worlds, robots, **given):
    return {what: _checked(what, values, worlds, robots) for what, values in given.items()}


def _checked_commands(commands, worlds, robots):
    commands = numpy.asarray(commands, dtype=float)
    if commands.shape != (worlds, robots, 3):
        raise ValueError(f"commands have the shape {commands.shape}; expected ({worlds}, {robots}, 3)")
    return commands


def _row_of(part, name):
    """Returns the row of a robot or object."""
    names = [robot.name for robot in part.robots]
    if name in names:
        return names.index(name)
    if name in getattr(part, "models", ()):
        raise ValueError(f"'{name}' is static, so all worlds share it; expected a robot, or a model that a key such as "
                         "random_present 1 makes an object of each world")
    raise ValueError(f"there is no '{name}'; expected one of {', '.join(names)}")


def _chosen(last, seed, mask, seeds):
    """Returns the numbers of the worlds that restart, and their seeds. last: the present seeds of all."""
    count = len(last)
    chosen = numpy.arange(count) if mask is None else numpy.flatnonzero(mask)
    if mask is not None and numpy.shape(mask) != (count,):
        raise ValueError(f"mask has the shape {numpy.shape(mask)}; expected ({count},)")
    if seeds is None:
        seeds = last[chosen] + count if seed is None else seed + chosen
    seeds = numpy.asarray(seeds)
    if seeds.size and (seeds.dtype.kind not in "iu" or seeds.min() < 0):
        raise ValueError(f"seeds are {seeds}; expected whole numbers from 0 on")
    if seeds.shape != chosen.shape:
        raise ValueError(f"seeds have the shape {seeds.shape}; expected one for each of {len(chosen)} worlds")
    return chosen, seeds


def _all_rows(part, rows, other):
    """Returns (worlds, rows of the part, ...) with `rows` first, and then `other`."""
    if rows.shape[1] == len(part.robots):
        return rows
    full = numpy.full((len(rows), len(part.robots), *rows.shape[2:]), other)
    full[:, :rows.shape[1]] = rows
    return full


def _given(part, what, given, chosen):
    """Returns starts of worlds as an array (len(chosen), rows of the part, ...); NaN: the seed chooses.
    chosen: indices of the worlds among those that are restarted."""
    if given is None:
        return None
    shape = _SHAPES[what]
    if not isinstance(given, dict):
        return _all_rows(part, given[chosen], numpy.nan)
    full = numpy.full((len(chosen), len(part.robots), *shape), numpy.nan)
    for name, values in given.items():
        full[:, _row_of(part, name)] = values[chosen]
    return full


class Worlds:
    """Worlds with equally many robots, simulated at once.

        worlds = sensorfarm.Worlds("rooms.world", copies=1000, robots=1)
        while True:
            commands = policy(worlds.readings("laser"))  # (worlds, robots, elements) -> (worlds, robots, 3)
            worlds.step(commands)
            worlds.reset(mask=worlds.contacts.any(axis=1))

    World k has seed + k, and gives the bytes of a Simulation of that world alone with this seed. The copies of one
    world file share its walls and settings; they do not see each other. Arrays of one file are views, as those of
    Simulation; of several files, copies.

    Rows are the `robots` that were asked for, or all of the file, with its objects; `parts` has one Simulation per
    file, with all rows.

    world: a world file, or several; text: the world's text, which `world` then names. copies: of each, or one number
    per file. Further options are those of Simulation, except ranks, positioning and faults. record: of one file, the
    world record_world, as a Simulation of it alone would, until it restarts.
    """

    def __init__(self, world, copies=1, seed=1, text=None, **options):
        files = [world] if isinstance(world, str) else list(world)
        counts = [copies] * len(files) if numpy.isscalar(copies) else list(copies)
        if not files or len(counts) != len(files) or (text is not None and len(files) > 1):
            raise ValueError(f"{len(counts)} numbers of copies for {len(files)} worlds; expected as many, and a text only "
                             "for one")
        if options.get("record") and len(files) > 1:
            raise ValueError("worlds of several files cannot be recorded; expected one file")
        self._first = numpy.concatenate([[0], numpy.cumsum(counts)]).astype(int)
        make = Simulation if text is None else lambda name, **given: Simulation.from_text(text, name, **given)
        self.parts = [make(file, copies=count, seed=seed + int(first), **options)
                      for file, count, first in zip(files, counts, self._first)]
        self.seeds = numpy.arange(seed, seed + len(self))
        rows = {options.get("robots") or len(part.robots) for part in self.parts}
        if len(rows) != 1:
            raise ValueError(f"the worlds have {' and '.join(map(str, sorted(rows)))} rows; expected equal numbers: set "
                             "`robots`")
        self.robots = self.parts[0].robots[:rows.pop()]
        self.interval = self.parts[0].interval

    def __len__(self):
        return int(self._first[-1])

    def _rows(self, arrays):
        return self._by_world(arrays, len(self.robots))

    def _by_world(self, arrays, kept=None):
        shaped = [array.reshape(part.copies, -1, *array.shape[1:])[:, :kept] for array, part in zip(arrays, self.parts)]
        return shaped[0] if len(shaped) == 1 else numpy.concatenate(shaped)

    poses = property(lambda self: self._rows([part.poses for part in self.parts]),
                     doc="(worlds, robots, 4): x, y, z [m], yaw [rad].")
    poses7 = property(lambda self: self._rows([part.poses7 for part in self.parts]),
                      doc="(worlds, robots, 7): x, y, z [m] and a unit quaternion w, x, y, z; a copy.")
    velocities = property(lambda self: self._rows([part.velocities for part in self.parts]),
                          doc="(worlds, robots, 3): forward, left [m/s], turn [rad/s].")
    contacts = property(lambda self: self._rows([part.contacts for part in self.parts]),
                        doc="(worlds, robots): stopped by a wall or a robot.")
    done = property(lambda self: self._rows([part.done for part in self.parts]),
                    doc="(worlds, robots): the controller is done.")

    @property
    def times(self):
        """(worlds,): [s] since the start of each."""
        return numpy.array([part.time_of(k) for part in self.parts for k in range(part.copies)])

    def readings(self, type):
        """Returns (worlds, sensors, elements[, columns]): the newest readings, by world and robot."""
        return self._by_world([part.readings(type) for part in self.parts])

    def observe(self, sensor="laser", **options):
        """Returns one Observations per world file (Simulation.observe)."""
        return [part.observe(sensor, **options) for part in self.parts]

    def step(self, commands=None):
        """One tick of all worlds. commands: (worlds, robots, 3): forward, left [m/s], turn [rad/s]; None: unchanged."""
        if commands is None:
            shares = [None] * len(self.parts)
        else:
            commands = _checked_commands(commands, len(self), len(self.robots))
            shares = [_all_rows(part, commands[a:b], 0.0).reshape(-1, 3)
                      for part, a, b in zip(self.parts, self._first, self._first[1:])]
        for part, share in zip(self.parts, shares):
            part.step(share)

    def reset(self, seed=None, mask=None, seeds=None, starts=None, present=None, sizes=None, slip=None,
              acceleration=None, noise=None):
        """Restarts worlds; the others are unchanged, and no time passes for them.

        mask: bool (worlds,); None: all. seed: world k gets seed + k; seeds: one per world of the mask instead. None:
        seeds as far from the last ones as there are worlds, so that none is used twice.

        What the seeds would choose, or the world file says, may be given: starts, poses (x, y, z [m], yaw [rad]);
        present, 0 or 1, and sizes (x, y, z [m]) of objects; of robots slip, the part of its wheels' way that a robot
        does not advance, in [0, 0.9], and the factors acceleration, of its acceleration_bounds, in [0.01, 1], and
        noise, of all normally distributed errors of its sensors, in [0, 1]. Each is an array (worlds of the mask,
        robots, numbers), or a dict of these without the axis of robots by the name of a robot or an object, such as
        sizes={"crate": [0.5, 0.4, 1]}. NaN: the seed's choice.
        """
        chosen, seeds = _chosen(self.seeds, seed, mask, seeds)
        given = _all_checked(len(chosen), len(self.robots), starts=starts, present=present, sizes=sizes, slip=slip,
                             acceleration=acceleration, noise=noise)
        shares = []
        for part, a, b in zip(self.parts, self._first, self._first[1:]):
            own = numpy.flatnonzero((chosen >= a) & (chosen < b))
            if len(own):
                shares.append((part, chosen[own] - a, seeds[own],
                               {what: _given(part, what, values, own) for what, values in given.items()}))
        for part, worlds, own_seeds, own in shares:
            part.restart(worlds, own_seeds, own.pop("starts"), **own)
        self.seeds[chosen] = seeds

    def hash(self, world):
        """Returns the hash of a world's readings since its start."""
        part, k = self._part_of(world)
        return part.hash_of(k)

    def _part_of(self, world):
        if not 0 <= world < len(self):
            raise IndexError(f"there is no world {world}; expected less than {len(self)}")
        number = int(numpy.searchsorted(self._first, world, side="right")) - 1
        return self.parts[number], int(world - self._first[number])

    def image(self, world, width=640, height=480, view=None):
        """Returns (height, width, 3) uint8: one world from above."""
        part, k = self._part_of(world)
        return part.image(width, height, view, world=k)


class DeviceWorlds:
    """Worlds that stay on a Vulkan device: a step is one submission, and nothing is copied back until it is asked for.

        worlds = sensorfarm.DeviceWorlds("rooms.world", copies=1000, robots=1)
        worlds.observe(every=4, goal_reach=10.0)
        worlds.set_goals(goals)                          # (worlds, agents, 2)
        while True:
            worlds.step(policy(worlds.observations))     # (worlds, agents, columns) -> (worlds, robots, 3)
            worlds.reset(mask=worlds.contacts.any(axis=1))

    For robots with lasers that commands drive; all else is refused, and simulated by Worlds, to the same bytes. Arrays
    are copies, with rows as those of Worlds. World k has seed + k.

    options: robots, of, robot_from, noise, accuracy, device and controller="none", as those of Simulation.
    """

    def __init__(self, world, copies=1, seed=1, text=None, **options):
        self._farm = _DeviceWorlds(world, text, copies=copies, seed=seed, **options)
        self._all = len(self._farm.robots)
        self.robots = self._farm.robots[:options.get("robots") or self._all]
        self.interval = self._farm.interval
        self.seeds = numpy.arange(seed, seed + copies)

    def __len__(self):
        return len(self.seeds)

    poses = property(lambda self: self._farm.poses()[:, :len(self.robots)], doc=Worlds.poses.__doc__)
    velocities = property(lambda self: self._farm.velocities()[:, :len(self.robots)], doc=Worlds.velocities.__doc__)
    contacts = property(lambda self: self._farm.contacts()[:, :len(self.robots)], doc=Worlds.contacts.__doc__)

    def readings(self, type="laser"):
        """Returns (worlds, lasers, beams): the newest ranges [m]."""
        if type != "laser":
            raise ValueError(f"there are no readings of type '{type}'; expected 'laser'")
        return self._farm.readings()

    def observe(self, **options):
        """From now on each step also computes `observations`, with the options of Simulation.observe."""
        self._farm.observe(**options)

    observations = property(lambda self: self._farm.observations(), doc="(worlds, agents, columns) float32 in [-1, 1].")
    distances = property(lambda self: self._farm.distances(), doc="(worlds, agents) [m] to the goal.")
    progress = property(lambda self: self._farm.progress(),
                        doc="(worlds, agents) [m]: how much nearer the goal came in the last step.")

    def set_goals(self, goals):
        """goals: (worlds, agents, 2) of x, y [m]; NaN: none."""
        self._farm.set_goals(goals)

    def shared(self, what):
        """Returns memory that all steps use as a DeviceArray, for torch.from_dlpack(worlds.shared("observations")).

        what: "observations", "distances" or "progress", as the properties: up to date after `update`, until the next
        step; a later `observe` leaves them behind. "commands": (worlds, robots, 3), which step() without an argument
        executes; numbers that are not finite count as 0. Without a copy where host and device share their memory
        (lavapipe, integrated GPUs), and as memory of CUDA where libcuda knows the device (not run on hardware:
        docs/python.md); elsewhere (`copied`) a step copies commands to the device, `update` results back.
        """
        tables = _DeviceTable.__members__
        if what not in tables:
            raise ValueError(f"'{what}' is not shared; expected one of {', '.join(tables)}")
        return self._farm.shared(tables[what], len(self.robots) if what == "commands" else 0)

    def update(self):
        """Brings shared memory up to date after steps, resets and new goals."""
        self._farm.update()

    def step(self, commands=None):
        """One tick of all worlds. commands: (worlds, robots, 3): forward, left [m/s], turn [rad/s]; None: unchanged."""
        if commands is not None:
            commands = _checked_commands(commands, len(self), len(self.robots))
            commands = numpy.pad(commands, ((0, 0), (0, self._all - len(self.robots)), (0, 0)))
        self._farm.step(commands)

    def reset(self, seed=None, mask=None, seeds=None, starts=None, present=None, noise=None):
        """Restarts worlds, as Worlds.reset; the others are unchanged. Reading them before the next step scans again.
        Sizes, slip and acceleration cannot be given."""
        chosen, seeds = _chosen(self.seeds, seed, mask, seeds)
        given = _all_checked(len(chosen), len(self.robots), starts=starts, present=present, noise=noise)
        given = {what: _given(self._farm, what, values, numpy.arange(len(chosen))) for what, values in given.items()}
        self._farm.restart(chosen, seeds, given.pop("starts"), **given, sizes=None, slip=None, acceleration=None)
        self.seeds[chosen] = seeds
