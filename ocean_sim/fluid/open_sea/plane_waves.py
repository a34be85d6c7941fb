"""Plane waves of linear theory as kernels read them: the formulae of `ocean_sim.waves`, on the device; and on a small
lattice around a hull, which lies still in the water for a moment.

The waves are summed when the lattice is laid, for two times a moment apart. Hermite's cubic between the two has their
velocities and accelerations, and the acceleration is its slope. On a lattice the angles of a wave are a + i b + k c, so
its cosines and sines are products of few numbers.
"""

from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Array2, Doubles2, in_kernels, runs_alone

SPAN_ANGLE = 0.8  # [rad] turn between the two times of the waves that give the water most jerk
ANGLE_FIRST, ANGLE_LATER, ANGLE_ALONG, ANGLE_ACROSS = range(4)  # of the first node at both times; node to node


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
        """Memory [bytes] of the fields for this number of waves; `word`: bytes of a `float`."""
        return waves * (6 * word + 4 * 8) + word

    def begin(self, sea: waves.Components) -> None:
        """Replace the waves by as many others in the same depth, and restart at time 0."""
        self.sea = sea
        self.begun += 1
        speed = sea.amplitude * sea.gravity * sea.wavenumber / sea.omega
        each = np.stack([sea.amplitude, sea.wavenumber, *sea.wavevector.T, speed], axis=1)
        turns = np.stack([sea.phase, sea.omega, *sea.wavevector.T], axis=1) / (2.0 * np.pi)
        self.store_waves(each.astype(self.real), turns)
        self.set_time(0.0)

    @ti.kernel
    def store_waves(self, each: Array2, turns: Doubles2):
        """Store n waves: `each` (n, 5): amplitude, k, kx, kz, orbital speed; `turns` (n, 4): phase, omega, kx and kz,
        each over 2 pi, in float64, so that `compute_phases` is exact at late times."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in range(self.amplitude.shape[0]):
            self.amplitude[i], self.k[i], self.speed[i] = each[i, 0], each[i, 1], each[i, 4]
            self.kx[i], self.kz[i] = each[i, 2], each[i, 3]
            for c in ti.static(range(4)):
                self.at_first[i][c] = turns[i, c]

    def set_time(self, time: float, drift: tuple[float, float] = (0.0, 0.0)) -> None:
        """Set the phases (reduced in float64) to a time [s] and a `drift` along x and z [m] by the current."""
        self.compute_phases(time, *drift, self.sea.ramp_share(time))

    @ti.kernel
    def compute_phases(self, time: ti.f64, x: ti.f64, z: ti.f64, share: float):
        """Compute each wave's phase at a time [s] and drift x, z [m]; store the ramp's `share` of full wave height."""
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
        """Height [m], at most 0, to which Wheeler stretching maps a `position` [m] under the elevation `eta` [m]."""
        h = ti.static(self.sea.depth)
        return ti.min(h * (position.y - eta) / ti.max(h + eta, 1e-6 * h), 0.0)

    @ti.func
    def velocity(self, position):
        """Velocity [m/s] of the water at a position [m], by Wheeler stretching; above it, that of its surface."""
        h, y = ti.static(self.sea.depth), self.stretched(position, self.elevation(position.x, position.z))
        v = tm.vec3(0.0)
        for i in range(self.amplitude.shape[0]):
            k, angle = self.k[i], self.kx[i] * position.x + self.kz[i] * position.z + self.phase[i]
            scale = self.speed[i] * ti.exp(k * y) / (1.0 + ti.exp(-2.0 * k * h))
            mirrored = ti.exp(-2.0 * k * (y + h))
            along = scale * (1.0 + mirrored) * ti.cos(angle) / k
            v += tm.vec3(self.kx[i] * along, scale * (1.0 - mirrored) * ti.sin(angle), self.kz[i] * along)
        return self.grown[None] * v


@in_kernels
class Window:
    """Lookup table, laid around a hull, of the sum of plane waves at full height (no ramp in time), on a lattice of
    nodes and Wheeler-stretched depths. Sums are stored for two times a moment apart, and interpolated between."""

    def __init__(self, water: Any, size: tuple[int, int], step: tuple[float, float], depths: tuple[float, ...]) -> None:
        """Make a table for OpenWater `water`: `size` nodes in x, z, `step` [m] apart; levels `depths` [m], first 0."""
        self.water, self.size, self.step, self.depths = water, size, step, depths
        self.depth = water.waves.sea.depth  # of the water [m]
        self.n, self.sums = len(water.waves.sea.amplitude), 1 + 3 * len(depths)
        # Amplitudes of a wave at the cosine and at the sine of its angle: the elevation and its growth, and on each
        # level velocity or acceleration along x, upwards and along z.
        self.gives = ti.field(float, shape=(2, self.sums, self.n))
        self.line = ti.field(float, shape=(2, 2, size[0], self.n))  # cosine and sine, at both times
        self.row = ti.field(float, shape=(2, size[1], self.n))
        self.level, self.growth = (ti.field(float, shape=(2, *size)) for _ in range(2))  # at both times [m], [m/s]
        self.speed, self.pull = (ti.Vector.field(3, float, shape=(2, *size, len(depths))) for _ in range(2))
        self.clock = ti.field(float, shape=())  # the time between both [s]
        self.angles = np.zeros((4, self.n))
        self.begun, self.start, self.span = -1, 0.0, 1.0  # which waves, and when and for how long it was laid [s]

    @staticmethod
    def bytes(size: tuple[int, int], levels: int, waves: int, word: int) -> int:
        """Memory [bytes] of a Window of `size` nodes, so many levels and waves; `word`: bytes of a `float`."""
        sums = 1 + 3 * levels
        return word * (waves * (2 * sums + 4 * size[0] + 2 * size[1]) + 4 * size[0] * size[1] * sums + 1)

    def now(self) -> tuple[float, float, bool]:
        """Time of the floating bodies, as a share of the way from the first to the second time of the table (0 to 1 if
        it still serves); the ramp's factor of wave height then; True if the stored sums serve."""
        time, there = self.water.before, self.water.waves
        others = self.begun != there.begun
        if others:
            self.begun = there.begun
            self.set_waves(there.sea)
        late = (time - self.start) / self.span
        return late, there.sea.ramp_share(time), not others and 0.0 <= late <= 1.0

    @property
    def current(self) -> tuple[float, float]:
        """Velocity (x, z) [m/s] of the current, which carries the waves."""
        return self.water.current

    def set_waves(self, sea: waves.Components) -> None:
        """Set each wave's amplitudes of elevation, velocity, acceleration at the table's depths, and its time span."""
        a, k, omega, g = sea.amplitude, sea.wavenumber, sea.omega, sea.gravity
        kx, kz = sea.wavevector.T
        cosines, sines = [a], [a * omega]
        for depth in self.depths:
            c, s = waves.profiles(k, -depth, sea.depth)
            cosines += [a * g / omega * kx * c, -a * g * k * s, a * g / omega * kz * c]
            sines += [a * g * kx * c, a * g / omega * k * s, a * g * kz * c]
        numbers = np.array([cosines, sines])
        self.gives.from_numpy(numbers.astype(self.water.waves.real))
        jerks, sways = (((a * omega**power) ** 2).sum() for power in (5, 2))
        self.span = SPAN_ANGLE * float(sways / jerks) ** (1.0 / 6.0) if jerks else 1.0
        self.clock[None] = self.span

    def lay(self, centre: tuple[float, float], heading: tuple[float, float]) -> None:
        """Place the lattice around `centre` x, z [m], first axis along unit vector `heading`; sum the waves there."""
        sea, time = self.water.waves.sea, self.water.before
        self.start = time
        kx, kz = sea.wavevector.T
        (x, z), (dx, dz), angles = np.array(centre) - time * np.array(self.current), self.step, self.angles
        s, c = heading
        along, across = (kx * s + kz * c) * dx, (kx * c - kz * s) * dz
        middle = kx * x + kz * z + sea.phase - sea.omega * time
        angles[ANGLE_FIRST] = middle - 0.5 * ((self.size[0] - 1) * along + (self.size[1] - 1) * across)
        angles[ANGLE_LATER] = angles[ANGLE_FIRST] - sea.omega * self.span
        angles[ANGLE_ALONG], angles[ANGLE_ACROSS] = along, across
        self.add_up(np.cos(angles), np.sin(angles))

    @ti.kernel
    def add_up(self, cosine: Doubles2, sine: Doubles2):
        """Sum n waves at all nodes for both times, when the table is laid and `span` later. `cosine`, `sine` (4, n): of
        the angles at the first node at both times, and of the angles' steps along and across the lattice."""
        # Cosines and sines along the first axis, at both times, and across it: one rotation a node.
        for n in range(self.n):
            along = tm.vec2(cosine[ANGLE_ALONG, n], sine[ANGLE_ALONG, n])
            across = tm.vec2(cosine[ANGLE_ACROSS, n], sine[ANGLE_ACROSS, n])
            for t in ti.static(range(2)):
                node = tm.vec2(cosine[t, n], sine[t, n])
                for i in range(self.size[0]):
                    self.line[t, 0, i, n], self.line[t, 1, i, n] = node[0], node[1]
                    node = tm.cmul(node, along)
            node = tm.vec2(1.0, 0.0)
            for k in range(self.size[1]):
                self.row[0, k, n], self.row[1, k, n] = node[0], node[1]
                node = tm.cmul(node, across)
        # Sums over the waves at each node, by the addition theorem.
        for t, i, k in ti.ndrange(2, self.size[0], self.size[1]):
            with_cosine, with_sine = ti.Vector.zero(float, self.sums), ti.Vector.zero(float, self.sums)
            for n in range(self.n):
                c = self.line[t, 0, i, n] * self.row[0, k, n] - self.line[t, 1, i, n] * self.row[1, k, n]
                s = self.line[t, 0, i, n] * self.row[1, k, n] + self.line[t, 1, i, n] * self.row[0, k, n]
                for q in ti.static(range(self.sums)):
                    with_cosine[q] += self.gives[0, q, n] * c
                    with_sine[q] += self.gives[1, q, n] * s
            self.level[t, i, k], self.growth[t, i, k] = with_cosine[0], with_sine[0]
            for l in ti.static(range(len(self.depths))):
                x, y, z = 1 + 3 * l, 2 + 3 * l, 3 + 3 * l
                self.speed[t, i, k, l] = tm.vec3(with_cosine[x], with_sine[y], with_cosine[z])
                self.pull[t, i, k, l] = tm.vec3(with_sine[x], with_cosine[y], with_sine[z])

    @ti.func
    def elevation(self, i, k, late):
        """Elevation [m] at node i, k; `late`: share of the way from the first stored time to the second."""
        growth = self.growth[0, i, k], self.growth[1, i, k]
        return self.interpolate(self.level[0, i, k], self.level[1, i, k], growth[0], growth[1], late)

    @ti.func
    def moving(self, i, k, l, late):
        """Velocity [m/s], acceleration [m/s2] at node i, k, depth number l; `late`: share from first to second time."""
        first, last = self.speed[0, i, k, l], self.speed[1, i, k, l]
        pulled, pulls = self.pull[0, i, k, l], self.pull[1, i, k, l]
        mean = (last - first) / self.clock[None]
        a = (1.0 - late) * (1.0 - 3.0 * late) * pulled + late * (3.0 * late - 2.0) * pulls
        return self.interpolate(first, last, pulled, pulls, late), a + 6.0 * late * (1.0 - late) * mean

    @ti.func
    def interpolate(self, first, last, growth, grows, late):
        """Hermite cubic, a share `late` of the time from `first` to `last`; `growth`, `grows`: their rates [per s]."""
        way, back, span = late * late * (3.0 - 2.0 * late), 1.0 - late, self.clock[None]
        return (1.0 - way) * first + way * last + span * late * back * (back * growth - late * grows)
