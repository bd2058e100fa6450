"""Many worlds at once (sensorfarm.Worlds)."""

import ctypes
import os
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy
import sensorfarm

try:
    import torch
except ImportError:
    torch = None

ROOM = """
    interval_sim 100
    define wall model( size [6 0.2 1] )
    wall( pose [0 3 0 0] ) wall( pose [0 -3 0 0] ) wall( pose [3 0 0 90] ) wall( pose [-3 0 0 90] )
    model( name "crate" size [0.5 0.8 1] pose [1 0 0 0] random_pose [0.5 2 90] )
    model( name "post" size [0.2 0.2 1] pose [-1 0 0 0] random_present 0.5 )
    position( name "bot" size [0.3 0.3 0.2] pose [-2 -2 0 0] drive "diff"
      laser( samples 31 fov 180 range_max 5 rate 10 noise [0.01 0 0] ) gyro( noise 0.01 rate 4 latency 0.1 ) )"""


FAKE_CUDA = os.path.join(os.path.dirname(os.path.abspath(os.environ.get("SENSORFARM_PROGRAM", "."))), "tests/libfake_cuda.so")


def uuid_of_the_device():
    """Returns the UUID of Vulkan's first device in hexadecimal digits, or None."""
    try:
        vulkan = ctypes.CDLL("libvulkan.so.1")
    except OSError:
        return None
    application = ctypes.create_string_buffer(struct.pack("<I4xQQI4xQII", 0, 0, 0, 0, 0, 0, (1 << 22) | (2 << 12)))  # Vulkan 1.2
    create = ctypes.create_string_buffer(struct.pack("<I4xQI4xQI4xQI4xQ", 1, 0, 0, ctypes.addressof(application), 0, 0, 0, 0))
    instance, devices, count = ctypes.c_void_p(), (ctypes.c_void_p * 1)(), ctypes.c_uint32(1)
    if vulkan.vkCreateInstance(create, None, ctypes.byref(instance)) != 0:
        return None
    vulkan.vkEnumeratePhysicalDevices(instance, ctypes.byref(count), devices)
    identity = ctypes.create_string_buffer(struct.pack("<I4xQ", 1000071004, 0) + bytes(64))  # VkPhysicalDeviceIDProperties
    properties = ctypes.create_string_buffer(struct.pack("<I4xQ", 1000059001, ctypes.addressof(identity)) + bytes(2000))
    if count.value:
        vulkan.vkGetPhysicalDeviceProperties2(ctypes.c_void_p(devices[0]), properties)
    return identity.raw[16:32].hex() if count.value else None


def room(copies, seed=1, **options):
    return sensorfarm.Worlds("room.world", copies, seed=seed, text=ROOM, **{"robots": 2, **options})


def alone(seed, **options):
    return sensorfarm.Simulation.from_text(ROOM, "room.world", seed=seed, **{"robots": 2, **options})


def drive(worlds, steps):
    """Commands that depend on the readings of each world alone."""
    for _ in range(steps):
        scans = worlds.readings("laser")
        twists = numpy.zeros((*scans.shape[:-2], worlds.poses.shape[-2], 3))
        twists[..., :scans.shape[-2], 0] = numpy.where(scans.min(axis=-1) < 0.6, 0.0, 0.3)
        twists[..., :scans.shape[-2], 2] = numpy.where(scans.min(axis=-1) < 0.6, 0.8, 0.1)
        worlds.step(twists)


