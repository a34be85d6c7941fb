"""Boats in closed-form seas as Gymnasium environments, one boat (`OceanEnv`) or many at once (`OceanVectorEnv`).

Needs the extra `gym`. The same seed gives the same episodes, byte for byte. A boat observes the sine and cosine of her
heading error, her speed over her cruise, rates of yaw, roll and pitch, roll, pitch and heave, and the elevation under
her bow now and in the seconds of LOOK_AHEAD_TIMES; she orders helm (-1 to 1, positive turns to port) and throttle (0 to
1). The reward of a step is 1 at the heading asked for, less 2 for a full turn away, less a little for the helm. Her
position and heading are in `info`. `gymnasium.make("ocean_sim.gym.environments:OceanSim/HoldHeading-v0")` makes them by
name.
"""

from typing import Any, ClassVar

import numpy as np

from ocean_sim.conventions import Unsuited, number, row_array, whole_number
from ocean_sim.gym.boats import WAVE_COUNT, Boat, Boats, random_sea

try:
    import gymnasium
    from gymnasium import spaces
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.vector.utils import batch_space
except ImportError:
    raise ImportError("ocean_sim.gym needs Gymnasium: pip install 'ocean-sim[gym]'") from None

LOOK_AHEAD_TIMES = (1.0, 2.0, 3.0)  # [s]
TIME_STEP = 0.1  # [s]
EPISODE_STEPS = 600
MIN_PERIOD_AND_DEPTH = 1e-3  # period [s] and depth [m]
OBSERVATION_SIZE = 9 + 1 + len(LOOK_AHEAD_TIMES)
HELM_COST = 0.05  # of the reward, at full helm
CAPSIZE_ANGLE = np.radians(60.0)


def observation_space() -> spaces.Box:
    """Gymnasium space of one boat's observations: OBSERVATION_SIZE unbounded float32 numbers."""
    return spaces.Box(-np.inf, np.inf, (OBSERVATION_SIZE,), np.float32)


def action_space() -> spaces.Box:
    """Gymnasium space of one boat's actions (2,): helm, -1 to 1, and throttle, 0 to 1."""
    return spaces.Box(np.array([-1.0, 0.0], np.float32), np.array([1.0, 1.0], np.float32), (2,), np.float32)


