"""The cases over shaped beds: references, and coarse runs that keep their promises."""

import pytest

from ocean_sim.validation import problems

QUICK = {"runtime.threads": 1}


def named(name: str):
    (found,) = [problem for problem in problems("shaped_bed", slow=True, coarse=True) if problem.name == name]
    return found


def test_every_set_up_but_that_of_a_wall_has_a_bed_with_a_shape_or_a_mesh():
    tanks = {problem.name: problem.load("delta_sph").preflight.tank for problem in problems("shaped_bed", slow=True)}
    assert [name for name, tank in tanks.items() if tank.ground is None and not tank.meshes] == ["vertical wall"]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["block", "ball", "momentum"])
def test_bodies_bear_what_they_displace_and_momentum_closes(name):
    rows, _ = named(name).run("shaped_bed", "delta_sph", QUICK)
    assert [row["quantity"] for row in rows if not row["ok"]] == []
