"""The figures of the surface run without a display, and their numbers are those of closed forms."""

import pytest

from ocean_sim.files.csv_file import read_columns
from tests.figures.test_drawn_figures import draw

FIGURES = ("fig3_3", "fig6_1", "fig6_2")


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    out = tmp_path_factory.mktemp("figures")
    draw(out, "yes", FIGURES)
    assert all((out / f"{name}.png").stat().st_size > 10_000 for name in FIGURES)
    return out


def test_figure_3_3_has_every_spring(figures):
    rows = (figures / "fig3_3.csv").read_text().splitlines()[2:]
    kinds = [row.split(",")[0] for row in rows]
    assert {kind: kinds.count(kind) for kind in kinds} == {"stretch": 31, "shear": 24, "bend": 22}


def test_figure_6_1_fits(figures):
    table = read_columns(figures / "fig6_1.csv")
    assert len(table["x_m"]) == 64
    assert abs(table["cloth_m"] - table["particles_m"]).max() < 0.25 * 2.5


def test_figure_6_2_cuts_the_same_triangles_as_flying_edges_and_closes(figures):
    lines = [line.split(",") for line in (figures / "fig6_2.csv").read_text().splitlines()[3:]]
    rows = {name: values for name, *values in lines}
    assert list(rows) == ["cloth", "marching_cubes", "flying_edges"]
    assert rows["marching_cubes"][0] == rows["flying_edges"][0]
    assert rows["marching_cubes"][3] == rows["flying_edges"][3] == "0"
    assert rows["cloth"][3] == "64"  # its rim: 16 springs a side
    assert all(abs(float(row[1])) < 0.05 for row in rows.values())
