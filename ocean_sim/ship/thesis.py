"""The ship of the thesis as printed, errors and all, for comparison: column buoyancy and forward Euler.

Every piece of the hull's bottom carries a column of water as high as the water stands over it, at the nearest node of
the surface, deeper than the deck if need be. Its push acts on the vertical through the bottom, half as deep (5.3,
`addBuoyancy`), so of the metacentric height only BM - KG remains. Damping is 0.2 and 0.4 a second, as PhysX's linear
and angular damping; it hides the energy that forward Euler adds.
"""

from typing import Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Fluid
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import quantity
from ocean_sim.runtime import Template, in_kernels
from ocean_sim.ship import Load, Ship
from ocean_sim.ship.body.floating import FloatingConfig, FloatingShip, Immersion
from ocean_sim.ship.body.rigid_body import RigidBody, thesis_advance
from ocean_sim.ship.naval.hydrostatics import Hydrostatics

THESIS_NODES = 32  # along the basin, as `getWaveHeight` counts them


class Config(FloatingConfig):
    """Ship of the thesis: columns of water under the hull, and the thesis's damping and time step."""

    kind: Literal["thesis"] = "thesis"
    linear_damping: float = quantity("1/s", 0.2, ge=0.0)
    """Share of the velocity that is lost per second."""
    angular_damping: float = quantity("1/s", 0.4, ge=0.0)
    """Share of the angular velocity that is lost per second."""

    def build(self, name: str, basin: Basin, fluid: Fluid) -> Ship:
        return Thesis(name, self, basin, fluid)


class Thesis(FloatingShip):
    """Ship as in the master's thesis that the program redraws: columns of water carry her, forward Euler moves her."""

    def __init__(self, name: str, config: Config, basin: Basin, fluid: Fluid) -> None:
        super().__init__(name, config, basin, fluid)
        self.lost = np.array([config.linear_damping, config.angular_damping])  # [1/s]
        self.columns = Columns(self.hydrostatics, basin)

    def forces(self, now: Immersion) -> dict[str, np.ndarray]:
        """Force [N] and torque [N m], (2, 3), by cause: buoyancy by columns of water, and no wave force."""
        surface = now.surface if self.contact is None else self.water
        self.columns.sum_columns(surface, self.body.position, self.body.matrix)
        carried = self.columns.out.to_numpy().sum(axis=0).reshape(2, 3)
        return super().forces(now) | {"buoyancy": carried, "wave": np.zeros((2, 3))}

    def damping(self, now: Immersion) -> np.ndarray:
        body = self.body
        return -self.lost[:, None] * np.stack([body.mass * body.velocity, body.angular_momentum])

    def free_step(self, body: RigidBody, load: Load, dt: float) -> RigidBody:
        return thesis_advance(body, load.force, load.torque, dt)


@in_kernels
class Columns:
    """Squares of a hull's bottom, each of which carries the weight of the column of water above it (5.3)."""

    def __init__(self, still: Hydrostatics, basin: Basin) -> None:
        """Make one square of the bottom for each upright stack of the cubes of the hull with hydrostatics `still`."""
        cubes, size = still.voxels, still.voxels.size
        down = np.round(cubes.centre[:, [0, 2]] / size[[0, 2]] * 2.0).astype(int)
        _, column = np.unique(down, axis=0, return_inverse=True)
        column = column.ravel()
        n = int(column.max()) + 1
        bottom, volume = np.full(n, np.inf), np.zeros(n)
        np.minimum.at(bottom, column, cubes.centre[:, 1] - size[1] / 2)
        np.add.at(volume, column, cubes.share * size.prod())
        middle = np.zeros((n, 2))
        np.add.at(middle, column, cubes.centre[:, [0, 2]] * (cubes.share * size.prod())[:, None])
        middle /= volume[:, None]
        self.n, self.weight = n, still.density * still.gravity
        self.height = float(np.ptp(cubes.centre[:, 1]) + size[1])
        self.cell = (basin.config.length / THESIS_NODES, (basin.config.width or basin.config.length) / THESIS_NODES)
        self.bottom, self.area = ti.Vector.field(3, float, shape=n), ti.field(float, shape=n)
        self.out = ti.Vector.field(6, ti.f64, shape=n)
        real = self.area.to_numpy().dtype
        arms = np.stack([middle[:, 0], bottom, middle[:, 1]], axis=1) - still.matter.centre
        self.bottom.from_numpy(arms.astype(real))
        self.area.from_numpy((volume / self.height).astype(real))  # _segVolume / _shipSize.y

    @ti.kernel
    def sum_columns(self, surface: Template, position: tm.vec3, turn: tm.mat3):
        """Write (6,) force [N], torque [N m] of the water on each square of the bottom to the field `out`, by
        `elevation` of the `surface`; `position`: centre of mass [m]; `turn`: rotation from body to world axes."""
        for k in range(self.n):
            arm = turn @ self.bottom[k]
            x = position + arm
            # The thesis takes the nearest node of the cloth, which makes buoyancy jump.
            i, j = ti.round(x.x / self.cell[0]), ti.round(x.z / self.cell[1])
            depth = ti.max(surface.elevation(i * self.cell[0], j * self.cell[1]) - x.y, 0.0)
            force = tm.vec3(0.0, self.weight * self.area[k] * depth, 0.0)
            torque = (arm + tm.vec3(0.0, 0.5 * depth, 0.0)).cross(force)
            for c in ti.static(range(3)):
                self.out[k][c], self.out[k][3 + c] = ti.cast(force[c], ti.f64), ti.cast(torque[c], ti.f64)
