"""Sides before which waves are absorbed: what a user may say of one."""

from collections.abc import Iterator
from dataclasses import replace
from math import radians
from typing import Literal

from ocean_sim import waves
from ocean_sim.model import Model, Vector3, quantity

Problems = Iterator[tuple[tuple[str, ...], str]]  # path below the side, sentence


class Sea(waves.HeadedTrain):
    """Waves by linear theory, without beginning or end."""

    phase_deg: float = quantity("deg", 0.0)
    """Phase added to that of each wave; without it regular waves have a crest at the origin at time 0."""

    def sea(self, basin: waves.Tank) -> waves.Components:
        sea = super().sea(basin)
        return replace(sea, phase=sea.phase + radians(self.phase_deg))


class Target(Model):
    """A motion of the water: a current and waves, either or both."""

    current: Vector3 = quantity("m/s", (0.0, 0.0, 0.0))
    """A current, the same everywhere and horizontal."""
    waves: Sea | None = None
    """Regular waves by `height` and `period`, or random ones by a `spectrum`; they must fit periodic sides, as waves
    that the water starts from must."""


class Absorbing(Model):
    """A wall with a zone before it that damps the motion of the water, ever faster up to the wall."""

    kind: Literal["absorbing"] = "absorbing"
    length: float | None = quantity("m", None, gt=0.0)
    """Length of the zone; null: from the waves of the scene, one wavelength where they are regular and two where
    they are random, at most half the basin; a quarter of the basin where the scene names no waves."""
    rate: float | None = quantity("1/s", None, gt=0.0)
    """Rate of the damping at the wall; null: the one that returns least of these waves; without waves 2.5 sqrt(g /
    depth)."""
    target: Target | None = None
    """The motion that the zone leaves alone; null: rest."""

    def problems(self, basin: waves.Tank, size: float) -> Problems:
        """What is wrong with it in a basin that is so long [m] along its axis."""
        if self.length is not None and self.length > size:
            yield ("length",), f"a zone of {self.length:g} m is longer than the basin, {size:g} m"
        if self.target is None:
            return
        u, sea = self.target.current, self.target.waves
        if u[1] != 0.0 or (basin.dimension == 2 and u[2] != 0.0):
            level = "along x" if basin.dimension == 2 else "along x and z"
            yield ("target", "current"), f"a current of this basin is {level}, got {list(u)}"
        if sea is not None:
            for key, sentences in (
                (sea.height_key, waves.unsuited(basin, *sea.scale)),
                (sea.heading_key, waves.misdirected(sea.heading, basin)),
            ):
                yield from ((("target", "waves", *key), sentence) for sentence in sentences)
