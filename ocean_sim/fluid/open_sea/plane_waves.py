"""Plane waves of linear theory as kernels read them: the formulae of `ocean_sim.waves`, on the device."""

import numpy as np

from ocean_sim import waves
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Array2, Doubles2, in_kernels, runs_alone


@in_kernels
class PlaneWaves:
    """Plane waves of a sea at one time, as Taichi fields for kernels."""

    def __init__(self, sea: waves.Components) -> None:
        n = len(sea.amplitude)
        self.amplitude, self.phase, self.k, self.kx, self.kz, self.speed = (ti.field(float, shape=n) for _ in range(6))
        self.at_first = ti.Vector.field(4, ti.f64, shape=n)  # phase, omega and k along x and z, in turns
        self.grown = ti.field(float, shape=())  # the share of their height that they have
        self.real = to_numpy_type(self.phase.dtype)
        self.begun = 0  # times
        self.begin(sea)

    @staticmethod
    def bytes(waves: int, word: int) -> int:
        """Memory [bytes] of the fields of so many waves; `word`: size of a `float` [bytes]."""
        return waves * (6 * word + 4 * 8) + word

    def begin(self, sea: waves.Components) -> None:
        """Replace the waves by others, of the same number and depth, and restart at time 0."""
        self.sea = sea
        self.begun += 1
        speed = sea.amplitude * sea.gravity * sea.wavenumber / sea.omega
        each = np.stack([sea.amplitude, sea.wavenumber, *sea.wavevector.T, speed], axis=1)
        turns = np.stack([sea.phase, sea.omega, *sea.wavevector.T], axis=1) / (2.0 * np.pi)
        self.store_waves(each.astype(self.real), turns)
        self.set_time(0.0)

    @ti.kernel
    def store_waves(self, each: Array2, turns: Doubles2):
        """Copy `each` (n, 5): amplitude, k, kx, kz, speed; `turns` (n, 4): phase, omega, kx, kz, each over 2 pi."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in range(self.amplitude.shape[0]):
            self.amplitude[i], self.k[i], self.speed[i] = each[i, 0], each[i, 1], each[i, 4]
            self.kx[i], self.kz[i] = each[i, 2], each[i, 3]
            for c in ti.static(range(4)):
                self.at_first[i][c] = turns[i, c]

    def set_time(self, time: float, drift: tuple[float, float] = (0.0, 0.0)) -> None:
        """Set the phases, reduced in f64, for a time [s] and a `drift` along x and z [m] by the current."""
        self.compute_phases(time, *drift, self.sea.ramp_share(time))

    @ti.kernel
    def compute_phases(self, time: ti.f64, x: ti.f64, z: ti.f64, share: float):
        """Compute the phase of each wave at a time [s] for a drift x, z [m]; `share`: height by the ramp, 0 to 1."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in range(self.phase.shape[0]):
            first = self.at_first[i]
            turns = first[0] - first[1] * time - first[2] * x - first[3] * z
            self.phase[i] = 2.0 * tm.pi * ti.cast(turns - ti.floor(turns), float)
        self.grown[None] = share

    @ti.func
    def elevation(self, x, z):
        """Elevation [m] of the sum of all waves at x, z [m]."""
        eta = 0.0
        for i in range(self.amplitude.shape[0]):
            eta += self.amplitude[i] * ti.cos(self.kx[i] * x + self.kz[i] * z + self.phase[i])
        return self.grown[None] * eta

    @ti.func
    def stretched(self, position, eta):
        """Height [m], at most 0, to which Wheeler stretching maps a position [m] below the elevation eta [m]."""
        h = ti.static(self.sea.depth)
        return ti.min(h * (position.y - eta) / ti.max(h + eta, 1e-6 * h), 0.0)

    @ti.func
    def velocity(self, position):
        """Velocity [m/s] of the water at a position [m], by Wheeler stretching; above the water that of its surface."""
        h, y = ti.static(self.sea.depth), self.stretched(position, self.elevation(position.x, position.z))
        v = tm.vec3(0.0)
        for i in range(self.amplitude.shape[0]):
            k, angle = self.k[i], self.kx[i] * position.x + self.kz[i] * position.z + self.phase[i]
            scale = self.speed[i] * ti.exp(k * y) / (1.0 + ti.exp(-2.0 * k * h))
            mirrored = ti.exp(-2.0 * k * (y + h))
            along = scale * (1.0 + mirrored) * ti.cos(angle) / k
            v += tm.vec3(self.kx[i] * along, scale * (1.0 - mirrored) * ti.sin(angle), self.kz[i] * along)
        return self.grown[None] * v
