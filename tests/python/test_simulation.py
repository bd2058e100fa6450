"""sensorfarm.Simulation: arrays, options, errors."""

import math
import os
import sys
import tempfile
import threading
import unittest

import numpy
import sensorfarm

CAVE = "worlds/cave.world"
ROOM = """
resolution 0.02
model( name "walls" size [4 4 1] boundary 1 obstacle_return 1 )
define body position
( size [0.3 0.3 0.2] drive "omni" block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 0.2] ) )
body( name "lead" pose [-1 0 0 0] laser( pose [0 0 -0.15 0] samples 5 fov 90 range_max 3 ) )
body( name "next" pose [1 0 0 0] laser( pose [0 0 -0.15 0] samples 3 fov 90 range_max 3 rate 5 ) gps() sonar( scount 2 spose[0] [0 0 0] spose[1] [0 0 90] ) )
"""


def address(array):
    return array.__array_interface__["data"][0]


def room(**options):
    return sensorfarm.Simulation.from_text(ROOM, noise=False, **options)


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sim = sensorfarm.Simulation(CAVE, robots=20, seed=3)

    def test_shapes_and_types(self):
        sim, n, beams = self.sim, 20, 361
        for array, shape, kind in ((sim.poses, (n, 4), "f8"), (sim.velocities, (n, 3), "f8"), (sim.contacts, (n,), "?"),
                                   (sim.done, (n,), "?"), (sim.readings("laser"), (n, beams), "f8"),
                                   (sim.hits("laser"), (n, beams), "u4"), (sim.flags("laser"), (n, beams), "u1"),
                                   (sim.bounds("laser"), (n,), "f8"), (sim.times("laser"), (n,), "f8"),
                                   (sim.rows("laser"), (n,), "u4"), (sim.fresh("laser"), (n,), "?")):
            self.assertEqual((array.shape, array.dtype), (shape, numpy.dtype(kind)))
            self.assertFalse(array.flags.owndata)
            self.assertFalse(array.flags.writeable)

    def test_views_share_memory(self):
        """A view shows the newest tick: its address does not change, its content does."""
        sim = sensorfarm.Simulation(CAVE, robots=20, seed=3)
        names = ("poses", "velocities", "contacts")
        of_type = ("readings", "hits", "bounds", "times", "fresh", "flags")

        def all_views():
            return [getattr(sim, name) for name in names] + [getattr(sim, name)("laser") for name in of_type]
        before = all_views()
        old = [view.copy() for view in before]
        sim.step(numpy.full((20, 3), 0.2))
        self.assertEqual([address(view) for view in before], [address(view) for view in all_views()])
        for i in (0, 3):  # poses, readings
            self.assertTrue((before[i] != old[i]).any())

    def test_views_outlive_the_simulation(self):
        sim = sensorfarm.Simulation(CAVE, robots=20, seed=3)
        view, kept = sim.readings("laser"), sim.readings("laser").copy()
        sim.reset(4)
        self.assertTrue((view == kept).all())
        self.assertTrue((sim.readings("laser") != kept).any())
        del sim
        self.assertTrue((view == kept).all())

    def test_dlpack(self):
        sim = room(writable=True)
        for array in (sim.poses, sim.readings("laser"), sim.bounds("laser")):
            shared = numpy.from_dlpack(array)
            self.assertEqual(address(shared), address(array))
            numpy.testing.assert_array_equal(shared, array)
        before = numpy.from_dlpack(sim.poses)
        sim.put(0, (0.5, 0.5, 0, 1))
        sim.step()
        numpy.testing.assert_allclose(before[0], (0.5, 0.5, 0, 1))

    def test_poses7(self):
        sim = room()
        half = math.sqrt(0.5)
        sim.put(0, (0.5, 0.5, 0.25, half, 0, half, 0))  # its nose points down
        numpy.testing.assert_allclose(sim.poses7[0], (0.5, 0.5, 0.25, half, 0, half, 0), atol=1e-15)
        sim.put(0, (0.5, 0.5, 0, 1))
        numpy.testing.assert_array_equal(sim.poses7[0], (0.5, 0.5, 0, math.cos(0.5), 0, 0, math.sin(0.5)))
        for error, pose in ((TypeError, (0, 0, 0)), (TypeError, (0, 0, 0, 1, 0)),
                            (sensorfarm.Error, (0, 0, 0, 2, 0, 0, 0)), (sensorfarm.Error, (0, 0, 0, math.nan, 0, 0, 0))):
            with self.assertRaises(error, msg=pose):
                sim.put(0, pose)
        self.assertEqual(sim.poses7.shape, (len(sim), 7))

    def test_the_interpreter_runs_during_a_step(self):
        """With an endless switch interval another thread runs only when a step releases the interpreter."""
        go, ran = threading.Event(), []

        def wait():
            go.wait()
            ran.append(True)
        other = threading.Thread(target=wait)
        other.start()
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000)
        try:
            go.set()
            for _ in range(2000):
                if ran:
                    break
                self.sim.step()
        finally:
            sys.setswitchinterval(interval)
            was_run = bool(ran)
            other.join()
        self.assertTrue(was_run)


