"""One robot as an environment, resets of some robots, pictures and copies: interfaces of Gymnasium and PettingZoo without
these packages."""

import copy
import pickle
import tempfile
import unittest
import warnings

import numpy
import sensorfarm.gym
import sensorfarm.pettingzoo
from sensorfarm.task import Task

CAVE = "worlds/cave.world"
SIZE = dict(render_mode="rgb_array", render_size=(64, 48))
AHEAD = numpy.array([1.0, 0.0])


def single(**options):
    return sensorfarm.gym.Env(CAVE, **options)


def vector(**options):
    return sensorfarm.gym.VectorEnv(CAVE, **{"num_envs": 6, **options})


def parallel(**options):
    return sensorfarm.pettingzoo.ParallelEnv(CAVE, **{"robots": 3, **options})


def go(env, steps=5):
    """Returns observations, rewards and ends of some steps at half speed."""
    actions = numpy.full(env.action_space.shape, 0.5)
    return [env.step(actions)[:4] for _ in range(steps)]


class Shifted(Task):
    """A task with its own reward, which a copy must have too."""

    def reward(self):
        return super().reward() + 10.0


class Single(unittest.TestCase):
    def test_an_episode(self):
        env = single(seed=2)
        observation, info = env.reset()
        self.assertIn(observation, env.observation_space)
        self.assertEqual((env.observation_space.shape, env.action_space.shape), ((363,), (2,)))
        for _ in range(1000):
            observation, reward, terminated, truncated, info = env.step(AHEAD)
            self.assertIn(observation, env.observation_space)
            self.assertEqual((type(reward), type(terminated), type(truncated)), (float, bool, bool))
            self.assertEqual(info["pose"].shape, (4,))
            if terminated:
                break
        self.assertTrue(terminated)
        self.assertLess(reward, -0.9)
        again, _ = env.reset(seed=2)
        numpy.testing.assert_array_equal(again, single(seed=2).reset()[0])

    def test_truncation(self):
        env = single(seed=1, max_steps=3)
        for _ in range(2):
            env.reset()
            self.assertEqual([env.step([0, 0])[3] for _ in range(3)], [False, False, True])

    def test_seeds(self):
        env, other = single(), single()
        self.assertTrue((env.reset()[0] != other.reset()[0]).any(), "without a seed, starts differ")
        for seed in (5, numpy.int64(5)):
            numpy.testing.assert_array_equal(env.reset(seed=seed)[0], other.reset(seed=5)[0])
        numpy.testing.assert_array_equal(env.reset()[0], other.reset()[0])
        self.assertEqual(env.np_random_seed, 5)

    def test_one_robot_of_several_drives(self):
        env = single(robots=3, seed=1)
        env.reset()
        env.step(AHEAD)
        self.assertEqual((env.simulation.velocities[:, 0] > 0).tolist(), [True, False, False])

    def test_faults(self):
        for bad in (dict(max_steps=0), dict(render_mode="human")):
            with self.assertRaises(ValueError):
                single(**bad)
        env = single()
        for action in ([0.0], [0.0, numpy.nan], [[0.0, 0.0]]):
            with self.assertRaisesRegex(ValueError, r"finite numbers of shape \(2,\)"):
                env.step(action)
        with self.assertWarnsRegex(UserWarning, "without effect: reset_mask; expected: none"):
            env.reset(options={"reset_mask": numpy.ones(1, bool)})
        env.close()
        env.close()
        with self.assertRaisesRegex(ValueError, "closed"):
            env.reset()


