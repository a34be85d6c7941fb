"""Keys of a sea in a scene: calm water, regular or random waves, several on top of each other, and lists."""

from math import pi
from pathlib import Path
from typing import ClassVar

import numpy as np

from ocean_sim import waves
from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Checked, FileName, Rule, Unreadable
from ocean_sim.model import Fault, Model, below, quantity
from ocean_sim.waves import exchange

ONSET_PERIODS = 5.0  # [periods] time in which the nonlinear terms set in
COMPONENT_COLUMNS = ("amplitude_m", "period_s", "heading_deg", "phase_deg")
POSITIVE_PERIODS = Rule("every period_s is above 0")
CHECKED_FILE = "Plane waves of a sea, `fluid.spectral_sea.components`: a table, or a .swd file"
CHECKS = (Checked(CHECKED_FILE, (POSITIVE_PERIODS, exchange.SWD_RULE)),)


class Steepening(Model):
    """Keys of a sea whose waves steepen by nonlinear terms: time in which these set in, and breaking of its crests."""

    onset: float | None = quantity("s", None, ge=0.0)
    """Time over which the nonlinear terms set in, at order 3 (Dommermuth 2000); null: five periods."""
    breaking: bool = True
    """True: crests of a nonlinear sea break where the water on them moves faster than 0.85 of their speed (Barthelemy
    et al. 2018, J. Fluid Mech. 841)."""

    def onset_in(self, period: float) -> float:
        """Time [s] in which the nonlinear terms grow to full strength; `period`: of the highest waves [s]."""
        return ONSET_PERIODS * period if self.onset is None else self.onset


class Seas(waves.OpenTrain):
    """Calm water, regular waves (`height`, `period`, `heading_deg`) or a `spectrum`, and more `spectra` on top."""

    may_be_calm: ClassVar[bool] = True
    height: float | None = quantity("m", None, ge=0.0)
    """Height from trough to crest; 0 is calm water."""
    spectra: list[waves.OpenTrain] = []
    """Further spectra, such as swell on top of a wind sea."""
    components: FileName | waves.FileSpectrum | None = None
    """Plane waves on top of all others: a CSV file of `amplitude_m`, `period_s`, `heading_deg`, `phase_deg`, each wave
    amplitude cos(k . x - omega t + phase); a spectral-wave-data file (.swd) of linear waves; or the keys of a spectrum
    from a `file`."""

    @property
    def trains(self) -> list[tuple[tuple[str | int, ...], waves.OpenTrain]]:
        """Wave trains of the sea, each with its path of config keys: the sea's own, if any, and those of `spectra`."""
        own = [((), self)] if self.height is not None or self.spectrum is not None else []
        file = [self.components] if isinstance(self.components, waves.FileSpectrum) else []
        listed = [(("components",), waves.OpenTrain(spectrum=each)) for each in file]
        return [*own, *((("spectra", n), sea) for n, sea in enumerate(self.spectra)), *listed]

    @property
    def highest(self) -> tuple[float, float] | None:
        """Height [m] and period [s] of the highest wave train; None in calm water."""
        sizes = [train.scale for _, train in self.trains]
        table = self.table()
        if table is not None and len(table["amplitude_m"]):
            a = table["amplitude_m"]
            sizes.append((float(2.0 * np.linalg.norm(a)), float(table["period_s"][np.argmax(a)])))
        return max(sizes) if sizes else None

    def table(self) -> dict[str, np.ndarray] | None:
        """Columns by name of the file `components`, a list of plane waves; None without a file. Raises Unreadable."""
        if not isinstance(self.components, str):
            return None
        if Path(self.components).suffix == ".swd":
            sea = exchange.of_swd(self.components)
            heading = np.degrees(np.arctan2(sea.wavevector[:, 0], sea.wavevector[:, 1]))
            return dict(zip(COMPONENT_COLUMNS, (sea.amplitude, 2.0 * pi / sea.omega, heading, np.degrees(sea.phase))))
        found = csv_file.Table(self.components)
        period = found.finite(*COMPONENT_COLUMNS)[1]
        if (period <= 0.0).any():
            row = int(period.argmin())
            raise POSITIVE_PERIODS.broken(self.components, f"period_s is {period[row]:g} in row {row + 1}")
        return found

    def sea_of(self, basin: waves.Tank, count: int = waves.SPECTRUM_WAVES) -> waves.Components:
        """Sum of all plane waves of this sea on the water of a basin; each spectrum becomes `count` waves."""
        depth, g = basin.depth, waves.downward_gravity(basin)
        found = [train.sea(basin, count) for _, train in self.trains]
        table = self.table()
        if table is not None:
            k = waves.wavenumber(2.0 * pi / table["period_s"], depth, g)
            ahead = np.stack([waves.heading_vector(float(angle), basin.dimension) for angle in table["heading_deg"]])
            phase = np.radians(table["phase_deg"])
            found.append(waves.Components(table["amplitude_m"], k[:, None] * ahead, phase, depth, g))
        return waves.combine(found, depth, g)

    def like_radians(self) -> list[str]:
        """Warnings that angles in the CSV file `components` look like radians instead of degrees; empty if none do."""
        table = self.table()
        return table.like_radians() if isinstance(table, csv_file.Table) else []

    def sea_faults(self, basin: waves.Tank) -> list[Fault]:
        """Reasons why this sea is impossible in a basin, as (path of config keys, sentence)."""
        found: list[Fault] = [(("kind",), sentence) for sentence in waves.basin_faults(basin)]
        try:
            self.table()
        except Unreadable as error:
            found.append((("components",), str(error)))
        return found or [fault for key, train in self.trains for fault in below(*key, faults=train.faults(basin))]
