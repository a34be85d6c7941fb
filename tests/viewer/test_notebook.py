"""`ocean_sim.view` as a notebook shows it: the page of a simulation that cells step, and a replay that holds all."""

import html
import re
import urllib.error
import urllib.request

import pytest

import ocean_sim
from ocean_sim.parts import PACKAGE
from tests.viewer import _chromium
from tests.viewer.test_page import in_a_browser, run  # noqa: F401

pytest.importorskip("aiohttp", reason="the page needs aiohttp: pip install '.[browser]'")
SEA = {
    "basin": {"length": 40.0, "width": 40.0, "depth": 10.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 0.5, "period": 3.0},
    "accuracy": None,
    "runtime": {"threads": 1},
}


def test_a_live_view_is_a_frame_with_the_page_of_a_server_until_it_is_closed():
    with ocean_sim.Simulation(ocean_sim.load(SEA)) as simulation:
        view = ocean_sim.view(simulation)
        (address,) = re.findall(r'<iframe src="([^"]+)"', view._repr_html_())
        with urllib.request.urlopen(address, timeout=10.0) as reply:
            assert b"<canvas" in reply.read()
            # a notebook at any address shows it in a frame; no other page knows the token
            assert "frame-ancestors" not in reply.headers["Content-Security-Policy"]
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(address.split("?")[0], timeout=10.0)
        simulation.step()
        view.close()
        with pytest.raises(OSError):
            urllib.request.urlopen(address, timeout=2.0)
        simulation.step()  # goes on with nobody watching


@pytest.mark.slow
@in_a_browser
def test_the_replay_in_a_notebook_draws_in_its_frame(run, tmp_path):  # noqa: F811
    shown = ocean_sim.view(run)._repr_html_()
    page = html.unescape(re.search(r'srcdoc="([^"]*)"', shown)[1])
    assert page.startswith("<!doctype html>") and "https://" not in page
    (tmp_path / "cell.html").write_text(f"<!doctype html><body>{shown}</body>")
    with _chromium.Page((500, 650)) as browser:
        browser.go((tmp_path / "cell.html").as_uri())
        browser.wait("document.querySelector('iframe').contentWindow.oceanSim.state.drawn > 1", 120.0)


@pytest.mark.slow
def test_a_notebook_with_a_view_is_executed(tmp_path):
    nbclient = pytest.importorskip("nbclient", reason="no Jupyter here; pip install nbclient ipykernel tries it")
    nbformat = pytest.importorskip("nbformat")
    cells = [
        f"import sys; sys.path.insert(0, {str(PACKAGE.parent)!r})\nimport ocean_sim",
        f"simulation = ocean_sim.Simulation(ocean_sim.load({SEA!r}))\nview = ocean_sim.view(simulation)\nview",
        "for _ in range(5):\n    simulation.step()\nprint(simulation.steps)\nview.close(); simulation.close()",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    _, shown, stepped = (cell["outputs"] for cell in notebook["cells"])
    assert any("<iframe" in output.get("data", {}).get("text/html", "") for output in shown)
    assert "5" in stepped[0]["text"]