class Readings(unittest.TestCase):
    def test_shorter_rows_end_in_nan(self):
        sim = room()
        ranges = sim.readings("laser")
        self.assertEqual(ranges.shape, (2, 5))
        self.assertTrue(numpy.isnan(ranges[1, 3:]).all())
        numpy.testing.assert_array_equal(sim.valid("laser"), [[True] * 5, [True] * 3 + [False] * 2])

    def test_ranges_at_their_limits(self):
        """Each row of the table in docs/sensors.md."""
        with open("docs/sensors.md", encoding="utf-8") as page:
            table = page.read().split("## Limits of ranges\n")[1].split("\n## ")[0]
        rows = [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in table.splitlines() if line.startswith("|")][2:]
        self.assertEqual(len(rows), 6)
        values = {"range_min": 0.5, "range_max": 4.0, "d": 2.0, "less than range_min": 0.25, "more than range_max": 6.0}
        for name, surface, flag, model, value, _, _ in rows:
            wall, surface = "", surface.replace("`", "")
            if surface in values:
                wall = f'model( name "wall" pose [{values[surface] + 0.5} 0 0 0] size [1 4 1] )'
            sim = sensorfarm.Simulation.from_text(wall + """
                position( name "eye" pose [0 0 0 0] size [0.1 0.1 0.1] laser( samples 1 fov 180 range_min 0.5 range_max 4 )
                          sonar( fov 0 range [0.5 4] ) infrared( fov 0 range [0.5 4] ) )""")
            for type in ("laser", "sonar", "infrared"):
                with self.subTest(row=name, type=type):
                    self.assertEqual(sim.readings(type).flat[0], values[value])
                    self.assertEqual(sim.flags(type)[0, 0], 5 if flag == "too near" else 0)
                    self.assertEqual(sim.valid(type)[0, 0], flag == "none" and type == "laser")
            self.assertEqual(sim.hits("laser")[0, 0] == sensorfarm.NONE, model == "none", name)
            self.assertEqual(list(sim.robots[0].sensors[0].bearings), [0.0], "a single beam looks ahead")

    def test_late_and_uncertain_elements_are_invalid(self):
        """Before a sensor's first reading all elements are invalid; if a beam grazes a wall its bound does not hold."""
        sim = sensorfarm.Simulation.from_text(ROOM.replace("rate 5", "rate 5 phase 0.1"), noise=False)
        numpy.testing.assert_array_equal(sim.valid("laser")[1], [False] * 5)
        self.assertTrue(numpy.isnan(sim.times("laser")[1]))
        sim.step()
        self.assertTrue(sim.valid("laser")[1, :3].all())
        sim.put(0, (-1.5, 1.99 - 1e-4, 0, 1e-4))  # the middle beam hits the wall 1 m ahead, at 0.1 mrad
        sim.step()
        numpy.testing.assert_array_equal(sim.valid("laser")[0], [True, True, False, True, True])

    def test_noisy_sensors_state_no_bound(self):
        """The bound of the readings without noise, and the noise's deviation, replace it."""
        text = ROOM.replace("range_max 3 )", "range_max 3 noise [0.2 0 0] )")
        for noise in (True, False):
            sim = sensorfarm.Simulation.from_text(text, noise=noise)
            self.assertEqual(numpy.isinf(sim.bounds("laser")).tolist(), [noise, False])
            self.assertTrue((sim.bound_without_noise("laser") < 2e-9).all())
            self.assertEqual(sim.sigma("laser").tolist(), [0.2 * noise, 0.0])
            self.assertEqual(sim.valid("laser")[0].any(), not noise)
            self.assertTrue(sim.valid("laser")[1, :3].all())
            self.assertTrue(sim.valid("laser", without_noise=True)[0].all())
            self.assertFalse(sim.valid("sonar").any(), "its type states no bound")

    def test_ranges(self):
        """From (-1, 0) the other robot's side is 1.85 m ahead, and the wall (1 cm thick) 1.99 m to the left."""
        sim = room()
        ranges, hits = sim.readings("laser"), sim.hits("laser")
        self.assertAlmostEqual(ranges[0, 2], 1.85, delta=1e-6)
        self.assertAlmostEqual(ranges[0, 4], 1.99 * 2 ** 0.5, delta=1e-6)
        self.assertEqual(sim.models[hits[0, 2]], "next")
        self.assertEqual(sim.models[hits[0, 4]], "walls")

    def test_columns(self):
        sim = room()
        self.assertEqual(set(sim.types), {"laser", "gps", "sonar"})
        for name in sim.types:
            info = [s for r in sim.robots for s in r.sensors if s.type == name]
            columns = len(info[0].columns)
            elements = max(s.elements for s in info)
            expected = (len(info), elements) + ((columns,) if columns > 1 else ())
            self.assertEqual(sim.readings(name).shape, expected, name)
            self.assertEqual(sim.valid(name).shape, expected[:2], name)

    def test_rates(self):
        """The second laser is read at every other tick."""
        sim = room()
        self.assertEqual(sim.fresh("laser").tolist(), [True, True])
        sim.step()
        self.assertEqual(sim.fresh("laser").tolist(), [True, False])
        numpy.testing.assert_allclose(sim.times("laser"), [0.1, 0.0])
        numpy.testing.assert_array_equal(sim.rows("laser"), [0, 1])


