"""The interfaces of Gymnasium (vector) and PettingZoo (parallel), covered without these packages, which Debian 12 lacks."""

import subprocess
import sys
import unittest

import numpy
import sensorfarm.gym
import sensorfarm.pettingzoo
from sensorfarm.spaces import Box, batched
from sensorfarm.task import Task

CAVE = "worlds/cave.world"


def vector(**options):
    return sensorfarm.gym.VectorEnv(CAVE, **{"num_envs": 6, **options})


class Vector(unittest.TestCase):
    def check(self, env, answer):
        """Checks the types, shapes and ranges that Gymnasium's documentation states for `step`."""
        observations, rewards, terminations, truncations, infos = answer
        self.assertIn(observations, env.observation_space)
        self.assertEqual((rewards.shape, rewards.dtype), ((env.num_envs,), numpy.float64))
        for ends in (terminations, truncations):
            self.assertEqual((ends.shape, ends.dtype), ((env.num_envs,), numpy.bool_))
        self.assertFalse((terminations & truncations).any())
        self.assertIsInstance(infos, dict)

    def test_spaces(self):
        env = vector(worlds=2)
        self.assertEqual(env.single_observation_space.shape, (363,))
        self.assertEqual(env.observation_space.shape, (6, 363))
        self.assertEqual(env.action_space, batched(env.single_action_space, 6))
        self.assertEqual(env.single_action_space.shape, (2,))
        for name in ("metadata", "spec", "render_mode", "closed", "np_random", "unwrapped"):
            self.assertTrue(hasattr(env, name), name)
        self.assertEqual(env.metadata["render_modes"], ["rgb_array"])

    def test_random_actions(self):
        env = vector(worlds=2, max_steps=15)
        observations, infos = env.reset(seed=3)
        self.assertIn(observations, env.observation_space)
        env.action_space.seed(1)
        truncated = 0
        for _ in range(40):
            answer = env.step(env.action_space.sample())
            self.check(env, answer)
            truncated += answer[3].sum()
        self.assertGreater(truncated, 6)

    def test_seeds(self):
        def episode(env, seed):
            first, _ = env.reset(seed=seed)
            return numpy.stack([first] + [env.step(numpy.full((6, 2), 0.5))[0] for _ in range(10)])
        one, other = vector(), vector(seed=77)
        numpy.testing.assert_array_equal(episode(one, 5), episode(other, 5))
        self.assertTrue((episode(one, 5) != episode(one, 6)).any())
        unlike = episode(one, None), episode(one, None)
        self.assertTrue((unlike[0] != unlike[1]).any())
        numpy.testing.assert_array_equal(episode(one, [5] * 6), episode(other, 5))

    def test_worlds_differ(self):
        env = vector(worlds=2)
        observations, _ = env.reset(seed=1)
        self.assertTrue((observations[:3] != observations[3:]).any())
        self.assertEqual(len({env.simulation.hash_of(k) for k in range(2)}), 2)
        alone = vector(num_envs=3)
        numpy.testing.assert_array_equal(alone.reset(seed=2)[0], observations[3:])

    def test_autoreset_in_the_next_step(self):
        """Full speed ahead ends at a wall. The following step ignores the action and returns the reset observation."""
        env = vector(num_envs=1, seed=2)
        start, _ = env.reset(seed=2)
        for age in range(1000):
            observations, rewards, terminations, _, infos = env.step(numpy.array([[1.0, 0.0]]))
            if terminations[0]:
                break
        self.assertTrue(terminations[0])
        self.assertLess(rewards[0], -0.9)
        at_wall = infos["pose"].copy()
        observations, rewards, terminations, truncations, infos = env.step(numpy.array([[1.0, 0.0]]))
        self.assertEqual((rewards[0], terminations[0], truncations[0]), (0.0, False, False))
        numpy.testing.assert_array_equal(observations, start)
        self.assertTrue((infos["pose"] != at_wall).any())
        observations, rewards, *_ = env.step(numpy.array([[1.0, 0.0]]))
        self.assertAlmostEqual(rewards[0], 0.05)
        for again in range(2, age + 2):
            terminations = env.step(numpy.array([[1.0, 0.0]]))[2]
        self.assertTrue(terminations[0], "the second episode is the first one again")

    def test_truncation(self):
        env = vector(max_steps=3)
        env.reset(seed=1)
        stand = numpy.zeros((6, 2))
        seen = [env.step(stand)[3].all() for _ in range(8)]
        self.assertEqual(seen, [False, False, True, False, False, False, True, False])

    def test_the_step_of_a_reset_has_no_reward(self):
        """Not even if the task rewards a robot at rest, or ends an episode there."""
        class Stand(Task):
            def reward(self):
                return numpy.ones(len(self))

            def terminated(self):
                return numpy.full(len(self), self.sim.tick % 2 == 0)
        env = vector(task=Stand)
        env.reset()
        answers = [env.step(numpy.zeros((6, 2))) for _ in range(4)]
        self.assertEqual([a[1].sum() for a in answers], [6, 6, 0, 6])
        self.assertEqual([a[2].all() for a in answers], [False, True, False, True])

    def test_speeds_are_observed(self):
        env = vector(num_envs=1)
        env.reset()
        observations = env.step(numpy.array([[0.2, 0.4]]))[0]
        numpy.testing.assert_allclose(observations[0, -2:], [0.2, 0.4], atol=1e-6)

    def test_a_start_must_be_free(self):
        """One of two robots occupies the other's start, so the other restarts at the first one's start."""
        env = vector(num_envs=2)
        env.reset(seed=1)
        task, sim = env.task, env.simulation
        sim.put(1, task.starts[0])
        for _ in range(8):
            task.restart(0, env.np_random)
            numpy.testing.assert_array_equal(sim.poses[0], task.starts[1])

    def test_a_contact_at_the_last_step_is_no_truncation(self):
        class Late(Task):
            def terminated(self):
                return numpy.full(len(self), self.sim.tick == 3)
        env = vector(task=Late, max_steps=3)
        env.reset()
        for _ in range(3):
            _, _, terminations, truncations, _ = env.step(numpy.zeros((6, 2)))
        self.assertEqual((terminations.all(), truncations.any()), (True, False))
        parallel = sensorfarm.pettingzoo.ParallelEnv(CAVE, robots=2, task=Late, max_steps=3)
        parallel.reset()
        for _ in range(3):
            _, _, terminations, truncations, _ = parallel.step({a: numpy.zeros(2) for a in parallel.agents})
        self.assertEqual((all(terminations.values()), any(truncations.values()), parallel.agents), (True, False, []))

    def test_own_task(self):
        class Turn(Task):
            def observe(self):
                return self.sim.velocities[self.rows, 2:].astype(numpy.float32)

            def reward(self):
                return self.sim.velocities[self.rows, 2]

            def terminated(self):
                return self.sim.poses[self.rows, 3] > 1e9
        env = vector(task=Turn)
        env.reset()
        self.assertEqual(env.single_observation_space.shape, (1,))
        _, rewards, *_ = env.step(numpy.tile([0.0, 0.5], (6, 1)))
        numpy.testing.assert_allclose(rewards, 0.5 * numpy.pi / 2)

    def test_faults(self):
        for bad in (dict(num_envs=5, worlds=2), dict(num_envs=0), dict(worlds=0), dict(max_steps=0),
                    dict(render_mode="human")):
            with self.assertRaises(ValueError):
                vector(**bad)
        env = vector()
        env.reset()
        for actions in (numpy.zeros((5, 2)), numpy.zeros(12), numpy.full((6, 2), numpy.nan)):
            with self.assertRaisesRegex(ValueError, "expected finite numbers of shape"):
                env.step(actions)
        with self.assertRaises(ValueError):
            env.reset(seed=[1, 2])
        with self.assertRaisesRegex(sensorfarm.Error, "no sensor of type 'sonar'"):
            vector(sensor="sonar")
        env.close()
        with self.assertRaisesRegex(ValueError, "closed"):
            env.step(numpy.zeros((6, 2)))

    def test_registers_with_gymnasium(self):
        """Uses a stand-in for the package, which is not installed."""
        text = """
import enum, sys, types
made = []
gymnasium, vector, spaces = (types.ModuleType(n) for n in ("gymnasium", "gymnasium.vector", "gymnasium.spaces"))
class VectorEnv: pass
class Env: pass
class AutoresetMode(enum.Enum): NEXT_STEP, DISABLED = "NextStep", "Disabled"
import sensorfarm.spaces
spaces.Box, vector.VectorEnv, vector.AutoresetMode = sensorfarm.spaces.Box, VectorEnv, AutoresetMode
gymnasium.Env, gymnasium.vector, gymnasium.register = Env, vector, lambda **entry: made.append(entry)
sys.modules.update({"gymnasium": gymnasium, "gymnasium.vector": vector, "gymnasium.spaces": spaces})
import sensorfarm.gym
assert made == [{"id": "sensorfarm/Drive-v0", "entry_point": "sensorfarm.gym:Env",
                 "vector_entry_point": "sensorfarm.gym:VectorEnv"}], made
env = sensorfarm.gym.VectorEnv(num_envs=2)
assert isinstance(env, VectorEnv) and env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
assert isinstance(sensorfarm.gym.Env(), Env)
env.reset(); env.step(env.action_space.sample())
"""
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)


