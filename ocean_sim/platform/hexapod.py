"""The platform of figure 6-9: a washout, and a hexapod under it that keeps within its limits."""

from collections.abc import Iterator
from functools import reduce
from importlib import import_module
from operator import or_
from pathlib import Path
from typing import Annotated, Any, Literal, cast

import numpy as np
from pydantic import Field, field_validator

from ocean_sim.model import Faults, quantity
from ocean_sim.parts import LedgerRow, PlatformConfig, SceneFacts, preset
from ocean_sim.platform import SINGULARITY_LIMIT, Commands, Cue, Planner, WashoutConfig
from ocean_sim.platform.shared import leg_programme
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod, felt_motion, smooth_step
from ocean_sim.platform.shared.limits import LEG_MATCH, Governor, Legs, Workspace
from ocean_sim.platform.shared.motion_log import Ride

# A washout is one file, washout/<kind>.py: a Config with its `kind`, which builds what follows a ride.
WASHOUT_KINDS = sorted(path.stem for path in (Path(__file__).parent / "washout").glob("[!_]*.py"))
GLIDE_TIME = 0.15  # [s] within which a platform that stops loses its speed
PLAN_COST = 0.035  # [s] of processor time of a plan, for each second that it looks ahead
WASHOUT_CONFIGS = [import_module(f"ocean_sim.platform.washout.{name}").Config for name in WASHOUT_KINDS]
AnyWashout: Any = reduce(or_, WASHOUT_CONFIGS)
if len(WASHOUT_CONFIGS) > 1:  # pydantic selects one by its kind, which takes two or more
    AnyWashout = Annotated[AnyWashout, Field(discriminator="kind")]


class Config(PlatformConfig):
    kind: Literal["hexapod"] = "hexapod"
    geometry: str | Geometry = Field(default="hexapod_a", validate_default=True)
    """A name in configs/geometry/, or the joints and legs themselves."""
    washout: str | AnyWashout = Field(default="ship", validate_default=True)
    """A name in configs/washout/, or a washout itself."""
    ramp: float = quantity("s", 3.0, ge=0.0)
    """Time over which the platform goes from neutral into the motion, and at the end of a stream back to neutral."""

    catch_up: float = quantity("m/s2", 2.0, gt=0.0)
    """Largest acceleration, beyond the request of the washout, with which a platform that fell behind catches up. Near
    the end of a stroke it is braked with at most half as much again."""

    @field_validator("geometry", "washout", mode="before")
    @classmethod
    def _preset_value(cls, value: Any, info: Any) -> Any:
        """Preset mapping that a name stands for; a value that is no name is returned unchanged."""
        return preset(info.field_name, value) if isinstance(value, str) else value

    @property
    def look_ahead(self) -> float | None:
        return cast(WashoutConfig, self.washout).look_ahead

    def mismatches(self, preflight: SceneFacts) -> Faults:
        """Yield faults (key, sentence): those of the base class, and a washout that must know the ship's motion in
        advance in water of particles, whose motion nobody can run ahead in time."""
        yield from super().mismatches(preflight)
        if self.look_ahead and preflight.fluid.made_of_particles:
            slow = "predictive runs the ship ahead, for which particles are too slow; take linear_waves or spectral_sea"
            other = "or predictive_linear, or `ocean-sim platform RUN --washout predictive` after the run"
            yield ("washout",), f"{slow}, {other}"

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        if not preflight.ships:
            yield "platform: there is no ship whose motion it could follow"
        elif "platform_log" not in preflight.parts:
            yield "platform has no effect: without `motion` and `platform_log` there is nothing that it follows"
        else:
            yield from self.cut_short(preflight.duration)
            if len(preflight.ships) > 1 and self.ship is None:
                first = next(iter(preflight.ships))
                yield f"platform: it rides in {first}, the first of the ships; platform.ship names another"
            if self.look_ahead is not None:
                cost = PLAN_COST * self.look_ahead
                share = f"{cost:.2g} s of a core for each plan" if cost else "two thirds of a core"
                late = "in real time `ship` moves the platform where a plan is much too late"
                yield f"platform: a second process takes about {share}; {late}"

    def cut_short(self, duration: float) -> Iterator[str]:
        """Warn if a run of this duration [s] ends before the platform's initial ramp, which no plan has, does."""
        if self.look_ahead is None and duration < self.ramp:
            share = 100.0 * float(smooth_step(np.array(duration / self.ramp)))
            opening = f"platform: it goes from neutral into the motion over {self.ramp:.4g} s,"
            middle = f"and the ride ends after {duration:.4g} s, when it does {round(share, 1):g} % of it;"
            yield f"{opening} {middle} take a longer ride or a shorter ramp"

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        """One row of the memory ledger with no bytes of its own: the row of `platform_log` counts them."""
        kind = cast(WashoutConfig, self.washout).kind
        return [LedgerRow("platform", f"{kind} washout and six legs", 0, "for platform_log")]

    def build(self, every: float) -> "HexapodPlatform":
        return HexapodPlatform(self, every)


