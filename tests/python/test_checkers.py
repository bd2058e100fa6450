"""Runs the checkers of Gymnasium and PettingZoo on the environments if these packages can be imported. test_gym.py and
test_environment.py cover the same without them."""

import copy
import pickle
import sys
import unittest
import warnings

import numpy
import sensorfarm.gym
import sensorfarm.pettingzoo

try:
    import gymnasium
    from gymnasium.utils.env_checker import check_env, data_equivalence
except ImportError:
    gymnasium = None
try:
    import pettingzoo
    from pettingzoo.test import parallel_api_test, parallel_seed_test
except ImportError:
    pettingzoo = None

NAME = "sensorfarm/Drive-v0"
SIZE = dict(render_mode="rgb_array", render_size=(64, 48))


def driven(steps, env):
    """Returns the observations of `steps` steps of one action from seed 4."""
    seen = [env.reset(seed=4)[0].copy()]
    for _ in range(steps):
        seen.append(env.step(numpy.full(env.action_space.shape, 0.5, numpy.float32))[0].copy())
    return numpy.array(seen)


@unittest.skipIf(gymnasium is None, "Gymnasium cannot be imported")
class Gymnasium(unittest.TestCase):
    def setUp(self):
        """Warnings of the checkers fail the test."""
        caught = warnings.catch_warnings()
        caught.__enter__()
        self.addCleanup(caught.__exit__, None, None, None)
        warnings.simplefilter("error", UserWarning)

    def test_check_env(self):
        check_env(gymnasium.make(NAME, **SIZE).unwrapped)

    def test_make(self):
        for env in (gymnasium.make(NAME, max_steps=5), gymnasium.make("sensorfarm.gym:" + NAME, max_steps=5)):
            self.assertIsInstance(env.unwrapped, sensorfarm.gym.Env)
            env.reset(seed=1)
            ends = [env.step(numpy.zeros(2, numpy.float32))[2:4] for _ in range(5)]
            self.assertEqual(ends, [(False, False)] * 4 + [(False, True)])
            env.close()

    def test_wrappers(self):
        from gymnasium import wrappers
        env = gymnasium.make(NAME, **SIZE)
        for wrap in (lambda e: wrappers.TimeLimit(e, 3), wrappers.RecordEpisodeStatistics, wrappers.NormalizeObservation,
                     wrappers.ClipAction, wrappers.RenderCollection):
            env = wrap(env)
        env.reset(seed=1)
        for _ in range(3):
            answer = env.step(env.action_space.sample())
        self.assertTrue(answer[3])
        self.assertEqual(answer[4]["episode"]["l"], 3)
        self.assertEqual({frame.shape for frame in env.render()}, {(48, 64, 3)})

    def test_copies_of_wrapped_environments(self):
        env = gymnasium.make(NAME, max_steps=7)
        expected = driven(4, env)
        for other in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
            self.assertEqual(other.spec.id, NAME)
            numpy.testing.assert_array_equal(driven(4, other), expected)

    def vectors(self, mode, **kwargs):
        env = gymnasium.make_vec(NAME, num_envs=2, vectorization_mode=mode, vector_kwargs=kwargs)
        seen = driven(3, env)
        self.assertEqual(seen.shape, (4, 2, 363))
        numpy.testing.assert_array_equal(seen[:, 0], driven(3, gymnasium.make(NAME)))
        self.assertTrue((seen[:, 1] != seen[:, 0]).any(), "the second has the next seed")
        env.close()

    def test_sync_vector(self):
        self.vectors("sync", copy=False, observation_mode="same")

    def test_async_vector_by_fork_and_spawn(self):
        for context in ("fork", "spawn"):
            self.vectors("async", context=context, shared_memory=True)

    def test_vector_entry_point(self):
        env = gymnasium.make_vec(NAME, num_envs=6, worlds=2, **SIZE)
        self.assertIsInstance(env, sensorfarm.gym.VectorEnv)
        self.assertIsInstance(env, gymnasium.vector.VectorEnv)
        self.assertIs(env.metadata["autoreset_mode"], gymnasium.vector.AutoresetMode.NEXT_STEP)
        env = gymnasium.wrappers.vector.RecordEpisodeStatistics(env)
        observations, _ = env.reset(seed=3)
        self.assertIn(observations, env.observation_space)
        before = env.step(env.action_space.sample())[0]
        after, _ = env.reset(options={"reset_mask": numpy.arange(6) < 2})
        self.assertTrue(data_equivalence(before[2:], after[2:], exact=True))
        self.assertEqual(len(env.render()), 6)

    def test_seeds_of_a_vector(self):
        one, other = (gymnasium.make_vec(NAME, num_envs=4) for _ in range(2))
        numpy.testing.assert_array_equal(driven(5, one), driven(5, other))


@unittest.skipIf(pettingzoo is None, "PettingZoo cannot be imported")
class PettingZoo(unittest.TestCase):
    def make(self, **options):
        return sensorfarm.pettingzoo.ParallelEnv("worlds/cave.world", **{"robots": 3, "max_steps": 40, **options})

    def test_api(self):
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "options of reset without effect")  # it passes options
            parallel_api_test(self.make(), num_cycles=100)

    @unittest.skipUnless(hasattr(pettingzoo, "make"), "this PettingZoo has no registry")
    def test_make(self):
        env = pettingzoo.make("parallel", NAME, robots=3)
        self.assertEqual((type(env.unwrapped), env.unwrapped.max_num_agents), (sensorfarm.pettingzoo.ParallelEnv, 3))

    def test_api_agent_by_agent(self):
        from pettingzoo.test import api_test, seed_test
        from pettingzoo.utils import parallel_to_aec
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            api_test(parallel_to_aec(self.make()), num_cycles=30)
            seed_test(lambda: parallel_to_aec(self.make()), num_cycles=10)

    def test_seeds(self):
        parallel_seed_test(self.make, num_cycles=30)

    def test_state_and_pictures(self):
        from pettingzoo.test.state_test import test_parallel_env
        test_parallel_env(self.make())
        from pettingzoo.utils import parallel_to_aec
        env = parallel_to_aec(self.make(**SIZE))
        env.reset(seed=1)
        self.assertIn(env.state(), env.state_space)
        self.assertEqual(env.render().shape, (48, 64, 3))


if __name__ == "__main__":
    if gymnasium is None and pettingzoo is None:
        print("Skipped: neither Gymnasium nor PettingZoo can be imported")
        sys.exit(0)
    unittest.main()