class Steps(unittest.TestCase):
    def test_twists_move_robots(self):
        sim = room()
        sim.step([[0.1, 0.2, 0.3], [0, 0, 0]])
        numpy.testing.assert_allclose(sim.velocities[0], (0.1, 0.2, 0.3), atol=1e-12)
        numpy.testing.assert_allclose(sim.poses[0, 3], 0.03, atol=1e-12)
        sim.step()  # commands are unchanged
        numpy.testing.assert_allclose(sim.poses[0, 3], 0.06, atol=1e-12)
        self.assertEqual((sim.tick, round(sim.time, 9)), (2, 0.2))

    def test_twists_of_other_layouts(self):
        """Integers, column-major order, and a part of a wider array all give the same twists."""
        hashes = set()
        twists = numpy.array([[0, 0, 1], [1, 0, 0]])
        wide = numpy.zeros((2, 6))
        wide[:, ::2] = twists
        for given in (twists, twists.astype(float), numpy.asfortranarray(twists, float), wide[:, ::2], twists.tolist()):
            sim = room()
            sim.step(given)
            hashes.add(sim.hash)
            numpy.testing.assert_allclose(sim.poses[0, 3], 0.1, atol=1e-9)
        self.assertEqual(len(hashes), 1)

    def test_same_seed_same_hash(self):
        hashes = []
        for seed in (1, 1, 2):
            sim = sensorfarm.Simulation(CAVE, robots=5, seed=seed, accuracy="")
            sim.step()
            hashes.append(sim.hash)
        self.assertEqual(hashes[0], hashes[1])
        self.assertNotEqual(hashes[0], hashes[2])
        sim.reset(1)
        sim.step()
        self.assertEqual(sim.hash, hashes[0])

    def test_recording(self):
        with tempfile.TemporaryDirectory() as folder:
            sim = room(record=os.path.join(folder, "run"), record_readings=True)
            sim.step()
            sim.finish_recording()
            self.assertGreater(os.path.getsize(os.path.join(folder, "run", "run.mcap")), 1000)
            with self.assertRaisesRegex(sensorfarm.Error, "compression: expected"):
                room(record=os.path.join(folder, "other"), compression="lz4")

    def test_picture(self):
        picture = room()._repr_png_()
        self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(len(picture), 5000)