class Copies(unittest.TestCase):
    def test_bytes_are_those_of_worlds_alone(self):
        worlds = room(5, seed=3)
        drive(worlds, 25)
        for k in range(5):
            one = alone(3 + k)
            drive(one, 25)
            self.assertEqual(worlds.hash(k), one.hash, k)
            numpy.testing.assert_array_equal(worlds.poses[k], one.poses[:2])
            numpy.testing.assert_array_equal(worlds.contacts[k], one.contacts[:2])

    def test_worlds_differ_by_their_seeds(self):
        worlds = room(40)
        crates = worlds.parts[0].poses.reshape(40, -1, 4)[:, 2]
        self.assertEqual(len({tuple(pose) for pose in crates}), 40)
        self.assertTrue((numpy.abs(crates[:, 1]) <= 2).all() and (numpy.abs(crates[:, 0] - 1) <= 0.5).all())
        present = worlds.parts[0].present.reshape(40, -1)
        self.assertTrue(present[:, :3].all())
        self.assertTrue(8 <= present[:, 3].sum() <= 32, "half of the posts are there")

    def test_threads_change_nothing(self):
        hashes = []
        for threads in (1, 3):
            worlds = room(9, threads=threads)
            drive(worlds, 10)
            hashes.append([worlds.hash(k) for k in range(9)])
        self.assertEqual(*hashes)

    def test_several_files(self):
        with tempfile.TemporaryDirectory() as folder:
            files = [os.path.join(folder, name) for name in ("a.world", "b.world")]
            for file, end in zip(files, ("", "\nwall( pose [0 2 0 45] )")):
                with open(file, "w") as out:
                    out.write(ROOM + end)
            worlds = sensorfarm.Worlds(files, copies=[2, 1], robots=3, seed=5)
            one = sensorfarm.Simulation(files[1], robots=3, seed=7)
            with self.assertRaisesRegex(ValueError, "1 numbers of copies for 2 worlds"):
                sensorfarm.Worlds(files, copies=[2])
        self.assertEqual((len(worlds), worlds.poses.shape, worlds.readings("laser").shape), (3, (3, 3, 4), (3, 3, 31)))
        drive(worlds, 5), drive(one, 5)
        self.assertEqual(worlds.hash(2), one.hash)
        worlds.reset(mask=numpy.array([True, False, True]), seeds=[8, 9])
        numpy.testing.assert_allclose(worlds.times, [0.0, 0.5, 0.0])
        self.assertEqual(worlds.seeds.tolist(), [8, 6, 9])


class Arrays(unittest.TestCase):
    """What worlds start with by arrays instead of by their seeds."""

    def test_objects_by_name(self):
        worlds = room(4)
        sizes = numpy.array([[0.6, 0.8, 1], [0.3, 0.4, 1]])
        worlds.reset(mask=numpy.array([True, False, True, False]), seeds=[5, 6], sizes={"crate": sizes},
                     present={"post": [0, 1]}, starts={"crate": [[1, 1, 0, 0], [1, -1, 0, 0]]})
        part = worlds.parts[0]
        numpy.testing.assert_allclose(part.radii.reshape(4, -1)[::2, 2], [0.5, 0.25])
        self.assertEqual(part.present.reshape(4, -1)[::2, 3].tolist(), [False, True])
        self.assertEqual(part.poses.reshape(4, -1, 4)[::2, 2, 1].tolist(), [1, -1])

    def test_sizes_are_sensed(self):
        worlds = room(2, robots=1)
        starts = {"bot1": [0, 0, 0, 0], "crate": [1, 0, 0, 0]}
        worlds.reset(seed=1, starts=starts, sizes={"crate": [[1, 1, 1], [0.5, 0.5, 1]]})
        numpy.testing.assert_allclose(worlds.readings("laser")[:, 0, 15], [0.5, 0.75], atol=0.06)

    def test_robots_by_arrays(self):
        worlds = room(3)
        slip = numpy.array([[0.0, 0.5], [numpy.nan, numpy.nan], [0.2, 0.0]])
        worlds.reset(seed=1, slip=slip, noise=numpy.zeros((3, 2)))
        worlds.step(numpy.tile([0.1, 0.0, 0.0], (3, 2, 1)))
        numpy.testing.assert_allclose(worlds.velocities[..., 0], 0.1 * (1 - numpy.nan_to_num(slip)))

    def test_refusals(self):
        worlds = room(2)
        before = [worlds.hash(k) for k in range(2)]
        wall = next(name for name in worlds.parts[0].models if name not in {row.name for row in worlds.parts[0].robots})
        for message, given in (("there is no 'box'; expected one of bot1, bot2, crate, post", {"sizes": {"box": [1, 1, 1]}}),
                               ("is static, so all worlds share it", {"sizes": {wall: [1, 1, 1]}}),
                               ("sizes by name", {"sizes": {"crate": [1, 1]}}),
                               ("slip has the shape", {"slip": [0.1, 0.1]}),
                               ("slip has the shape", {"slip": numpy.zeros((2, 1))}),
                               ("the size of 'crate' is", {"sizes": {"crate": [-1, 1, 1]}}),
                               ("the noise of 'bot2' is 2", {"noise": {"bot2": 2}})):
            with self.assertRaisesRegex((ValueError, sensorfarm.Error), message):
                worlds.reset(seed=3, **given)
        self.assertEqual([worlds.hash(k) for k in range(2)], before)
        self.assertEqual(worlds.seeds.tolist(), [1, 2])

    def test_one_world_is_recorded(self):
        with tempfile.TemporaryDirectory() as folder:
            worlds = room(3, seed=4, record=os.path.join(folder, "run"), record_world=1)
            drive(worlds, 5)
            worlds.parts[0].finish_recording()
            one = alone(5, record=os.path.join(folder, "one"))
            drive(one, 5)
            one.finish_recording()
            files = [os.path.join(folder, name, "run.mcap") for name in ("run", "one")]
            sizes = [os.path.getsize(file) for file in files]
        self.assertEqual(*sizes)