class ResetOfSome(unittest.TestCase):
    def test_the_others_continue(self):
        """Poses, speeds, time, observations and the rest of the episode equal those of a run without the reset."""
        env, plain = vector(max_steps=8), vector(max_steps=8)
        for each in (env, plain):
            each.reset(seed=1)
            before = go(each)[-1][0]
        mask = numpy.arange(6) < 2
        after, infos = env.reset(options={"reset_mask": mask})
        self.assertIn(after, env.observation_space)
        numpy.testing.assert_array_equal(after[~mask], before[~mask])
        self.assertTrue((after[mask] != before[mask]).any(axis=1).all())
        numpy.testing.assert_array_equal(infos["_pose"], mask)
        sim, same = env.simulation, plain.simulation
        self.assertEqual(sim.time, same.time)
        numpy.testing.assert_array_equal(sim.poses[2:], same.poses[2:])
        numpy.testing.assert_array_equal(sim.velocities[2:], same.velocities[2:])
        ends = numpy.array([step[3] for step in go(env, 8)])
        self.assertTrue(ends[2, 2:].all(), "after 3 more steps the rest is 8 steps old")
        self.assertEqual(ends[:, :2].argmax(axis=0).tolist(), [7, 7], "masked ones are as old as their reset")

    def test_observations_are_those_of_the_new_poses(self):
        """Readings equal those of a simulation in which all robots are at these poses; speeds are 0."""
        env = vector()
        env.reset(seed=1)
        go(env)
        mask = numpy.array([True, False, True, False, False, True])
        after, infos = env.reset(options={"reset_mask": mask}, seed=9)
        sim = sensorfarm.Simulation(CAVE, robots=6)
        for row, pose in enumerate(infos["pose"]):
            sim.put(row, pose)
        sim.step(numpy.zeros((6, 3)))
        expected = numpy.clip(sim.readings("laser") / env.task.limits, -1, 1).astype(numpy.float32)
        numpy.testing.assert_array_equal(after[mask, :-2], expected[mask])
        self.assertEqual(numpy.abs(after[mask, -2:]).max(), 0)

    def test_seeds(self):
        """Seed s + i, or the i-th seed, chooses the start of sub-environment i; None uses the environment's own
        generator."""
        mask = numpy.arange(6) == 3

        def start(seed):
            env = vector()
            env.reset(seed=1)
            go(env, 20)
            return tuple(env.reset(seed=seed, options={"reset_mask": mask})[1]["pose"][3])
        self.assertEqual(start(5), start([None, None, None, 8, None, None]))
        self.assertEqual(start(None), start(None))
        self.assertGreater(len({start(seed) for seed in range(6)}), 1)

    def test_a_world_reset_completely_restarts(self):
        """A world whose robots are all in the mask begins as after a full reset; other worlds do not advance."""
        env = vector(worlds=2)
        env.reset(seed=1)
        before = go(env)[-1][0]
        mask = numpy.arange(6) < 3
        after, _ = env.reset(seed=7, options={"reset_mask": mask})
        numpy.testing.assert_array_equal(after[:3], vector(num_envs=3).reset(seed=7)[0])
        numpy.testing.assert_array_equal(after[3:], before[3:])
        self.assertEqual([round(env.simulation.time_of(k), 6) for k in range(2)], [0.0, 0.5])

    def test_a_full_mask_is_a_reset(self):
        env = vector()
        numpy.testing.assert_array_equal(env.reset(seed=3, options={"reset_mask": numpy.ones(6, bool)})[0],
                                         vector().reset(seed=3)[0])

    def test_sensors_slower_than_a_tick(self):
        world = """
            model( name "walls" size [8 8 1] boundary 1 )
            position( name "one" pose [-2 0 0 0] size [0.3 0.3 0.2] laser( samples 3 fov 90 range_max 8 rate 2 ) )
            position( name "two" pose [2 0 0 0] size [0.3 0.3 0.2] laser( samples 3 fov 90 range_max 8 rate 2 ) )"""
        env = sensorfarm.gym.VectorEnv("two.world", num_envs=None, text=world)
        start, _ = env.reset(seed=1)
        for _ in range(7):
            env.step(numpy.tile([0.3, 0.1], (2, 1)))
        after, _ = env.reset(options={"reset_mask": numpy.array([True, False])})
        numpy.testing.assert_allclose(after[0], start[0], atol=0.2)
        self.assertEqual(round(env.simulation.time, 6), 0.7)

    def test_disabled_autoreset(self):
        env = vector(max_steps=2, autoreset_mode="Disabled")
        env.reset(seed=1)
        go(env, 2)
        with self.assertRaisesRegex(ValueError, r"\[0, 1, 2, 3, 4, 5\] have ended; expected reset"):
            go(env, 1)
        env.reset(options={"reset_mask": numpy.arange(6) < 5})
        with self.assertRaisesRegex(ValueError, r"\[5\] have ended"):
            go(env, 1)
        env.reset(options={"reset_mask": numpy.arange(6) == 5})
        go(env, 1)
        with self.assertRaisesRegex(ValueError, "autoreset_mode is 'SameStep'; expected 'NextStep' or 'Disabled'"):
            vector(autoreset_mode="SameStep")

    def test_faults(self):
        env = vector()
        env.reset(seed=1)
        for error, mask in ((TypeError, [True] * 6), (TypeError, numpy.ones(6)), (ValueError, numpy.ones(5, bool)),
                            (ValueError, numpy.zeros(6, bool))):
            with self.assertRaisesRegex(error, "reset_mask"):
                env.reset(options={"reset_mask": mask})
        with self.assertWarnsRegex(UserWarning, "without effect: mask; expected: reset_mask"):
            env.reset(options={"mask": numpy.ones(6, bool)})