class Options(unittest.TestCase):
    def test_lanes_change_their_use(self):
        text = ('road( rndf "%s" )\nposition( name "car" pose [2.4 0.75 0 0] size [0.33 0.33 0.1] laser( samples 9 ) )'
                % os.path.abspath("worlds/simville/simville.rndf"))
        sim = sensorfarm.Simulation.from_text(text, controller="route", settings={"checkpoints": "1"})
        sim.set_lane("1.1", "closed")
        for _ in range(50):
            sim.step()
        self.assertLess(sim.poses[0, 0], 2.7, "it stops in the lane")
        sim.set_lane("1.1", "open")
        for _ in range(50):
            sim.step()
        self.assertGreater(sim.poses[0, 0], 3.2)
        with self.assertRaisesRegex(sensorfarm.Error, "did you mean 'closed'"):
            sim.set_lane("1.1", "close")

    def test_positioning(self):
        text = 'position( name "a" size [0.3 0.3 0.1] track 0.25 encoder( slip 0.05 track 0.25 ) laser( samples 9 ) )'

        def off_the_line(**options):
            sim = sensorfarm.Simulation.from_text(text, controller="patrol", settings={"points": "0 0 2 1"}, **options)
            for _ in range(100):
                sim.step()
            return abs(sim.poses[0, 1] - 0.5 * sim.poses[0, 0])

        self.assertLess(off_the_line(positioning="rate = 10"), 0.05)
        self.assertGreater(off_the_line(), 0.1)
        with self.assertRaisesRegex(sensorfarm.Error, "unknown key 'sigma'"):
            off_the_line(positioning="sigma = 0.01")


class Joining(unittest.TestCase):
    def test_robots_join_and_leave(self):
        """Earlier arrays keep their rows and values; commands have one more row."""
        sim = room()
        sim.step()
        poses, ranges = sim.poses, sim.readings("laser")
        old = ranges.copy()
        self.assertEqual(sim.add_robot("late", "lead", (0, 1.2, 0, 1.5)), 2)
        numpy.testing.assert_array_equal(ranges, old)
        self.assertEqual((poses.shape, sim.poses.shape, len(sim)), ((2, 4), (3, 4), 3))
        numpy.testing.assert_array_equal(sim.readings("laser")[:2], old)
        sim.step(numpy.zeros((3, 3)))
        self.assertTrue(numpy.isfinite(sim.readings("laser")[2]).all())
        numpy.testing.assert_array_equal(ranges, old)
        sim.remove_robot(2)
        sim.step()
        numpy.testing.assert_array_equal(sim.present, [True, True, False])
        self.assertTrue(numpy.isnan(sim.poses[2]).all())

    def test_shapes_change(self):
        sim = sensorfarm.Simulation.from_text(
            'shape( name "crate" size [1 1 1] )\n'
            'position( name "a" size [0.2 0.2 0.2] laser( samples 31 fov 60 range_max 5 ) )\n'
            'model( name "tag1" pose [2 0 0 0] size [0.4 0.4 0.5] )', controller="none")
        self.assertEqual(sim.shapes, ["crate"])
        sim.step()
        kept = sim.readings("laser").copy()
        sim.set_shape(1, "crate", color="steel blue")
        sim.step()
        self.assertAlmostEqual(kept[0, 15] - sim.readings("laser")[0, 15], 0.3)
        sim.set_shape(1, size=(2, 1, 0.5))
        sim.step()
        self.assertAlmostEqual(kept[0, 15] - sim.readings("laser")[0, 15], 0.8)
        with self.assertRaisesRegex(sensorfarm.Error, "did you mean 'crate'"):
            sim.set_shape(1, "crat")

    def test_refusals(self):
        sim = room()
        for arguments, said in ((("lead", "lead", (0, 0, 0, 0)), "taken"), (("a b", "lead", (0, 0, 0, 0)), "letters"),
                                (("a", "leed", (0, 0, 0, 0)), "lead"), (("a", "lead", (0, float("nan"), 0, 0)), "finite")):
            with self.assertRaisesRegex(sensorfarm.Error, said):
                sim.add_robot(*arguments)
        with self.assertRaises(sensorfarm.Error):
            sim.remove_robot(7)
        with self.assertRaises(ValueError):
            sim.add_robot("a", "lead", (0, 0, 0, 0), settings={"speed": 1})
        self.assertEqual(len(sim), 2)