class Parallel(unittest.TestCase):
    def test_episode(self):
        env = sensorfarm.pettingzoo.ParallelEnv(CAVE, robots=4, max_steps=60)
        self.assertEqual((len(env.possible_agents), env.max_num_agents, env.agents), (4, 4, []))
        observations, infos = env.reset(seed=3)
        self.assertEqual(env.agents, env.possible_agents)
        left, steps = 4, 0
        while env.agents:
            before = list(env.agents)
            self.assertEqual(set(observations) - set(before), ended if steps else set())
            actions = {agent: numpy.array([1.0, 0.3]) for agent in env.agents}
            observations, rewards, terminations, truncations, infos = env.step(actions)
            for answer in (observations, rewards, terminations, truncations, infos):
                self.assertEqual(list(answer), before)
            for agent in before:
                self.assertIn(observations[agent], env.observation_space(agent))
                self.assertIs(type(rewards[agent]), float)
            ended = {agent for agent in before if terminations[agent] or truncations[agent]}
            self.assertEqual(set(env.agents), set(before) - ended)
            steps += 1
        self.assertLessEqual(steps, 60)
        self.assertEqual(env.step({}), ({}, {}, {}, {}, {}))
        self.assertEqual(env.state().shape, (4, 7))

    def test_seeds(self):
        env = sensorfarm.pettingzoo.ParallelEnv(CAVE, robots=2)
        first = env.reset(seed=9)[0]
        second = env.reset()[0]
        again = env.reset(seed=9)[0]
        for agent in env.agents:
            numpy.testing.assert_array_equal(first[agent], again[agent])
            self.assertTrue((first[agent] != second[agent]).any())

    def test_one_space_per_agent(self):
        env = sensorfarm.pettingzoo.ParallelEnv(CAVE, robots=2)
        agent = env.possible_agents[0]
        self.assertIs(env.action_space(agent), env.action_space(agent))
        self.assertIs(env.observation_space(agent), env.observation_space(agent))

    def test_faults(self):
        env = sensorfarm.pettingzoo.ParallelEnv(CAVE, robots=2)
        env.reset(seed=1)
        with self.assertRaisesRegex(ValueError, "expected those of"):
            env.step({env.agents[0]: numpy.zeros(2)})


class Spaces(unittest.TestCase):
    def test_box(self):
        box = Box(-1.0, 1.0, (3,))
        box.seed(1)
        self.assertIn(box.sample(), box)
        self.assertNotIn(numpy.full(3, 1.5, numpy.float32), box)
        self.assertNotIn(numpy.zeros(2, numpy.float32), box)
        self.assertNotIn(numpy.zeros(3, numpy.float64), box)  # float64 would lose digits
        self.assertEqual(batched(box, 4).shape, (4, 3))


if __name__ == "__main__":
    unittest.main()
