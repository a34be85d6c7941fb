"""Every law of pairs names what it reads: a column of its row for each of its fields, its position first."""

from importlib.util import module_from_spec, spec_from_file_location

import numpy as np
import pytest

from ocean_sim.columns import Columns
from ocean_sim.fluid.sph.law import Law
from ocean_sim.parts import config_of, kinds, library
from ocean_sim.wind.stress import Config as Stress

SCHEMES = [kind for kind in kinds("fluid") if config_of("fluid", kind).compared]
BOX = {"length": 1.0, "depth": 0.5, "obstacles": [{"min": [-0.1, -0.5], "max": [0.1, -0.3]}]}
ENCLOSED = {"length": 1.0, "depth": 0.5, "walls": {"x": "periodic", "y": "periodic"}, "floor": "none"}


def laws(fluid) -> list:
    """All that a scheme holds which sums over rows of neighbours."""
    return [thing for thing in vars(fluid).values() if hasattr(thing, "reads") and hasattr(thing, "terms")]


@pytest.mark.parametrize("enclosed", [False, True])
@pytest.mark.parametrize("kind", SCHEMES)
def test_a_law_has_a_column_for_each_field_it_reads(water, kind, enclosed):
    """Both ways in which the rows and terms of a scheme may be put together: with a surface, bodies and wind, and
    without them, but viscous and with accounts."""
    basin = {"width": None, "gravity": [0.0, 0.0 if enclosed else -9.81, 0.0]} | (ENCLOSED if enclosed else BOX)
    wind, viscosity = None if enclosed else Stress(u10=5.0), 0.01 if enclosed else 0.0
    keys = {"kinematic_viscosity": viscosity, "reference_speed": 1.0}
    found = laws(water(kind, basin=basin, wind=wind, accounts=enclosed, **keys))
    graded = kind == "delta_sph" and not enclosed  # its diffusion, by the shear of the water
    assert len(found) == 2 + (not enclosed) + graded, "two laws of the scheme, and the exposed area under a wind"
    assert all(isinstance(law, Law) for law in found)
    for law in found:
        assert len(law.reads) == law.row.size, type(law).__name__
        assert law.row.position == 0, type(law).__name__


def test_columns_stand_one_after_the_other():
    row = Columns(position=3, velocity=3, pressure=1)
    assert (row.position, row.velocity, row.pressure, row.size) == (0, 3, 6, 7)
    with pytest.raises(AttributeError, match="no column 'volume' in this row; there are"):
        row.volume  # noqa: B018


def test_the_smallest_law_of_the_docs_counts_what_the_density_is_made_of(water):
    path = library("scenes").parent / "docs" / "examples" / "number_density.py"
    if not path.exists():
        pytest.skip("an installed package has no docs")
    spec = spec_from_file_location("number_density", path)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    fluid = water("mueller", basin=BOX | {"width": None, "obstacles": []}, spacing=0.1)
    law = module.NumberDensity(fluid)
    law.find()
    np.testing.assert_allclose(
        fluid.particles.mass * law.found.to_numpy(), fluid.particles.density.to_numpy(), rtol=1e-12
    )