class Images(unittest.TestCase):
    """Images of the room of 4 m, with 100 pixels per metre."""
    WHOLE = dict(width=400, height=400, view=(-2, -2, 2, 2))

    def test_colours_at_known_points(self):
        """Background is white; walls are along the edges, robots at their poses, +y is up."""
        sim = room()
        sim.put(1, (1, 1, 0, 0))
        image = sim.image(**self.WHOLE)
        self.assertEqual((image.shape, image.dtype, image.flags.writeable), ((400, 400, 3), numpy.uint8, True))
        for x, y, free in ((0, 0, True), (1, -1, True), (-1, 0, False), (1, 1, False), (1.9, 1.9, True), (-1.995, 0, False)):
            pixel = image[int(200 - 100 * y), int(200 + 100 * x)]
            self.assertEqual((pixel == 255).all(), free, (x, y, pixel))

    def test_views(self):
        """A view twice as long as high is shown completely, in the middle, with the picture's aspect ratio."""
        sim = room()
        sim.put(0, (0, 0, 0, 0))
        image = sim.image(100, 100, (-0.5, -0.25, 0.5, 0.25))
        self.assertFalse((image[50, 50] == 255).all())
        self.assertTrue((image[50, 20] == 255).all(), "0.3 m from the middle, where the body ends at 0.15 m")
        self.assertFalse((image[50, 37] == 255).all())
        self.assertEqual(sim.image().shape, (480, 640, 3))

    def test_traffic_lights_change(self):
        sim = sensorfarm.Simulation("worlds/simville/simville.world")
        before, poses = sim.image(), sim.poses.copy()
        for _ in range(200):
            sim.step()
        numpy.testing.assert_array_equal(sim.poses, poses)
        self.assertTrue((sim.image() != before).any())

    def test_images_are_independent_and_repeatable(self):
        """Cached layers do not change the picture, in any order."""
        sim, views = room(), [(-k, -k, k, k) for k in (1, 2, 3, 4, 5, 6)]
        first = [sim.image(50, 40, view) for view in views]
        for view, known in reversed(list(zip(views, first))):
            numpy.testing.assert_array_equal(sim.image(50, 40, view), known)
        first[0][:] = 0
        self.assertTrue(sim.image(50, 40, views[0]).any())
        sim.step([[0.3, 0, 0], [0, 0, 0]])
        self.assertTrue((sim.image(50, 40, views[1]) != first[1]).any())

    def test_faults(self):
        sim = room()
        for size in ((0, 10), (10, -1), (4097, 10)):
            with self.assertRaisesRegex(sensorfarm.Error, "expected 1 to 4096 along each side"):
                sim.image(*size)
        for view in ((0, 0, 0, 1), (0, 1, 1, 0), (0, 0, 1, float("inf")), (float("nan"), 0, 1, 1)):
            with self.assertRaisesRegex(sensorfarm.Error, "expected finite x_min, y_min, x_max, y_max"):
                sim.image(10, 10, view)
        self.assertEqual(sim.image(1, 1).shape, (1, 1, 3))