class Pictures(unittest.TestCase):
    def test_modes(self):
        for make in (single, vector, parallel):
            self.assertEqual(make().metadata["render_modes"], ["rgb_array"])
            self.assertIsNone(make().render())
            with self.assertRaisesRegex(ValueError, "render_mode is 'human'; expected None or 'rgb_array'"):
                make(render_mode="human")

    def test_frames(self):
        for env in (single(**SIZE), parallel(**SIZE)):
            env.reset(seed=1)
            frame = env.render()
            self.assertEqual((frame.shape, frame.dtype), ((48, 64, 3), numpy.uint8))
            self.assertEqual(env.metadata["render_fps"], 10)

    def test_a_frame_per_sub_environment(self):
        env = vector(worlds=2, **SIZE)
        env.reset(seed=1)
        frames = env.render()
        self.assertEqual((type(frames), len(frames)), (tuple, 6))
        self.assertIs(frames[0], frames[2])
        self.assertTrue((frames[0] != frames[3]).any())

    def test_a_frame_shows_the_robot(self):
        env = single(seed=1, render_view=(-1, -1, 1, 1), **SIZE)
        env.reset()
        env.simulation.put(0, (0, 0, 0, 0))
        there = env.render()
        env.simulation.put(0, (5, 5, 0, 0))
        self.assertTrue((there[24, 32] != env.render()[24, 32]).any())


class Copies(unittest.TestCase):
    def copies(self, env):
        yield copy.deepcopy(env)
        yield pickle.loads(pickle.dumps(env))

    def test_a_copy_is_as_after_the_last_reset(self):
        """The same actions lead to the same observations, rewards and ends, also across restarts."""
        for make in (single, vector):
            env = make(seed=3, max_steps=7, task=Shifted)
            env.reset(seed=8)
            env.reset()
            expected = go(env, 20) if make is vector else go(env, 7)
            for other in self.copies(env):
                self.assertIs(type(other.task), Shifted)
                for step, known in zip(go(other, len(expected)), expected):
                    for one, same in zip(step, known):
                        numpy.testing.assert_array_equal(one, same)
                numpy.testing.assert_array_equal(copy.deepcopy(other).reset()[0], copy.deepcopy(env).reset()[0])

    def test_parallel(self):
        env = parallel(seed=3)
        first = env.reset(seed=8)[0]
        actions = {agent: AHEAD for agent in env.agents}
        expected = env.step(actions)
        for other in self.copies(env):
            self.assertEqual(other.agents, env.possible_agents)
            for agent, seen in other.step(actions)[0].items():
                numpy.testing.assert_array_equal(seen, expected[0][agent])
            for agent, seen in other.reset(seed=8)[0].items():
                numpy.testing.assert_array_equal(seen, first[agent])

    def test_before_the_first_reset(self):
        """Also without a seed; a copy has the seed that was drawn."""
        env = single()
        other = pickle.loads(pickle.dumps(env))
        numpy.testing.assert_array_equal(env.reset()[0], other.reset()[0])
        numpy.testing.assert_array_equal(env.reset()[0], other.reset()[0])

    def test_samples_continue(self):
        env = single()
        env.action_space.seed(4)
        env.action_space.sample()
        other = copy.deepcopy(env)
        numpy.testing.assert_array_equal(env.action_space.sample(), other.action_space.sample())

    def test_copies_are_independent(self):
        env = vector(seed=3)
        other = copy.deepcopy(env)
        other.reset(seed=5)
        go(other)
        numpy.testing.assert_array_equal(env.reset()[0], vector(seed=3).reset()[0])

    def test_subclasses_keep_their_own_arguments(self):
        other = copy.deepcopy(Faster(2.0, seed=1))
        self.assertEqual((other.factor, other.max_steps), (2.0, 50))

    def test_closed(self):
        env = vector()
        env.close()
        self.assertTrue(copy.deepcopy(env).closed)

    def test_a_recording_environment_has_no_copy(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(TypeError, "that records"):
                copy.deepcopy(single(record=folder))


class Faster(sensorfarm.gym.Env):
    def __init__(self, factor, **options):
        super().__init__(CAVE, max_steps=50, **options)
        self.factor = factor


class State(unittest.TestCase):
    def test_state_space(self):
        env = parallel()
        env.reset(seed=1)
        self.assertEqual(env.state_space.shape, (3, 7))
        self.assertIn(env.state(), env.state_space)

    def test_agents_sample_independently(self):
        env = parallel()
        for i, agent in enumerate(env.possible_agents):
            env.action_space(agent).seed(i)
        samples = [env.action_space(agent).sample() for agent in env.possible_agents]
        env.action_space(env.possible_agents[0]).seed(0)
        numpy.testing.assert_array_equal(env.action_space(env.possible_agents[0]).sample(), samples[0])
        self.assertTrue((samples[0] != samples[1]).any())


if __name__ == "__main__":
    warnings.simplefilter("error")
    unittest.main()
