"""Controllers in Python: in a simulation, from a file, and in the program."""

import functools
import importlib.util
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import venv

import numpy
import sensorfarm

from controllers import Careful, Divides

PROGRAM = os.environ["SENSORFARM_PROGRAM"]
FILE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "controllers.py")
CAVE = "worlds/cave.world"


def run(*arguments):
    """Returns exit code, output and errors of `sensorfarm run` with 20 robots for 2 s."""
    done = subprocess.run([PROGRAM, "run", CAVE, "--robots", "20", "--duration", "2", *arguments],
                          capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def line_of(text):
    """Returns the number of the line of controllers.py with `text`."""
    with open(FILE) as file:
        return 1 + file.read().split(text)[0].count("\n")


def simulated(**options):
    sim = sensorfarm.Simulation(CAVE, robots=20, **options)
    for _ in range(19):
        sim.step()
    return sim.hash


class OneHash(unittest.TestCase):
    """A controller drives the same way wherever it runs."""

    @classmethod
    def setUpClass(cls):
        cls.expected = json.loads(run("--controller", os.environ["SENSORFARM_CAREFUL"] + ":careful", "--json")[1])["hash"]

    def test_by_step(self):
        sim = sensorfarm.Simulation(CAVE, robots=20)
        twists = numpy.zeros((20, 3))
        for _ in range(19):
            least = sim.readings("laser").min(axis=1)
            near = least < 0.6
            twists[:, 0] = numpy.where(near, 0, 0.1 * least)
            twists[:, 2] = numpy.where(near, 0.5, 0)
            twists[sim.contacts] = 0  # `wait_on_bumper`
            sim.step(twists)
        self.assertEqual(f"{sim.hash:016x}", self.expected)
        self.assertGreater(len({tuple(twist) for twist in twists}), 5, "all robots do the same")

    def test_class(self):
        self.assertEqual(f"{simulated(controller=Careful):016x}", self.expected)

    def test_file(self):
        self.assertEqual(f"{simulated(controller=FILE + ':Careful'):016x}", self.expected)

    def test_world_file(self):
        bare = 'position( name "a" {} laser( samples 90 ) )\nmodel( size [1 1 1] pose [3 0 0 0] )\n'
        named = sensorfarm.Simulation.from_text(bare.format(f'ctrl "{FILE}:Careful near=0.8"'))
        given = sensorfarm.Simulation.from_text(bare.format(""), controller=Careful, settings={"near": 0.8})
        twists = sensorfarm.Simulation.from_text(bare.format(f'ctrl "{FILE}:Careful"'), controller="none")
        for sim in (named, given, twists):
            for _ in range(30):
                sim.step()
        self.assertEqual(named.hash, given.hash)
        self.assertNotEqual(named.poses[0][0], 0)
        self.assertEqual(twists.poses[0][0], 0)

    def test_plugin(self):
        self.assertEqual(f"{simulated(controller=os.environ['SENSORFARM_CAREFUL']):016x}", self.expected)

    def test_program(self):
        code, out, errors = run("--controller", FILE + ":Careful", "--json")
        self.assertEqual((code, json.loads(out)["hash"]), (0, self.expected), errors)

    def test_threads(self):
        for threads in (1, 3):
            self.assertEqual(f"{simulated(controller=Careful, threads=threads):016x}", self.expected)

    def test_settings_matter(self):
        self.assertNotEqual(f"{simulated(controller=Careful, settings={'near': 2.5}):016x}", self.expected)


def class_of(file):
    """Returns class A of a file, loaded as a separate module."""
    spec = importlib.util.spec_from_file_location(os.path.dirname(file).replace("/", "_"), file)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module.A


class Program(unittest.TestCase):
    def fails(self, *arguments):
        code, _, errors = run(*arguments)
        self.assertNotEqual(code, 0)
        self.assertNotIn("Traceback", errors)
        return errors

    def test_exception_ends_the_run(self):
        errors = self.fails("--controller", FILE + ":Divides")
        line = line_of("return 1 / (")
        self.assertIn("robot 'roomba8' failed at 0.200 s", errors)
        self.assertIn(f"{FILE}:{line}: ZeroDivisionError: division by zero", errors)

    def test_the_line_is_of_the_controllers_file(self):
        line = line_of("return json.loads")
        self.assertIn(f"{FILE}:{line}: json.decoder.JSONDecodeError", self.fails("--controller", FILE + ":Reads"))

    def test_return_values(self):
        for what, said in (("none", "None"), ("two", "(0, 0)"), ("text", "'abc'"), ("nan", "nan")):
            errors = self.fails("--controller", FILE + ":Returns", "--set", "what=" + what)
            self.assertIn(said, errors)
            self.assertIn("expected", errors)
            if what != "nan":
                self.assertIn(f"{FILE}:{line_of('return self.what') - 1}: step() returned", errors)

    def test_signatures(self):
        """Errors state place and expected signature of constructors and methods that cannot be called, in the program
        and in process."""
        maker, drives = "def __init__(self, robot, settings): pass", "def step(self, input): return 0, 0, 0"
        for first, second, line, said in (
                ("pass", drives, 2, "class A has no __init__; expected def __init__(self, robot, settings)"),
                ("def __init__(self): pass", drives, 3, "A.__init__(self) has other parameters; expected def __init__(self, robot, "),
                (maker, "def step(self): return 0, 0, 0", 4, "A.step has other parameters; expected def step(self, input)"),
                (maker, "def step(self, input, more): pass", 4, "A.step has other parameters; expected def step(self, input)"),
                (maker, "step = 5", 2, "A.step is not a method; expected def step(self, input)"),
                (maker + "\n  def done(self, input): pass", drives, 4, "A.done has other parameters; expected def done(self)"),
                (maker + "\n  def error(self, input): pass", drives, 4, "A.error has other parameters; expected def error(self)")):
            with tempfile.TemporaryDirectory() as folder:
                file = os.path.join(folder, "wrong.py")
                with open(file, "w") as out:
                    out.write(f"\nclass A:\n  {first}\n  {second}\n")
                self.assertIn(f"{file}:{line}: {said}", self.fails("--controller", file + ":A"))
                with self.assertRaises(sensorfarm.Error) as raised:
                    simulated(controller=class_of(file))
                self.assertIn(f"{file}:{line}: {said}", str(raised.exception))

    def test_other_shapes_of_the_same_signatures(self):
        """Accepts arguments of any number or with defaults, methods of the class, and callables."""
        class Any:
            def __init__(self, *all, **named):
                pass

            @staticmethod
            def step(input, more=0):
                return 0, 0, 0

            @classmethod
            def done(cls):
                return False

        class Called(Any):
            def __init__(self, robot, settings, extra=1):
                self.step = functools.partial(lambda speed, input: (speed, 0, 0), 0.1)
        for controller in (Any, Called):
            simulated(controller=controller)

    def test_settings(self):
        self.assertIn("expects a number from 0 to 10; got '11'", self.fails("--controller", FILE + ":Careful", "--set", "near=11"))
        self.assertIn("has no setting 'far'", self.fails("--controller", FILE + ":Careful", "--set", "far=1"))

    def test_end_of_the_process(self):
        # Uses one thread: with several, another robot's thread may wait for the interpreter in its call.
        code, out, errors = run("--controller", FILE + ":Ends", "--set", "how=exit", "--threads", "1")
        self.assertEqual(code, 1)
        self.assertIn("controller 'Ends' of robot 'roomba1' ended the process (exit code 0) at 1.000 s simulated", errors)
        self.assertIn("before the end", out)
        errors = self.fails("--controller", FILE + ":Ends", "--set", "how=system_exit")
        self.assertIn("SystemExit: 0", errors)
        errors = self.fails("--controller", FILE + ":Ends", "--set", "how=escape")
        self.assertIn("ValueError: \\x1b[2Jgone", errors)

    def test_first_interrupt(self):
        """The run ends within half a second, also during Python's loops and sleeps; the rest of the limit is for slow
        machines."""
        for how in ("loop", "sleep"):
            with tempfile.TemporaryDirectory() as folder:
                started = subprocess.Popen([PROGRAM, "run", CAVE, "--robots", "20", "--duration", "5", "--controller",
                                            FILE + ":Ends", "--set", "how=" + how, "--record", folder],
                                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                while started.poll() is None and not os.path.exists(os.path.join(folder, "run.mcap")):
                    time.sleep(0.01)
                time.sleep(1)
                begin = time.monotonic()
                started.send_signal(signal.SIGINT)
                errors = started.communicate()[1]
                self.assertLess(time.monotonic() - begin, 4, how)
                self.assertEqual(started.returncode, 1, how + errors)
                self.assertIn("controller 'Ends' of robot 'roomba1' at 1.000 s simulated has not returned", errors)

    def test_children_end_with_the_run(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "pid")
            code, _, errors = run("--controller", FILE + ":Ends", "--set", "how=child", "--set", "file=" + file)
            self.assertEqual(code, 0, errors)
            with open(file) as text:
                with self.assertRaises(ProcessLookupError):
                    os.kill(int(text.read()), 0)

    def test_names(self):
        self.assertIn("no controller 'Missing'", self.fails("--controller", FILE + ":Missing"))
        self.assertIn("several controllers", self.fails("--controller", FILE))
        self.assertNotIn("_Hidden", self.fails("--controller", FILE))
        self.assertIn("No such file", self.fails("--controller", "nowhere.py:Careful"))

    def test_bad_files(self):
        with tempfile.TemporaryDirectory() as folder:
            for text, said in (("def f(:\n", ":1: SyntaxError"), ("x = 1\n", "no class with a method step"),
                               ("\nclass A:\n  pass\n", ":2: class A has none"),
                               ("\nimport nowhere\n", ":2: ModuleNotFoundError"), ("\0", "null bytes"),
                               ("class A:\n  rate = 'x'\n  def step(self, i): pass\n", "'rate' of class A is 'x'"),
                               ("class A:\n  rate = -1\n  def step(self, i): pass\n", "rate of -1 Hz")):
                file = os.path.join(folder, "bad.py")
                with open(file, "w") as out:
                    out.write(text)
                self.assertIn(said, self.fails("--controller", file))

    def test_python_ends_in_order(self):
        code, out, errors = run("--controller", FILE + ":Prints")
        self.assertEqual(code, 0, errors)
        self.assertTrue(out.endswith("farewell\n"), out[-200:])

    def test_virtual_environment(self):
        """Modules of an active environment of this version are found; an environment of another version is ignored."""
        with tempfile.TemporaryDirectory() as folder:
            own = os.path.join(folder, "own")
            venv.create(own, system_site_packages=True, with_pip=False, symlinks=True)
            version = "python%d.%d" % sys.version_info[:2]
            with open(os.path.join(own, "lib", version, "site-packages", "only_here.py"), "w") as out:
                out.write("speed = 0.25\n")
            file = os.path.join(folder, "uses.py")
            with open(file, "w") as out:
                out.write("import only_here\nclass Uses:\n  def __init__(self, robot, settings): pass\n"
                          "  def step(self, input): return only_here.speed, 0, 0\n")
            environment = dict(os.environ, VIRTUAL_ENV=own)
            done = subprocess.run([PROGRAM, "run", CAVE, "--duration", "1", "--controller", file], env=environment,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            environment["VIRTUAL_ENV"] = folder
            done = subprocess.run([PROGRAM, "run", CAVE, "--duration", "1", "--controller", file], env=environment,
                                  capture_output=True, text=True)
            self.assertIn("No module named 'only_here'", done.stderr)

    def test_scenario(self):
        with tempfile.TemporaryDirectory() as folder:
            scenario = os.path.join(folder, "scenario.toml")
            with open(scenario, "w") as out:
                out.write(f'world = "{os.path.abspath(CAVE)}"\nduration = 2\nrobots = 20\n'
                          f'[default]\ncontroller = "{FILE}:Careful"\nsettings = {{ near = 0.7 }}\n'
                          '[expect]\ncontacts = 0\n')
            done = subprocess.run([PROGRAM, "test", scenario], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class InProcess(unittest.TestCase):
    def test_exception(self):
        with self.assertRaisesRegex(sensorfarm.Error, r"'roomba8' failed at 0.200 s: .*controllers.py:\d+: ZeroDivisionError"):
            simulated(controller=Divides)

    def test_faults_of_classes(self):
        """Results of another type, invalid UTF-8, multi-line texts, and classes that drive nothing."""
        def made(**members):
            return type("Made", (), {"__init__": lambda self, robot, settings: None, "step": lambda self, input: (0, 0, 0),
                                     **members})

        def fail(self, input):
            raise ValueError("\udcff in\ntwo lines")

        def leave(self, input):
            raise SystemExit(3)
        for members, said in ((dict(done=lambda self: "x"), r"done\(\) returned 'x'; expected True or False"),
                              (dict(radio_range=lambda self: "far"), r"radio_range\(\) returned 'far'; expected a number"),
                              (dict(step=fail), r"ValueError: \\udcff in two lines$"),
                              (dict(step=leave), "SystemExit: 3"),
                              (dict(step=lambda self, input: "\udcff"), r"returned '\\udcff'; expected three numbers")):
            with self.assertRaisesRegex(sensorfarm.Error, said):
                simulated(controller=made(**members))
        with self.assertRaisesRegex(TypeError, "'int' is not a controller"):
            simulated(controller=int)
        with self.assertRaisesRegex(TypeError, r"test_controllers.py:\d+: 'InProcess' is not a controller: .* step\(self, input\)"):
            simulated(controller=InProcess)
        with self.assertRaisesRegex(ValueError, "without a controller"):
            simulated(settings={"near": 1})

    def test_steps_on_scans(self):
        class OnScans:
            rate = 2.0
            on_scans = True

            def __init__(self, robot, settings):
                self.times = OnScans.times = []

            def step(self, input):
                self.times.append(round(input.time, 6))
                return 0.1, 0, 0

        sim = sensorfarm.Simulation(CAVE, robots=1, controller=OnScans)
        for _ in range(4):
            sim.step()
        self.assertEqual(OnScans.times, [0.0, 0.1, 0.2, 0.3, 0.4])

    def test_inputs(self):
        seen = {}

        class Looks:
            rate = 5.0
            stops_on_bumper = False

            def __init__(self, robot, settings):
                seen[robot.row] = self
                self.robot, self.settings, self.inputs = robot, settings, []

            def radio_range(self):
                return 100.0

            def step(self, input):
                self.inputs.append(input)
                return input.velocity if False else (0.1, 0, 0)

        sim = sensorfarm.Simulation(CAVE, robots=20, controller=Looks)
        kept = sim.poses.copy()
        for _ in range(4):
            sim.step()
        looks = seen[3]
        self.assertEqual([round(i.time, 6) for i in looks.inputs], [0.0, 0.2, 0.4])
        first = looks.inputs[0]
        self.assertEqual(tuple(first.pose), tuple(kept[3]))
        self.assertEqual(first.newest("laser").values.shape, (361,))
        self.assertIsNone(first.newest("laser", 1))
        self.assertIsNone(first.newest("sonar"))
        self.assertLess(first.newest("laser").bound, 2e-9)
        self.assertEqual(first.newest("laser").bound_without_noise, first.newest("laser").bound)
        self.assertEqual(first.newest("laser").sigma, 0.0)
        self.assertEqual(first.newest("laser").flags.tolist(), [0] * 361)
        self.assertEqual(len(first.others), 19)
        self.assertAlmostEqual(looks.inputs[2].velocity.forward, 0.1)
        self.assertEqual(looks.robot.sensors[0].columns, ["range_m"])
        with self.assertRaisesRegex(ValueError, "__init__ only"):
            looks.settings.number("late", 1)

    def test_done(self):
        class Ends:
            def __init__(self, robot, settings):
                self.calls, self.row = 0, robot.row

            def step(self, input):
                self.calls += 1
                return 0.1, 0, 0

            def done(self):
                return self.calls > self.row

        sim = sensorfarm.Simulation(CAVE, robots=4, controller=Ends)
        for expected in ([1, 0, 0, 0], [1, 1, 0, 0], [1, 1, 1, 0]):
            self.assertEqual(sim.done.tolist(), [bool(e) for e in expected])
            sim.step()

    def test_calls_run_in_threads_of_the_farm(self):
        """Two calls wait for each other, so each thread must release the interpreter."""
        both = threading.Barrier(2, timeout=60)

        class Meets:
            def __init__(self, robot, settings):
                self.meets = robot.row in (0, 63)  # in different shares of the thread pool

            def step(self, input):
                if self.meets:
                    both.wait()
                return 0, 0, 0

        sim = sensorfarm.Simulation(CAVE, robots=64, controller=Meets, threads=2)
        sim.step()
        self.assertEqual(both.broken, False)

    def test_no_step_within_a_step(self):
        class Nests:
            sim = None

            def __init__(self, robot, settings):
                pass

            def step(self, input):
                if Nests.sim is not None:
                    Nests.sim.step()
                return 0, 0, 0

        sim = sensorfarm.Simulation(CAVE, robots=2, controller=Nests)
        Nests.sim = sim
        with self.assertRaisesRegex(sensorfarm.Error, "another call of a simulation has not ended"):
            sim.step()
        Nests.sim = None

    def test_classes_of_one_name(self):
        def make(speed):
            class Same:
                def __init__(self, robot, settings):
                    pass

                def step(self, input):
                    return speed, 0, 0
            return Same
        fast, slow = make(0.3), make(0.1)
        self.assertNotEqual(simulated(controller=fast), simulated(controller=slow))
        self.assertEqual(simulated(controller=fast), simulated(controller=fast))


class Models(unittest.TestCase):
    """Controllers of models that are not robots."""

    WORLD = ('model( name "gate" pose [2 0 0 0] size [0.3 0.3 0.5] ctrl "{}" )\n'
             'position( name "b" size [0.3 0.3 0.3] ctrl "none" laser( ) )')

    def simulated(self, ctrl, ticks=30, pose=None):
        sim = sensorfarm.Simulation.from_text(self.WORLD.format(ctrl))
        if pose:
            sim.put(1, pose)
        for _ in range(ticks):
            sim.step()
        return sim

    def test_same_bytes_as_a_plugin(self):
        plugin = os.path.join(os.path.dirname(PROGRAM), "test_plugin.so")
        ours = self.simulated(FILE + ":Gate way=0.3")
        self.assertEqual(ours.hash, self.simulated(plugin + ":test-slide way=0.3").hash)
        self.assertNotEqual(ours.hash, self.simulated(FILE + ":Gate way=0.4").hash)
        self.assertEqual(ours.models[0], "gate")
        self.assertNotEqual(ours.poses[0, 0], 2.0)

    def test_contacts_and_robots(self):
        kept = self.simulated(FILE + ":Gate", 10, (2.6, 0, 0, 0))
        gate = sys.modules[FILE].Gate
        name, row, robot, (x, y) = gate.touched
        self.assertEqual((name, row, robot), ("b", 1, True))
        self.assertAlmostEqual(x, 2.45, 2)
        self.assertLess(kept.poses[0, 0], 2.31)
        self.assertEqual(gate.seen[0][:2], ("b", 1))

    def test_added_by_the_program(self):
        """`ctrl` names the class; it reaches another object, which it cannot use after the call."""
        class Button:
            def __init__(self, model, settings):
                self.door, self.kept = settings.text("door", ""), None

            def tick(self, model):
                if self.kept is not None:
                    self.kept.set_present(False)
                door = model.object(self.door)
                door.set_size([0.5, 0.5, 0.5])
                door.set_pose((3, 1, 0, 0))
                if model.time > 0.55:
                    self.kept = door

        sensorfarm.add_model_controller(Button, "test-button")
        with self.assertRaisesRegex(sensorfarm.Error, "a controller 'test-button' already exists"):
            sensorfarm.add_model_controller(Button, name="test-button")
        with self.assertRaisesRegex(TypeError, "expected a class with a method tick"):
            sensorfarm.add_model_controller(print)
        world = self.WORLD.format("test-button door={}") + '\nmodel( name "tag4" pose [3 0 0 0] size [1 1 1] )'
        sim = sensorfarm.Simulation.from_text(world.format("tag4"))
        for _ in range(3):
            sim.step()
        self.assertEqual(tuple(sim.poses[2]), (3, 1, 0, 0))
        with self.assertRaisesRegex(sensorfarm.Error, "a model can be used during the call"):
            for _ in range(8):
                sim.step()
        with self.assertRaisesRegex(sensorfarm.Error, "there is no object 'tag5' that moves; did you mean 'tag4'"):
            other = sensorfarm.Simulation.from_text(world.format("tag5"))
            other.step(), other.step()

    def test_faults(self):
        for fault, said in (("divide", r"controller 'Gate' of model 'gate' failed at 1.000 s: .*controllers.py:\d+: ZeroDivisionError"),
                            ("pose", r"ValueError: set_pose\(nan, 0, 0, 0\): expected finite numbers"),
                            ("range", r"controllers.py:\d+: range\(\) returned 'far'; expected a number"),
                            ("late", "ValueError: a model can be used during the call")):
            with self.assertRaisesRegex(sensorfarm.Error, said):
                self.simulated(FILE + ":Gate fault=" + fault)
        with self.assertRaisesRegex(sensorfarm.Error, r"refuses model 'gate': .*expected def __init__\(self, model, settings\)"):
            self.simulated(FILE + ":GateWithoutModel")
        with self.assertRaisesRegex(sensorfarm.Error, "has no model controller 'Careful'"):
            self.simulated(FILE + ":Careful")


if __name__ == "__main__":
    unittest.main()