class Cameras(unittest.TestCase):
    def test_images(self):
        sim = sensorfarm.Simulation("worlds/camera.world")
        sim.step()
        depths, normals, colours = sim.images(), sim.images("normals"), sim.images("colour")
        self.assertEqual((depths.shape, normals.shape, colours.shape), ((1, 480, 640), (1, 480, 640, 3), (1, 480, 640, 3)))
        self.assertTrue(numpy.shares_memory(depths, sim.readings("camera")), "a view")
        self.assertTrue(numpy.shares_memory(normals, sim.readings("camera")), "a view")
        self.assertEqual(colours.dtype, numpy.uint8)
        self.assertEqual(depths[0, 0, 639], 60.0, "the sky")
        self.assertGreater(int(colours[0, 0, 639, 2]), int(colours[0, 0, 639, 0]), "which is blue")
        labels = sim.images("labels")
        self.assertTrue(numpy.shares_memory(labels, sim.hits("camera")), "a view")
        self.assertEqual((labels.shape, labels[0, 0, 639]), ((1, 480, 640), sensorfarm.NONE))
        self.assertTrue(((labels == sensorfarm.NONE) == (depths == 60.0)).all())
        with self.assertRaisesRegex(sensorfarm.Error, "expected one of depth, labels, colour, normals, mono"):
            sim.images("heat")

    def test_images_of_different_sizes(self):
        sim = sensorfarm.Simulation.from_text(
            "floor_color \"red\" position( name \"a\" camera( resolution [4 2] range [0 9] ) ) position( name \"b\" "
            "camera( resolution [3 5] range [0 7] rgb 1 normals 1 ) camera( resolution [3 5] range [0 8] ) )")
        sim.step()
        with self.assertRaisesRegex(sensorfarm.Error, r"expected images\(kind, robot=ROW, sensor=NUMBER\)"):
            sim.images()
        one, two = sim.images(robot=0), sim.images(robot=1, sensor=1)
        self.assertEqual((one.shape, two.shape), ((2, 4), (5, 3)))
        self.assertEqual((one[0, 0], sim.images(robot=1)[0, 0], two[0, 0]), (9.0, 7.0, 8.0), "the sky")
        self.assertTrue(numpy.shares_memory(two, sim.readings("camera")), "a view")
        labels, normals = sim.images("labels", robot=1), sim.images("normals", robot=1)
        self.assertEqual((labels.shape, normals.shape), ((5, 3), (5, 3, 3)))
        self.assertEqual((labels[0, 0], labels[4, 1]), (sensorfarm.NONE, sensorfarm.FLOOR))
        self.assertTrue(numpy.shares_memory(labels, sim.hits("camera")), "a view")
        self.assertTrue(numpy.shares_memory(normals, sim.readings("camera")), "a view")
        colour = sim.images("colour", robot=1)
        self.assertEqual(colour.shape, (5, 3, 3))
        self.assertTrue(colour[4, 1, 0] > 0 and colour[4, 1, 1] == 0, "the floor is red")
        for robot, sensor in ((0, 1), (1, 2), (1, -1), (2, 0)):
            with self.assertRaisesRegex(sensorfarm.Error, f"robot {robot} has . sensors 'camera'"):
                sim.images(robot=robot, sensor=sensor)
        with self.assertRaisesRegex(sensorfarm.Error, "expected 'rgb 1' for colour"):
            sim.images("colour", robot=0)

    def test_sensors_with_fewer_columns_are_valid_and_have_hits(self):
        sim = sensorfarm.Simulation.from_text(
            "model( name \"wall\" size [1 9 4] pose [3 0 0 0] ) position( camera( resolution [4 2] rgb 1 normals 1 ) "
            "camera( resolution [3 1] rgb 1 ) lidar( channels 1 columns 4 intensity 1 ) lidar( channels 1 columns 2 ) )")
        self.assertEqual(sim.valid("camera").sum(axis=1).tolist(), [8, 3])
        self.assertEqual(sim.valid("lidar").sum(axis=1).tolist(), [4, 2])
        self.assertEqual(sim.models[sim.hits("camera")[1, 1]], "wall")
        self.assertEqual(sim.hits("lidar")[1, 0], sensorfarm.NONE, "behind")
        self.assertEqual(sim.models[sim.hits("lidar")[1, 1]], "wall")


