"""The worked example runs, and its parts behave as described."""

import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
import textwrap
import unittest

import numpy
import sensorfarm.gym

sys.path.insert(0, "examples/python")
import corridor  # noqa: E402


class Corridor(unittest.TestCase):
    def test_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "examples/python/corridor.py", "--out", folder, "--generations", "2",
                                   "--candidates", "4", "--seconds", "3"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("generation   2: ", done.stdout)
            self.assertEqual(numpy.load(os.path.join(folder, "policy.npy")).shape, (160,))
            self.assertEqual(sorted(os.listdir(folder)),
                             ["corridor.png", "corridor.world", "learning_curve.svg", "policy.npy"])

    def test_refuses_odd_candidates(self):
        done = subprocess.run([sys.executable, "examples/python/corridor.py", "--candidates", "3"], capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("even number", done.stderr)

    def test_floors(self):
        """Robots neither touch nor see each other, and their reward is the distance along the ring."""
        env = sensorfarm.gym.VectorEnv("corridor.world", num_envs=None, task=corridor.Rounds,
                                       text=corridor.corridor(6))
        env.reset(seed=1)
        sim = env.simulation
        self.assertEqual(len(set(sim.poses[:, 2])), 6)
        hits = set(sim.hits("laser").ravel().tolist()) - {sensorfarm.NONE}
        self.assertEqual({sim.models[hit] for hit in hits}, {"inner", "outer"})
        sim.put(1, sim.poses[0] + (0, 0, corridor.FLOOR, 0))  # on the floor above the first robot
        _, rewards, terminations, *_ = env.step(numpy.tile([1.0, 0.0], (6, 1)))
        self.assertFalse(terminations.any())
        self.assertTrue(((rewards[2:] > 0.03) & (rewards[2:] < 0.0501)).all(), rewards)  # 0.05 m, partly sideways


class Documentation(unittest.TestCase):
    def test_blocks_run(self):
        """The blocks of docs/python.md one after another, and the one of the package's own description."""
        with open("docs/python.md") as page:
            blocks = re.findall(r"```python\n(.*?)```", page.read(), re.S)
        self.assertEqual(len(blocks), 5)
        blocks.append(textwrap.dedent(sensorfarm.__doc__.split("\n\n", 1)[1]))
        names = {}
        for block in blocks:
            with contextlib.redirect_stdout(io.StringIO()):
                exec(block, names)


if __name__ == "__main__":
    unittest.main()
