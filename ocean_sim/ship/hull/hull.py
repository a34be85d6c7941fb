"""A hull in a scene: shape, mass, centre of mass and inertia; and its cubes."""

from math import isinf
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, ValidationError

from ocean_sim.basin.solids.voxels import MAX_FLATNESS, voxels
from ocean_sim.conventions import AxisName
from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.parts import named, preset
from ocean_sim.ship.hull.shapes import MeshFile, Shape
from ocean_sim.ship.naval.hydrostatics import Hydrostatics, Matter

FLAT_CUBES_LIMIT = 8.0  # cubes over a draught, up to which they may be flat; more are for curves of stability
CUBES_ACROSS = 8.0  # across a hull that is narrower than its draught, at least
FIRST_GUESS_CUBES = 16  # cubes over the height of a hull whose draught is not known yet
CUBE_BUDGET = 4e5  # cubes of a hull: one that draws little of its height has fewer over its draught than asked for
MESH_ENDINGS = (".stl", ".obj", ".ply")


def check_inertia(inertia: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return principal moments of inertia [kg m2] unchanged; raises ValueError if no body can have them."""
    if not min(inertia) > 0.0:
        raise ValueError(f"each moment of inertia must be above 0, got {list(inertia)}")
    if 2.0 * max(inertia) > (1.0 + 1e-9) * sum(inertia):
        raise ValueError(f"no body has {list(inertia)}: each moment of inertia is at most the sum of the other two")
    return inertia


Inertia = Annotated[Vector3, AfterValidator(check_inertia)]


class Hull(Model):
    """A hull; positions are from its origin amidships at the keel: x to port, y up, z to the bow."""

    shape: Shape
    """A box, a cylinder, a ball, Wigley's hull, the hull of points, or a mesh."""
    mass: float | None = quantity("kg", None, gt=0.0)
    """Mass of the whole ship."""
    centre_of_mass: Vector3 | None = quantity("m", None)
    """Null: the centroid of the hull, as if its density were uniform."""
    inertia: Inertia | None = quantity("kg m2", None)
    """Moments of inertia of pitch, yaw and roll (about x, y, z) about the centre of mass; null: those of uniform
    density."""

    def in_still_water(self, cells: float, density: float, gravity: float) -> Hydrostatics:
        """Hydrostatics at a density [kg/m3], gravity [m/s2] by cubes, `cells` over the draught; raises ValueError."""
        lower, upper = self.shape.bounds()
        breadth, height, length = (upper - lower).tolist()
        least, flat = self.smallest_side, MAX_FLATNESS if cells <= FLAT_CUBES_LIMIT else 1.0
        mesh = self.shape.closed_mesh()
        draught = min(self.in_cubes(height / FIRST_GUESS_CUBES, density, gravity).draught, height)
        if draught > min(breadth, length):  # slender and upright
            cells = max(cells, draught / min(breadth, length) * CUBES_ACROSS)
        if mesh is not None and mesh.mean_thickness < draught / cells:
            return self.in_cubes(least, density, gravity, 1.0)
        fine = self.in_cubes(max(draught / cells, least), density, gravity, flat)
        if isinf(fine.draught) or abs(fine.draught / draught - 1.0) < 0.02:
            return fine
        return self.in_cubes(max(fine.draught / cells, least), density, gravity, flat)

    @property
    def smallest_side(self) -> float:
        """Smallest side [m] allowed for cubes: CUBE_BUDGET of them fill the box around the hull."""
        lower, upper = self.shape.bounds()
        return float((upper - lower).prod() / CUBE_BUDGET) ** (1.0 / 3.0)

    def in_cubes(self, side: float, density: float, gravity: float, flat: float = MAX_FLATNESS) -> Hydrostatics:
        """Hydrostatics by cubes `side` [m] high and up to `flat` times as long; raises ValueError without a mass."""
        cubes = voxels(self.shape, side, flat)
        if self.mass is None:
            raise ValueError("has no mass; give mass [kg]")
        centre = cubes.centroid if self.centre_of_mass is None else np.array(self.centre_of_mass)
        own = cubes.inertia(self.mass, centre) if self.inertia is None else np.diag(self.inertia)
        return Hydrostatics(cubes, Matter(self.mass, centre, own), density, gravity, shape=self.shape)


def hull_of(name: str, up: AxisName | None = None, bow: AxisName | None = None, scale: float | None = None) -> Hull:
    """Hull of `name`: one of configs/hull/, or a mesh file, read with these axes and scale; raises ValueError."""
    if name in named("hull"):
        return Hull.model_validate(preset("hull", name))
    if Path(name).suffix.lower() in MESH_ENDINGS:
        return Hull(shape=MeshFile(kind="mesh", file=name, up=up, bow=bow, scale=scale))
    begin = f"there is no hull {name!r}, and it is not a {', '.join(MESH_ENDINGS)} file;"
    raise ValueError(f"{begin} there are {', '.join(named('hull'))}")


def error_sentence(error: ValidationError | ValueError) -> str:
    """Message of an error as one sentence, without Pydantic's layout and links."""
    if isinstance(error, ValidationError):
        return "; ".join(f"{'.'.join(map(str, e['loc']))}: {e['msg']}" for e in error.errors(include_url=False))
    return str(error)