class Processes(unittest.TestCase):
    def test_a_forked_process_needs_its_own_simulation(self):
        """The child refuses its parent's simulation, and a new one has the parent's readings, with every caster."""
        for caster in ("host", "vulkan", "reference"):
            sim = room(caster=caster)
            reader, writer = os.pipe()
            child = os.fork()
            if child == 0:
                try:
                    sim.step()
                except sensorfarm.Error as error:
                    os.write(writer, f"{error} {room(caster=caster).hash == sim.hash}".encode())
                os._exit(0)
            os.close(writer)
            with os.fdopen(reader) as answer:
                self.assertRegex(answer.read(), "created before the process was forked; .* True$")
            os.waitpid(child, 0)


class Faults(unittest.TestCase):
    def test_messages(self):
        sim = room()
        for error, said, call in (
                (sensorfarm.Error, "given.world:2: ", lambda: sensorfarm.Simulation.from_text('name "x"\nlaser(\n')),
                (sensorfarm.Error, "mine.world:1: ", lambda: sensorfarm.Simulation.from_text("laser(", name="mine.world")),
                (sensorfarm.Error, "nowhere.world: no such file", lambda: sensorfarm.Simulation("nowhere.world")),
                (sensorfarm.Error, "did you mean 'laser'\\? Expected one of: ", lambda: sim.readings("lazer")),
                (sensorfarm.Error, "no hits", lambda: sim.hits("gps")),
                (sensorfarm.Error, "there is no caster 'gpu'", lambda: room(caster="gpu")),
                (sensorfarm.Error, "there is no controller", lambda: room(controller="unknown")),
                (sensorfarm.Error, "is not finite", lambda: sim.put(0, (0, 0, 0, float("inf")))),
                (sensorfarm.Error, "there is no row 2", lambda: sim.put(2, (0, 0, 0, 0))),
                (sensorfarm.Error, "expected finite numbers", lambda: sim.step([[0, 0, float("nan")], [0, 0, 0]])),
                (sensorfarm.DeviceError, "does not match 'nonsuch'", lambda: room(device="nonsuch")),
                (sensorfarm.DeviceError, "select another with device or", lambda: room(device="nonsuch")),
                (sensorfarm.DeviceError, r"\(require_vulkan, ", lambda: room(device="host", require_vulkan=True)),
                (sensorfarm.Error, "its own robots; robot_from is", lambda: room(robot_from="worlds/robots.inc:create")),
                (TypeError, "'robotz' is not an option", lambda: room(robotz=1)),
                (TypeError, "'robots' has a value of another type", lambda: room(robots=-1)),
                (TypeError, "put", lambda: sim.put(0, (0, 0))),
                (TypeError, "", lambda: sim.put(-1, (0, 0, 0, 0))),
                (ValueError, r"the shape \(3, 3\); expected \(2, 3\)", lambda: sim.step(numpy.zeros((3, 3)))),
                (ValueError, r"the shape \(6,\)", lambda: sim.step(numpy.zeros(6))),
                (ValueError, "not numbers", lambda: sim.step("ahead")),
                (ValueError, "read-only", lambda: sim.poses.__setitem__((0, 0), 1.0))):
            with self.assertRaisesRegex(error, said):
                call()
        sim.step(numpy.zeros((2, 3)))  # none of these has damaged it

    def test_errors_are_of_one_family(self):
        self.assertTrue(issubclass(sensorfarm.DeviceError, sensorfarm.Error))
        self.assertTrue(issubclass(sensorfarm.Error, RuntimeError))


if __name__ == "__main__":
    unittest.main()