class Resets(unittest.TestCase):
    def test_a_mask_restarts_only_its_worlds(self):
        worlds = room(4)
        drive(worlds, 7)
        before, others = [worlds.hash(k) for k in range(4)], worlds.readings("laser")[[0, 2]].copy()
        worlds.reset(mask=numpy.array([False, True, False, True]), seeds=[50, 60])
        numpy.testing.assert_allclose(worlds.times, [0.7, 0.0, 0.7, 0.0])
        self.assertEqual([worlds.hash(k) for k in (0, 2)], [before[0], before[2]])
        numpy.testing.assert_array_equal(worlds.readings("laser")[[0, 2]], others)
        for k, seed in ((1, 50), (3, 60)):
            numpy.testing.assert_array_equal(worlds.readings("laser")[k], alone(seed).readings("laser"))
        drive(worlds, 6)
        for k, seed, steps in ((0, 1, 13), (1, 50, 6), (2, 3, 13), (3, 60, 6)):
            one = alone(seed)
            drive(one, steps)
            self.assertEqual(worlds.hash(k), one.hash, k)

    def test_given_starts(self):
        worlds = room(3)
        starts = numpy.array([[[-2, 1, 0, 0.5], [-2, -1, 0, -0.5]]])
        worlds.reset(mask=numpy.arange(3) == 2, starts=starts)
        numpy.testing.assert_array_equal(worlds.poses[2], starts[0])

    def test_seeds_are_not_used_twice(self):
        worlds = room(3)
        worlds.reset()
        worlds.reset(mask=numpy.arange(3) == 1)
        self.assertEqual(worlds.seeds.tolist(), [4, 8, 6])

    def test_faults(self):
        worlds = room(3)
        for wrong in (dict(mask=numpy.ones(2, bool)), dict(seeds=[1]), dict(starts=numpy.zeros((1, 4, 4)))):
            with self.assertRaises(Exception):
                worlds.reset(**wrong)
        for arguments, message in ((([3], [1]), "no world 3; expected less than 3"), (([1, 1], [1, 2]), "given twice"),
                                   (([0], []), "0 seeds for 1 worlds")):
            with self.assertRaisesRegex(sensorfarm.Error, message):
                worlds.parts[0].restart(*arguments)
        for wrong in (dict(seed=-5), dict(seeds=[0.5, 1, 2])):
            with self.assertRaisesRegex(ValueError, "whole numbers from 0 on"):
                worlds.reset(**wrong)
        with self.assertRaisesRegex(ValueError, r"shape \(3, 4\)"):
            worlds.step(numpy.zeros((3, 4)))
        with self.assertRaisesRegex(sensorfarm.Error, "there is no world 2 to record"):
            room(2, record="out/never", record_world=2)


