import re
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest

from ocean_sim.observers import accuracy, gauges, report
from ocean_sim.observers._plot import curves, ticks


def test_a_page_tells_what_was_run_and_how_it_ended(tmp_path, watched):
    simulation = watched()
    simulation.scene.title = "Wind <& water>"
    simulation.scene.platform = None
    simulation.scene.wind = SimpleNamespace(kind="gusts")
    simulation.observers = [
        gauges.Config(elevation={"centre": [0.0, 0.0]}).build(tmp_path, simulation),
        accuracy.Config().build(tmp_path, simulation),
        report.Config().build(tmp_path, simulation),
    ]
    simulation.run(until=0.3)
    page = (tmp_path / "report.html").read_text()
    assert "<h1>Wind &lt;&amp; water&gt;</h1>" in page and "done at t = 0.300 s after 30 steps" in page
    assert 'src="preview.png"' in page and "gusts" in page and "computed" in page
    assert "http" not in re.sub("<[^>]*xmlns[^>]*>", "", page)  # nothing comes from a network
    drawings = re.findall("<svg.*?</svg>", page, re.DOTALL)
    assert len(drawings) == 5
    for drawing in drawings:
        ElementTree.fromstring(drawing)


def test_a_run_without_logs_has_a_page_too(tmp_path, watched):
    simulation = watched()
    simulation.scene.platform = None
    simulation.outcome, simulation.reason = "stopped", "density reached 3e3 kg/m^3"
    report.Config().build(tmp_path, simulation).close()
    page = (tmp_path / "report.html").read_text()
    assert "density reached 3e3" in page and "<svg" not in page


@pytest.mark.parametrize("low, high", [(0.0, 1.0), (-3.0, 17.0), (1e-9, 3e-9), (-2e6, 5e6)])
def test_ticks_are_round_and_enough(low, high):
    marks = ticks(low, high)
    assert 3 <= len(marks) <= 9 and marks[0] >= low - 1e-9 * (high - low) and marks[-1] <= high + 1e-9 * (high - low)
    step = marks[1] - marks[0]
    assert float(f"{step / 10.0 ** np.floor(np.log10(step * 1.0000001)):.6f}") in (1.0, 2.0, 5.0)


def test_curves_survive_flat_lines_gaps_and_a_single_row():
    time = np.linspace(0.0, 1.0, 5)
    for values in (np.zeros(5), np.array([0.0, np.nan, 1.0, np.inf, 2.0]), np.full(5, np.nan)):
        assert "nan" not in curves(time, {"a": values}, "a")
    assert "nan" not in curves(np.zeros(1), {"a": np.ones(1)}, "a")