class OceanVectorEnv(VectorEnv):
    """Gymnasium environment of many boats, each in her own random sea; a boat that is done restarts one step later."""

    metadata: ClassVar[dict[str, Any]] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int = 1000,
        boat: Boat | None = None,
        height: float = 1.0,
        period: float = 6.0,
        depth: float = 50.0,
    ) -> None:
        """`num_envs` boats in seas of significant `height` [m] (0: calm), peak `period` [s], over a `depth` [m]."""
        number("height", height, "m", 0.0)
        number("period", period, "s", MIN_PERIOD_AND_DEPTH)
        number("depth", depth, "m", MIN_PERIOD_AND_DEPTH)
        self.num_envs = whole_number("num_envs", num_envs)
        self.boat, self.height, self.period, self.depth = boat or Boat(), height, period, depth
        self.single_observation_space, self.single_action_space = observation_space(), action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.boats = Boats(self.boat, num_envs, WAVE_COUNT, depth)
        self.asked, self.steps = np.zeros(num_envs), np.zeros(num_envs, int)
        self.done = np.zeros(num_envs, bool)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode of every boat; return observations (n, OBSERVATION_SIZE) and `info()`. Ignores options."""
        super().reset(seed=seed)
        self.begin(np.ones(self.num_envs, dtype=bool))
        return self.observations(), self.info()

    def begin(self, which: np.ndarray) -> None:
        """Start an episode of the boats in mask `which` (n,) at cruise speed: new sea, heading and target heading."""
        count = int(which.sum())
        random = self.np_random
        headings, seeds = random.uniform(0.0, 360.0, count), random.integers(0, 2**31, count)
        seas = [
            random_sea(self.height, self.period, float(heading), self.depth, int(seed))
            for heading, seed in zip(headings, seeds)
        ]
        self.boats.begin(which, seas, random.uniform(-np.pi, np.pi, count), self.boat.cruise)
        self.asked[which] = self.boats.heading[which] + random.uniform(-1.0, 1.0, count)
        self.steps[which], self.done[which] = 0, False

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Advance all boats by TIME_STEP with helm and throttle, `actions` (n, 2); returns observations, rewards,
        capsized, out of time, info. Raises Unsuited for another shape, ValueError for a value that is not finite."""
        actions = row_array("actions", actions, "helm, throttle")
        if len(actions) != self.num_envs:
            raise Unsuited(f"actions: {len(actions)} rows for {self.num_envs} boats")
        if not np.isfinite(actions).all():
            boat = int(np.argmin(np.isfinite(actions).all(axis=1)))
            raise ValueError(f"the action of boat {boat} is {actions[boat].tolist()}; helm and throttle are numbers")
        actions = np.clip(actions, [-1.0, 0.0], 1.0)
        again = self.done.copy()
        self.boats.advance(actions[:, 0], actions[:, 1], TIME_STEP)
        if again.any():
            self.begin(again)
        self.steps[~again] += 1
        reward = np.cos(self.boats.heading - self.asked) - HELM_COST * actions[:, 0] ** 2
        over = np.abs(self.boats.angles).max(axis=1) > CAPSIZE_ANGLE
        late = self.steps >= EPISODE_STEPS
        over[again], late[again], reward[again] = False, False, 0.0
        self.done = over | late
        return self.observations(), reward, over, late, self.info()

    def info(self) -> dict[str, Any]:
        """Dict of `position` (n, 2), x, z [m], `heading` (n,) [rad], and masks of both, all True, for Gymnasium."""
        known = np.ones(self.num_envs, dtype=bool)
        found = {"position": self.boats.place.copy(), "heading": self.boats.heading.copy()}
        return found | {f"_{name}": known for name in found}

    def observations(self) -> np.ndarray:
        """Observations (n, OBSERVATION_SIZE) of all boats; the module's docstring gives their order."""
        boats, off = self.boats, self.boats.heading - self.asked
        motions = [np.sin(off), np.cos(off), boats.speed / self.boat.cruise, boats.yaw_rate]
        motions += [*boats.rates.T, *boats.angles.T, boats.heave]
        looks = [boats.elevation_at_bow(ahead) for ahead in (0.0, *LOOK_AHEAD_TIMES)]
        return np.stack([*motions, *looks], axis=1).astype(np.float32)


class OceanEnv(gymnasium.Env):
    """Gymnasium environment of one boat in a random sea."""

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}

    def __init__(self, **keys: Any) -> None:
        """Take the keyword arguments of `OceanVectorEnv` except `num_envs`."""
        self.many = OceanVectorEnv(1, **keys)
        self.observation_space, self.action_space = observation_space(), action_space()

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode in a new sea; return the observation (OBSERVATION_SIZE,) and `info()`. Ignores options."""
        super().reset(seed=seed)
        self.many.np_random = self.np_random
        self.many.begin(np.ones(1, bool))
        return self.many.observations()[0], self.info()

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Advance by TIME_STEP with `action` (2,): helm, throttle; return observation, reward, capsized, late, info."""
        seen, reward, over, late, _ = self.many.step(np.asarray(action)[None])
        return seen[0], float(reward[0]), bool(over[0]), bool(late[0]), self.info()

    def info(self) -> dict[str, Any]:
        """Dict of `position` (2,), x and z [m], and `heading` [rad] of the boat."""
        return {"position": self.many.boats.place[0].copy(), "heading": float(self.many.boats.heading[0])}


gymnasium.register("OceanSim/HoldHeading-v0", f"{__name__}:OceanEnv", vector_entry_point=f"{__name__}:OceanVectorEnv")