class Observed(unittest.TestCase):
    def test_columns(self):
        worlds = room(3)
        seen, = worlds.observe(every=10, goal_reach=8.0, stack=2)
        self.assertEqual(seen.values.shape, (6, 2 * (4 + 2 + 3)))
        seen.goals[:] = [[0.0, 0.0]]
        first = seen.values.copy()
        drive(worlds, 1)
        scans = worlds.readings("laser").reshape(6, -1)[:, ::10]
        numpy.testing.assert_allclose(seen.values[:, :4], scans / 5.0, atol=1e-6)
        numpy.testing.assert_array_equal(seen.values[:, 9:], first[:, :9])
        poses = worlds.parts[0].poses[seen.rows]
        bearings = numpy.arctan2(-poses[:, 1], -poses[:, 0]) - poses[:, 3]
        numpy.testing.assert_allclose(seen.values[:, 6], numpy.hypot(poses[:, 0], poses[:, 1]) / 8, atol=1e-6)
        numpy.testing.assert_allclose(seen.values[:, 7:9], numpy.stack([numpy.cos(bearings), numpy.sin(bearings)], 1),
                                      atol=1e-6)

    def test_progress_and_ages(self):
        worlds = room(2)
        seen, = worlds.observe(goal_reach=5.0)
        seen.goals[:] = [[0.0, 0.0]]
        seen.update()
        before = seen.distances.copy()
        drive(worlds, 1)
        numpy.testing.assert_allclose(seen.progress, before - seen.distances)
        worlds.reset(mask=numpy.array([True, False]))
        self.assertEqual(seen.ages.tolist(), [0, 0, 1, 1])
        self.assertEqual(seen.progress[:2].tolist(), [0.0, 0.0])

    def test_a_restart_fills_the_stack(self):
        worlds = room(2)
        seen, = worlds.observe(stack=3)
        drive(worlds, 4)
        worlds.reset(mask=numpy.array([False, True]))
        stacked = seen.values[2:].reshape(2, 3, -1)
        numpy.testing.assert_array_equal(stacked[:, 1], stacked[:, 0])
        numpy.testing.assert_array_equal(stacked[:, 2], stacked[:, 0])

    def test_shared_through_dlpack(self):
        worlds = room(3)
        seen, = worlds.observe()
        shared = numpy.from_dlpack(seen)
        self.assertTrue(numpy.shares_memory(shared, seen.values))
        drive(worlds, 2)
        numpy.testing.assert_array_equal(shared, seen.values, "written in place")
        kept = seen.values.copy()
        del worlds, seen
        numpy.testing.assert_array_equal(shared, kept, "the array keeps the memory")

    @unittest.skipIf(torch is None, "needs python3-torch")
    def test_shared_with_torch(self):
        worlds, twin = room(3), room(3)
        seen, = worlds.observe()
        shared = torch.from_dlpack(seen)
        self.assertEqual(shared.data_ptr(), seen.values.ctypes.data)
        commands = torch.zeros(3, 2, 3, dtype=torch.float64)
        for step in range(3):
            commands[..., 0] = 0.1 * step - 0.1 * shared[:, 0].double().reshape(3, 2)
            worlds.step(commands)
            twin.step(commands.numpy().copy())
        self.assertEqual([worlds.hash(k) for k in range(3)], [twin.hash(k) for k in range(3)])


