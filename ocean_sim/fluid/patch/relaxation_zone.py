"""Relaxation zone of a patch of open sea: its width, its rate and the sea that it relaxes towards.

In the band dv/dt = rate s^q (sea - v), q = DAMPING_POWER; s grows from 0 at its inner edge to 1 at the seam opposite
the ship. A feed gives all water the energy that the scheme takes from the sea. The complex height a of a wave, over
that of the sea, then follows in the ship's axes and along its way xi

    (group speed - U) da/dxi = -loss a + (rate s^q / 2) (1 - a) + feed / 2,

with U the ship's speed along xi; the real part of `loss` is the decay of the height, its imaginary part minus the
deficit of the frequency. So feed = 2 loss holds the wave up also where the ship keeps up with it and no band renews
it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import ceil, exp, pi

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import whole_sides
from ocean_sim.basin.open_sea import Nonlinear, width_over_length
from ocean_sim.fluid.sph.initial_state import MIN_WAVE_SPACINGS, NOTABLE_LOST_VARIANCE, patch_waves
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.waves.absorption import DAMPING_POWER

RIM_WIDTH_WAVES = 0.75  # [wavelengths] on either side of the seam
RIM_RATE_RATIO = 1.5  # rate at the seam over the frequency of the highest waves [rad/s]
MAX_RIM_SHARE = 0.25  # share of the patch in the band on either side
MAX_WAKE_SHARE = 0.05  # share of the height of a ship's waves that may pass the band
MIN_RIM_WAVES = 0.7  # [wavelengths] a narrower band returns more than a twentieth of a ship's waves
MAX_HEIGHT_DEFICIT = 0.07  # share of the height of the sea that may be lacking at the ship
PATCH_PIECES = 400  # pieces of the way round a patch
VARIANCE_ROUNDING = 1e-6  # share of the variance that counts as none
MIN_RELATIVE_SPEED = 1e-3  # [group speeds] a slower ship, seen from the waves, keeps up with them
MAX_WAVENUMBER_CHANGE = 0.1  # share of its wavenumber by which fitting may change a wave without a warning
MIN_PATCH_WAVES = 3  # shortest patch [wavelengths]: one and a half for the rims, as much between them


@dataclass(frozen=True)
class RelaxationBand:
    """Relaxation zone in the rim of a patch of open sea, and the sea to whose velocity it relaxes the water."""

    lattice: Lattice
    width: float  # [m] on either side of the seam
    rate: float  # [1/s] at the seam
    sea: waves.Components | None  # None: calm water
    losses: np.ndarray | None  # (n,) complex, of each wave of the sea by the scheme [1/s]; None where it is unknown
    feed: np.ndarray  # (n,) complex, of each wave of the sea [1/s]
    nonlinear: Nonlinear | None = None  # how the sea is; None: it is the sum of its waves
    requested: waves.Components | None = None  # the sea before it was fitted to the patch

    @property
    def sides(self) -> tuple[float, ...]:
        """Lengths of the patch along x and z [m]."""
        return tuple(period for period in self.lattice.basin.periods if period)

    def height_profile(self, with_waves: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Distances (n,) [m] from a ship, round the patch along its highest waves, and their height there over that in
        the sea, complex by phase; None: losses unknown. `with_waves`: her speed along them over their group speed."""
        if self.sea is None or self.losses is None:
            return None
        loss, feed = (complex(of[self.sea.highest]) for of in (self.losses, self.feed))
        k = self.sea.wavevector[self.sea.highest]
        axis, size = int(np.argmax(np.abs(k[: len(self.sides)]))), float(np.hypot(*k))
        group = float(waves.group_speed(size, self.sea.depth, self.sea.gravity)) * abs(float(k[axis])) / size
        side = self.sides[axis]  # of the patch, nearest to the way of the highest waves
        xi = (np.arange(PATCH_PIECES) + 0.5) / PATCH_PIECES * side - 0.5 * side
        inside = np.clip((np.abs(xi) - (0.5 * side - self.width)) / self.width, 0.0, 1.0)
        pull = 0.5 * self.rate * inside**DAMPING_POWER
        taken = loss + pull
        aim = np.divide(pull + 0.5 * feed, taken, out=np.ones(PATCH_PIECES, dtype=complex), where=taken != 0.0)
        speed = (1.0 - with_waves) * group
        if abs(speed) < MIN_RELATIVE_SPEED * group:
            return xi, aim
        left = np.exp(-taken * side / PATCH_PIECES / abs(speed))  # of what comes into a piece, less its aim
        order = range(PATCH_PIECES) if speed > 0.0 else range(PATCH_PIECES - 1, -1, -1)
        height, a = np.zeros(PATCH_PIECES, dtype=complex), 0.0j
        for _ in range(2):  # the second time round from what is there after the first, of all that is not lost
            for n in order:
                a = aim[n] + (a - aim[n]) * left[n]
                height[n] = a
            once = np.prod(left)
            a = a / (1.0 - once) if once != 1.0 else 1.0 + 0.0j
        return xi, height

    def height_at_ship(self, with_waves: float) -> complex | None:
        """Height of highest waves at the ship over the sea's, complex by phase; `with_waves`: see `height_profile`."""
        found = self.height_profile(with_waves)
        return complex(found[1][PATCH_PIECES // 2]) if found is not None else None

    @property
    def wake_transmission(self) -> float:
        """Share of a ship's wave height that passes the rim, of waves as long as the sea's (calm: 4/3 rim widths)."""
        basin, calm = self.lattice.basin, 2.0 * pi * RIM_WIDTH_WAVES / self.width
        k = calm if self.sea is None else float(self.sea.wavenumber[self.sea.highest])
        group = float(waves.group_speed(k, basin.depth, waves.downward_gravity(basin)))
        return exp(-self.rate * self.width / (1.0 + DAMPING_POWER) / group)

    def describe_waves(self, sea: waves.Components) -> str:
        """Text with length, period and, in 3-D, heading of the highest waves of a sea."""
        found = f"{sea.wavelength:.4g} m and {sea.period:.4g} s"
        return f"{found}, heading {sea.heading_deg:.4g} deg" if len(self.sides) > 1 else found

    def fit_change(self) -> str | None:
        """Advice if making the highest waves periodic on the patch changes them much, else None."""
        if self.sea is None or self.requested is None:
            return None
        k, fits = (of.wavevector[of.highest] for of in (self.requested, self.sea))
        length = float(np.hypot(*k))
        off = abs(np.hypot(*fits) - length) if self.sea.random else np.hypot(*(fits - k))
        if off < MAX_WAVENUMBER_CHANGE * length:
            return None
        better = []
        for name, side, along, fit in zip(("length", "width"), self.sides, np.abs(k), np.abs(fits)):
            crests = max(round(fit * side / (2.0 * pi)), ceil(MIN_PATCH_WAVES * along / length - 1e-9))
            better += [f"basin.{name}: {2.0 * pi * crests / along:.4g}"] if along > 1e-9 * length else []
        asked, became = self.describe_waves(self.requested), self.describe_waves(self.sea)
        cure = f"{' and '.join(better)} would keep them"
        return f"waves of {asked} do not fit the patch and became waves of {became}; {cure}"

    @property
    def unresolved_share(self) -> float:
        """Share of the requested sea's variance in waves too short for the particle spacing."""
        if self.sea is None or self.requested is None:
            return 0.0
        return max(0.0, 1.0 - (self.sea.significant_height / self.requested.significant_height) ** 2)

    def resolution_note(self) -> str | None:
        """Sentence on the wave height that is left if some waves are too short for the particles, else None."""
        share = self.unresolved_share
        if self.sea is None or self.requested is None or share < VARIANCE_ROUNDING:
            return None
        left, asked = self.sea.significant_height, self.requested.significant_height
        told = f"{share:.2g} of the variance of the sea is in waves of fewer than {MIN_WAVE_SPACINGS:g} particles,"
        why = "which are left out:"
        return f"{told} {why} its significant height is {left:.4g} m on the patch (asked for: {asked:.4g} m)"

    def statements(self) -> Iterator[str]:
        """Yield sentences that describe the patch, its rim and its sea."""
        head = f"a patch of open sea: its rim is {self.width:.3g} m wide on either side, rate {self.rate:.3g} 1/s"
        live = "particles are a sea for films and figures; for a live ship take fluid.kind: spectral_sea"
        if self.sea is None:
            yield from (f"{head}; the sea is calm", live)
            return
        count = f"{len(self.sea.amplitude)} plane waves, the highest" if self.sea.random else "one wave,"
        size, asked = self.describe_waves(self.sea), self.describe_waves(self.requested or self.sea)
        was = f" (asked for: {asked})" if asked != size else ""
        yield from (f"{head}; the sea is fitted to the patch: {count} of {size}{was}", live)
        if self.nonlinear is not None:
            cells = " x ".join(str(n) for n in tile_cells(self)[: len(self.sides)])
            sets_in = f"which sets in over the first {self.nonlinear.onset:.3g} s"
            yield f"the sea is nonlinear to third order on {cells} cells, {sets_in}"
        short = self.resolution_note()
        if short is not None and self.unresolved_share <= NOTABLE_LOST_VARIANCE:
            yield short
        if self.sea.ramp > 0.0:
            yield f"the sea grows from calm water over the first {self.sea.ramp:.3g} s"
        at_rest, following = self.height_at_ship(0.0), self.height_at_ship(1.0)
        if at_rest is None or following is None:
            yield "how much of its height the sea has at the ship is not known for this scheme"
            return
        fed = "" if self.feed.any() else ", then without a feed" if self.sea.ramp > 0.0 else ", without a feed"
        opening = f"by a 1-D model the sea has {abs(at_rest):.2g} of its height at a ship at rest and"
        yield f"{opening} {abs(following):.2g} at one that keeps up with it{fed}"

    def warnings(self, duration: float) -> Iterator[str]:
        """Yield warnings of a patch whose sides, rim or spacing do not suit its waves, for a run of `duration` [s]."""
        if self.sea is not None:
            yield from waves.cut_short(duration, self.sea.ramp)
        if (changed := self.fit_change()) is not None:
            yield changed
        if self.unresolved_share > NOTABLE_LOST_VARIANCE:
            yield f"{self.resolution_note()}; take a smaller spacing"
        if self.sea is not None and self.width < MIN_RIM_WAVES * self.sea.wavelength and self.rate > 0.0:
            told = f"the rim of the patch is {self.width:.3g} m wide,"
            why = f"less than {MIN_RIM_WAVES:g} of the wavelength of {self.sea.wavelength:.3g} m:"
            yield f"{told} {why} it returns more than a twentieth of the ship's waves; take a larger patch"
        elif self.wake_transmission > MAX_WAKE_SHARE:
            told = f"a rim {self.width:.3g} m wide of a rate of {self.rate:.3g}"
            why = f"1/s lets {self.wake_transmission:.0%} of the height of a ship's waves through,"
            yield f"{told} {why} and she meets her own wake; leave rim.rate out"
        for speed, who in ((0.0, "at rest"), (1.0, "that keeps up with it")):
            there = self.height_at_ship(speed)
            if there is not None and abs(there) < 1.0 - MAX_HEIGHT_DEFICIT:
                yield f"the sea has {abs(there):.2g} of its height at a ship {who}, by a 1-D model"

    def ships_in_rim(self, ships: Mapping[str, np.ndarray]) -> Iterator[str]:
        """Yield a warning for each of these ships (x, z [m] by name) that starts in the relaxation zone."""
        if len(ships) < 2:
            return
        at, periods = np.array(list(ships.values())), np.array(self.lattice.basin.periods)[[0, 2]]
        far = rim_depth(at - at.mean(axis=0), periods, self.width)
        inside = [name for name, depth in zip(ships, far, strict=True) if depth > 0.0]
        there = f"{' and '.join(inside)} begin {far.max():.3g} m inside the rim of the patch, which lies opposite the"
        if inside:
            yield f"{there} middle of all ships; take a larger patch"


def rim_depth(away: np.ndarray, periods: np.ndarray, width: float) -> np.ndarray:
    """Distance (n,) [m] into the rim, `width` [m], of a patch with sides `periods` [m], negative outside the rim;
    `away` (n, 2) [m]: x, z from the patch's centre."""
    depth = np.abs(away - whole_sides(away, periods)) - (0.5 * periods - width)
    return np.where(periods > 0.0, depth, -np.inf).max(axis=-1)


def relaxation_band(lattice: Lattice) -> RelaxationBand | None:
    """Make the relaxation zone for the water on a lattice; None if it is no patch of open sea."""
    basin = lattice.basin
    if basin.sea is None:
        return None
    rim, sea = basin.sea.rim, patch_waves(basin, lattice.spacing)
    least = MAX_RIM_SHARE * min(period for period in basin.periods if period)
    width = rim.width or (least if sea is None else min(RIM_WIDTH_WAVES * sea.wavelength, least))
    calm = 2.0 * pi * RIM_WIDTH_WAVES / width, basin.depth, waves.downward_gravity(basin)
    omega = float(waves.angular_frequency(*calm)) if sea is None else 2.0 * pi / sea.period
    rate = RIM_RATE_RATIO * omega if rim.rate is None else rim.rate
    losses = None if sea is None else lattice.config.losses(lattice, sea)
    nonlinear = basin.sea.nonlinear
    if sea is not None and losses is not None and nonlinear is None:
        losses = losses + 1j * sea.omega * stokes_shift(sea)
    n = 0 if sea is None else len(sea.amplitude)
    feed = np.zeros(n, dtype=complex) if losses is None else 2.0 * losses
    if basin.sea.feed is not None:
        feed = np.full(n, basin.sea.feed, dtype=complex)
    return RelaxationBand(lattice, width, rate, sea, losses, feed, nonlinear, basin.sea.plane_waves(basin))


def tile_cells(band: RelaxationBand) -> tuple[int, int]:
    """Numbers of cells along x, z of the grid (tile) of a nonlinear sea on a patch: about one a particle spacing."""
    basin = band.lattice.basin
    share = width_over_length(basin.periods)
    assert share is not None
    along = basin.periods[0] / band.lattice.spacing
    parts = share.denominator * max(1, round(along / share.denominator))
    return parts, parts * share.numerator // share.denominator if basin.periods[2] else 1


def stokes_shift(sea: waves.Components) -> float:
    """Relative rise of a regular wave's frequency by its height (Stokes, third order); 0 for random waves."""
    if sea.random:
        return 0.0
    steepness = float(sea.wavenumber[0] * np.sqrt((sea.amplitude**2).sum()))
    t = float(np.tanh(sea.wavenumber[0] * sea.depth)) ** 2
    return steepness**2 * (9.0 - 10.0 * t + 9.0 * t**2) / (16.0 * t**2)
