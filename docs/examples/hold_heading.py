"""PPO learns to hold a heading in waves: `pip install 'ocean-sim[gym]' stable-baselines3`, then run this file.

It trains one boat for about half a minute of processor time and prints the mean reward of a step before and after; 1 is
a heading held exactly. With Stable-Baselines3 2.9.2 it was 0.705 untrained and 0.969 after 30 000 steps.
"""

import sys

import numpy as np
from stable_baselines3 import PPO

from ocean_sim.gym import OceanEnv


def mean_reward(model: PPO, seeds: range) -> float:
    """Of a step, over whole episodes."""
    found = []
    for seed in seeds:
        env = OceanEnv()
        seen, _ = env.reset(seed=seed)
        done = False
        while not done:
            action, _ = model.predict(seen, deterministic=True)
            seen, reward, over, late, _ = env.step(action)
            found.append(reward)
            done = over or late
    return float(np.mean(found))


def main(steps: int) -> None:
    model = PPO("MlpPolicy", OceanEnv(), seed=1, verbose=0)
    before = mean_reward(model, range(5))
    model.learn(steps)
    print(f"mean reward of a step: {before:.3f} untrained, {mean_reward(model, range(5)):.3f} after {steps} steps")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 30_000)
