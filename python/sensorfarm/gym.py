"""Gymnasium's interfaces: Env is one robot, VectorEnv all robots of one or more worlds.

    env = sensorfarm.gym.VectorEnv("worlds/cave.world", num_envs=64, worlds=4)
    observations, infos = env.reset(seed=1)
    observations, rewards, terminations, truncations, infos = env.step(env.action_space.sample())

Gymnasium is optional. If it can be imported, both classes are Gymnasium environments, and importing this module
registers "sensorfarm/Drive-v0" for `gymnasium.make` and `gymnasium.make_vec`; the name
"sensorfarm.gym:sensorfarm/Drive-v0" imports it.
"""

from .single_env import Env
from .task import Task
from .vector_env import VectorEnv

try:
    import gymnasium
except ImportError:
    gymnasium = None

__all__ = ["Env", "Task", "VectorEnv"]

if gymnasium is not None:
    gymnasium.register(id="sensorfarm/Drive-v0", entry_point="sensorfarm.gym:Env",
                       vector_entry_point="sensorfarm.gym:VectorEnv")