class OnADevice(unittest.TestCase):
    """The bytes are compared with those of simulations in tests/library/device_worlds_test.cpp."""
    TEXT = ROOM.replace("gyro( noise 0.01 rate 4 latency 0.1 )", "")

    def both(self, **options):
        options = {"copies": 3, "seed": 4, "text": self.TEXT, "robots": 2, **options}
        return sensorfarm.DeviceWorlds("room.world", **options), sensorfarm.Worlds("room.world", **options)

    def test_equals_worlds(self):
        device, host = self.both()
        device.observe(every=5, goal_reach=4.0, stack=3)
        seen, = host.observe(every=5, goal_reach=4.0, stack=3)
        goals = numpy.linspace(-2, 2, 12).reshape(3, 2, 2)
        device.set_goals(goals)
        seen.goals[:] = goals.reshape(-1, 2)
        seen.update()
        mask = numpy.array([False, True, False])
        for step in range(8):
            if step == 4:
                given = {"starts": [[[0.5, 0.4, 0.0, 1.0], [numpy.nan] * 4]], "noise": {"bot1": [0.5]}}
                device.reset(mask=mask, **given), host.reset(mask=mask, **given)
            commands = numpy.full((3, 2, 3), [0.4, 0.0, 0.2 * step])
            device.step(commands), host.step(commands)
        self.assertEqual(device.observations.shape[:2], (3, 2))
        for own, other in ((device.poses, host.poses), (device.velocities, host.velocities),
                           (device.contacts, host.contacts), (device.readings("laser"), host.readings("laser")),
                           (device.observations, seen.values.reshape(3, 2, -1)), (device.seeds, host.seeds),
                           (device.progress, seen.progress.reshape(3, 2)),
                           (device.distances, seen.distances.reshape(3, 2))):
            self.assertEqual(own.dtype, other.dtype)
            numpy.testing.assert_array_equal(own, other)
        self.assertTrue((device.progress != 0).any())

    def test_shared_memory(self):
        """Kernels write what NumPy sees: the address stays the same over steps and a reset."""
        device = self.both()[0]
        device.observe(goal_reach=4.0, stack=2)
        device.set_goals(numpy.ones((3, 2, 2)))
        results = {name: device.shared(name) for name in ("observations", "distances", "progress")}
        self.assertEqual(results["observations"].__dlpack_device__(), (1, 0))
        arrays = {name: numpy.from_dlpack(shared) for name, shared in results.items()}
        for step in range(3):
            device.step(numpy.full((3, 2, 3), [0.3, 0.0, 0.1 * step]))
            before = {name: array.copy() for name, array in arrays.items()}
            if step == 2:
                device.reset(mask=[True, False, True])
            device.update()
            if step < 2 and not results["observations"].copied:  # the kernels write this memory: no copy was needed
                for name, array in arrays.items():
                    numpy.testing.assert_array_equal(before[name], array, name)
            for name, array in arrays.items():
                self.assertTrue(numpy.shares_memory(array, results[name].array))
                self.assertTrue(numpy.shares_memory(array, device.shared(name).array))
                numpy.testing.assert_array_equal(array, getattr(device, name), name)
        self.assertTrue((arrays["progress"][1] != 0).any())
        kept = arrays["observations"].copy()
        del device, results
        numpy.testing.assert_array_equal(arrays["observations"], kept, "the array keeps the memory")

    @unittest.skipUnless(os.path.exists(FAKE_CUDA), "needs the library fake_cuda of the C++ tests")
    def test_shared_with_cuda(self):
        """Capsules of CUDA's memory, by a libcuda of the tests, in a process that treats the device as a GPU."""
        if (uuid := uuid_of_the_device()) is None:
            self.skipTest("needs a Vulkan loader")
        program = f"""
import ctypes, struct, sensorfarm
worlds = sensorfarm.DeviceWorlds("room.world", copies=3, robots=2, text={self.TEXT!r})
pointer = ctypes.pythonapi.PyCapsule_GetPointer
pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
shared = worlds.shared("commands")
if shared.__dlpack_device__() == (1, 0):  # no VK_KHR_external_memory_fd
    assert shared.copied and shared.array is not None
    raise SystemExit
capsule = shared.__dlpack__(stream=1)
fields = struct.unpack("<QiiiBBHQQQ", ctypes.string_at(pointer(capsule, b"dltensor"), 48))
assert fields[1:7] == (2, 0, 3, 2, 64, 1), fields
assert [list((ctypes.c_int64 * 3).from_address(field)) for field in fields[7:9]] == [[3, 2, 3], [16, 4, 1]]
assert shared.__dlpack_device__() == (2, 0) and shared.array is None and not shared.copied
held = ctypes.CDLL({FAKE_CUDA!r}).fake_cuda_held
del shared, worlds
assert held() > 0, "the capsule keeps the memory"
del capsule
assert held() == 0, held()
"""
        environment = {**os.environ, "SENSORFARM_LIBCUDA": FAKE_CUDA, "FAKE_CUDA_UUID": uuid, "SENSORFARM_STAGING": "1"}
        subprocess.run([sys.executable, "-c", program], env=environment, check=True)

    def test_shared_commands(self):
        """What a consumer writes moves the robots, as the same commands given; NaN counts as 0."""
        device, host = self.both()
        commands = device.shared("commands")
        written = numpy.asarray(commands.array) if torch is None else torch.from_dlpack(commands)
        written[:] = 0.0
        written[..., 0] = 0.4
        written[1, 0, 2] = 0.5
        written[2, 1, 0] = numpy.nan
        given = numpy.array(commands.array)
        self.assertEqual((given[0, 0, 0], given[1, 0, 2]), (0.4, 0.5))
        given[2, 1, 0] = 0.0
        for _ in range(2):
            device.step(), host.step(given)
        numpy.testing.assert_array_equal(device.poses, host.poses)
        device.step(2 * given), host.step(2 * given)
        self.assertEqual(float(written[1, 0, 2]), 1.0, "given commands are written to the same memory")
        device.reset(mask=[False, True, False])
        self.assertEqual(float(written[1, 0, 2]), 0.0, "worlds start without commands")
        self.assertEqual(float(written[0, 0, 0]), 0.8)

    def test_refusals(self):
        with self.assertRaisesRegex(sensorfarm.Error, "sensors of type 'gyro'; use Simulation with copies .in Python: Worlds"):
            self.both(text=ROOM)
        with self.assertRaisesRegex(sensorfarm.DeviceError, "a Vulkan device is required"):
            self.both(device="host")
        device = self.both()[0]
        with self.assertRaisesRegex(ValueError, r"commands have the shape \(2, 3\); expected \(3, 2, 3\)"):
            device.step(numpy.zeros((2, 3)))
        with self.assertRaisesRegex(ValueError, "mask has the shape"):
            device.reset(mask=[True])
        with self.assertRaisesRegex(sensorfarm.Error, "call observe first"):
            device.observations
        with self.assertRaisesRegex(sensorfarm.Error, "call observe first"):
            device.shared("progress")
        with self.assertRaisesRegex(ValueError, "'poses' is not shared; expected one of observations, commands"):
            device.shared("poses")


if __name__ == "__main__":
    unittest.main()
