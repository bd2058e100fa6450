"""The example that learns to drive through random rooms: it trains, and its policy drives without PyTorch."""

import json
import os
import subprocess
import sys
import tempfile
import unittest

import numpy
import sensorfarm

sys.path.insert(0, "examples/python")
import rooms  # noqa: E402

try:
    import torch
except ImportError:
    torch = None
PROGRAM = "examples/python/rooms.py"


def run(*arguments, **options):
    return subprocess.run([sys.executable, "-B", *arguments], capture_output=True, text=True, **options)


def some_weights():
    """Returns a policy that has learned nothing."""
    generator, sizes = numpy.random.default_rng(2), [41, 64, 64, 2]
    return {name + str(k): generator.normal(0, 0.3, shape) for k in range(3)
            for name, shape in (("w", (sizes[k + 1], sizes[k])), ("b", sizes[k + 1]))}


@unittest.skipIf(torch is None, "learning needs python3-torch")
class Learning(unittest.TestCase):
    def test_trains_and_tests(self):
        with tempfile.TemporaryDirectory() as folder:
            done = run(PROGRAM, "--out", folder, "--worlds", "20", "--updates", "2", "--rooms", "10")
            self.assertEqual(done.returncode, 0, done.stderr)
            for line in ("update   2: ", "agent steps per second ", "policy: ", "straight to the goal: "):
                self.assertIn(line, done.stdout)
            self.assertEqual(sorted(os.listdir(folder)), ["learning_curve.csv", "learning_curve.svg", "policy.npz"])
            again = run(PROGRAM, "--out", folder, "--test", "--rooms", "10")
            self.assertEqual(again.stdout, done.stdout[done.stdout.index("policy: "):])

    def test_actions_are_those_of_the_network(self):
        learner = rooms.Learner(torch, 41, seed=3)
        torch.nn.init.normal_(learner.actor[4].weight, std=0.2)  # the first ones are nearly 0
        seen = numpy.random.default_rng(1).uniform(-1, 1, (500, 41)).astype(numpy.float32)
        with torch.no_grad():
            expected = torch.tanh(learner.actor(torch.tensor(seen))).numpy()
        numpy.testing.assert_allclose(rooms.act(learner.weights(), seen.astype(float)), expected, rtol=0, atol=1e-6)
        self.assertGreater(expected.std(), 0.3)

    def test_advantages(self):
        """Against the sums of their definition, with an end after the second of four steps."""
        learner = rooms.Learner(torch, 41, seed=1, discount=0.9, trace=0.8)
        values, rewards, last = torch.tensor([1.0, 2.0, 3.0, 4.0])[:, None], torch.ones(4, 1), torch.tensor([5.0])
        gains = learner.advantages(values, rewards, torch.tensor([0.0, 1.0, 0.0, 0.0])[:, None], last)[:, 0]
        surprises = [1 + 0.9 * 2 - 1, 1 - 2, 1 + 0.9 * 4 - 3, 1 + 0.9 * 5 - 4]
        expected = [surprises[0] + 0.72 * surprises[1], surprises[1], surprises[2] + 0.72 * surprises[3], surprises[3]]
        numpy.testing.assert_allclose(gains.numpy(), expected, rtol=1e-6)


class WithoutTorch(unittest.TestCase):
    def test_names_the_package(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "torch.py"), "w") as out:
                out.write("raise ImportError\n")
            paths = os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")])
            done = run(PROGRAM, "--out", folder, "--train", "--worlds", "2", env={**os.environ, "PYTHONPATH": paths})
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
        self.assertIn("python3-torch", done.stderr)

    def test_goals_are_free(self):
        some = rooms.Rooms(50, seed=1)
        part = some.worlds.parts[0]
        poses = part.poses.reshape(50, -1, 4)[:, :, :2]
        present = part.present.reshape(50, -1)
        away = numpy.linalg.norm(some.seen.goals[:, None] - poses, axis=2)
        free = numpy.array([[robot.radius for robot in part.robots[:poses.shape[1]]]]) + 0.45
        self.assertGreater(((away > free) | ~present)[:, 1:].all(axis=1).mean(), 0.9)
        self.assertGreater((away[:, 0] > 3.0).mean(), 0.9)
        self.assertEqual(len(numpy.unique(some.seen.goals, axis=0)), 50)
        before = some.seen.goals.copy()
        some.restart(numpy.arange(50) == 7)
        self.assertEqual(numpy.flatnonzero((some.seen.goals != before).any(axis=1)).tolist(), [7])
        self.assertEqual(some.seen.progress[7], 0.0)

    def test_baseline(self):
        ends = rooms.test(rooms.straight, rooms.Rooms(60, rooms.UNSEEN))
        self.assertEqual(ends.sum(), 60)
        self.assertTrue(10 < ends[0] < 50, ends)

    def test_controller_decides_as_the_policy(self):
        """To rounding, since observations are float32 and those of the controller are not. `sensorfarm run` repeats it."""
        weights = some_weights()
        with tempfile.TemporaryDirectory() as folder:
            policy = os.path.join(folder, "policy.npz")
            numpy.savez(policy, **weights)
            alone = sensorfarm.Simulation(rooms.WORLD, robots=1, seed=5, controller=rooms.Drive,
                                          settings={"policy": policy, "goals": [2.0, 1.0]})
            done = subprocess.run([os.environ["SENSORFARM_PROGRAM"], "run", rooms.WORLD, "--robots", "1", "--seed", "5",
                                   "--controller", PROGRAM + ":Drive", "--set", "policy=" + policy, "--set", "goals=2,1",
                                   "--duration", "3.1", "--json"], capture_output=True, text=True)
        some = rooms.Rooms(1, seed=5)
        some.seen.goals[:] = [[2.0, 1.0]]
        some.seen.update()
        for _ in range(30):
            some.drive(rooms.act(weights, some.seen.values))
            alone.step()
        numpy.testing.assert_allclose(alone.poses[0], some.worlds.poses[0, 0], rtol=0, atol=1e-4)
        self.assertGreater(numpy.abs(some.worlds.velocities).max(), 0.1)
        self.assertEqual(json.loads(done.stdout)["hash"], f"{alone.hash:016x}", done.stderr)

    def test_wilson(self):
        numpy.testing.assert_allclose(rooms.wilson(95, 100), (0.8882, 0.9785), atol=1e-4)
        numpy.testing.assert_allclose(rooms.wilson(10, 10), (0.7225, 1.0), atol=1e-4)


if __name__ == "__main__":
    if torch is None:
        print("Without python3-torch learning is not tested")
    unittest.main()