class HexapodPlatform:
    """Hexapod with its washout: turns successive chunks of ship motion into poses and leg lengths within its limits."""

    def __init__(self, config: Config, every: float) -> None:
        """`every`: time between rows [s]."""
        geometry, washout = cast(Geometry, config.geometry), cast(WashoutConfig, config.washout)  # no names any more
        self.every, self.ramp, self.geometry = every, config.ramp, geometry
        self.hexapod = Hexapod(geometry)
        self.workspace = Workspace(self.hexapod)
        self.washout = washout.build(every, geometry, self.workspace.ends[:3])
        self.governor = Governor(geometry, self.hexapod, every, config.catch_up)
        self.legs = Legs(geometry, every, self.hexapod.neutral_legs)
        self.start: float | None = None  # [s]
        self.past = np.zeros((2, 6))  # the last two poses
        self.on_plan = self.washout.plans_legs  # whether the last one was of a plan that keeps the limits itself

    @property
    def neutral_legs(self) -> np.ndarray:
        return self.hexapod.neutral_legs

    def follow(self, ride: Ride, ahead: Ride | Planner | None = None) -> Commands:
        """Commands of the platform for the next rows of ship motion. Steps: washout, ramp from neutral, workspace,
        limits of the legs, leg lengths. `ahead`: motion after these rows, or what plans, if there is either."""
        if self.start is None:
            self.start = float(ride.time[0])
        cue = self.washout.follow(ride, ahead)
        planned = self.washout.plans_legs
        if planned and self.on_plan:
            pose, limited = cue.pose.copy(), cue.limited
        else:
            wanted = cue.pose * self.ramp_share(ride.time)[:, None]
            within, scaled = (wanted, cue.limited) if planned else self.workspace.scale_back(wanted)
            if self.on_plan:
                self.governor.begin(self.past, within[0])
            pose, slowed = self.governor.follow(within, wanted)
            limited = cue.limited | scaled | slowed
            self.on_plan = planned and self.governor.is_there
        legs, velocity, held = self.move_legs(self.legs, pose)
        limited = limited | held
        force, rate = self.felt_motion(pose)
        return Commands(ride.time, ride.seq, pose, legs, velocity, force, rate, limited, cue)

    def best(self, done: Commands) -> Commands:
        """Commands of the best motion within the limits, planned over the whole ride, for the motion that the washout
        requested in `done`; raises Lacking, and Failed if there is none."""
        rows = np.column_stack([done.time, done.cue.force, done.cue.rate])
        pose = leg_programme.best_poses(self.geometry, self.hexapod, rows)
        legs, none = self.hexapod.legs(pose), np.zeros(len(pose), dtype=int)
        velocity = np.diff(legs, axis=0, prepend=legs[:1]) / self.every
        force, rate = felt_by_differences(np.vstack([np.zeros((2, 6)), pose]), self.every)
        return done._replace(
            pose=pose, legs=legs, leg_velocity=velocity, felt_force=force, felt_rate=rate, limited=none
        )

    def move_legs(self, legs: Legs, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Lengths (n, 6) [m], speeds (n, 6) [m/s] and limits that acted (n,), as bits, of the legs for wanted poses (n,
        6). Where legs cannot reach a pose in time, its row of `pose` is overwritten by the pose reached."""
        free = self.hexapod.legs(pose)
        within = np.clip(free, self.hexapod.low, self.hexapod.high)
        lengths, speeds, limited = legs.follow(within)
        late = (limited > 0) | (free != within).any(axis=1)
        if late.any():
            found = self.hexapod.pose(lengths[late], pose[late])
            lost = np.isnan(found)  # legs that no pose near has: the one that was wanted stays
            pose[late] = np.where(lost, pose[late], found)
            limited[late] |= np.where(lost.any(axis=1), SINGULARITY_LIMIT, 0)
        return lengths, speeds, limited

    def return_home(self, past: np.ndarray, time: float, seq: int) -> Commands:
        """Commands from the last two poses, `past` (2, 6), back to neutral, in the time of the ramp or, if legs are
        slow, longer. The last pose was at `time` [s], in the command row numbered `seq`."""
        lengths, every, machine = self.hexapod.legs(past), self.every, self.geometry
        stroke = machine.longest - machine.shortest
        longest = stroke / machine.leg_speed + machine.leg_speed / machine.leg_acceleration  # [s]
        count = np.arange(1, round((self.ramp + GLIDE_TIME + 2.0 * longest) / every) + 2)
        t = (count * every)[:, None]
        glide = past[1] + (past[1] - past[0]) / every * GLIDE_TIME * (1.0 - np.exp(-t / GLIDE_TIME))
        pose = glide * (1.0 - (smooth_step(np.minimum(t / self.ramp, 1.0)) if self.ramp > 0.0 else 1.0))
        drives = Legs(machine, every, lengths[1], (lengths[1] - lengths[0]) / every)
        legs, velocity, limited = self.move_legs(drives, pose)
        home = (count >= round(self.ramp / every)) & (np.abs(legs - self.hexapod.neutral_legs).max(axis=1) < LEG_MATCH)
        self.past = past
        force, rate = self.felt_motion(pose)
        cue, end = Cue(pose, limited, force, rate), int(np.argmax(home)) + 1 if home.any() else len(count)
        rows = Commands(time + t[:, 0], seq + count, pose, legs, velocity, force, rate, limited, cue)
        return rows.select(slice(end))

    def ramp_share(self, time: np.ndarray) -> np.ndarray:
        """Factors (n,) on poses at times (n,) [s], which rise from 0 to 1 during the ramp at the start of the ride."""
        if self.ramp == 0.0:
            return np.ones(len(time))
        return smooth_step(np.clip((time - self.start) / self.ramp, 0.0, 1.0))

    def felt_motion(self, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Specific force (n, 3) [m/s2] and rate (n, 3) [rad/s] felt in poses (n, 6), the rows after the last call."""
        known = np.vstack([self.past, pose])
        self.past = known[-2:]
        return felt_by_differences(known, self.every)


def felt_by_differences(known: np.ndarray, every: float) -> tuple[np.ndarray, np.ndarray]:
    """Specific force (n, 3) [m/s2] and rate (n, 3) [rad/s] felt on a platform, in its axes, at the last n poses of
    `known` (n + 2, 6), rows `every` [s]. Backward differences: acceleration lags by one row, the rate by half a row."""
    rates = np.diff(known, axis=0)[1:, 3:] / every
    acceleration = np.diff(known[:, :3], n=2, axis=0) / every**2
    return felt_motion(known[2:], acceleration, rates)
