"""Whoever sees little or has no mouse: contrast of every word of the page as WCAG 2.1 defines it, and the keyboard."""

import json
import time
from pathlib import Path

import numpy as np
import pytest

from ocean_sim.files.csv_file import read_columns
from ocean_sim.viewer.protocol import packet
from ocean_sim.viewer.replay import Recorded, replay_file
from ocean_sim.viewer.server import Server
from ocean_sim.viewer.still import page_document, sky_packet
from tests.viewer import _chromium
from tests.viewer.test_page import in_a_browser, run  # noqa: F401

pytestmark = [pytest.mark.slow, in_a_browser]
pytest.importorskip("aiohttp", reason="the page needs aiohttp: pip install '.[browser]'")
TABS = ("play", "plots", "scene", "scenes", "keys")
AA, LARGE = 4.5, 3.0  # WCAG 2.1, 1.4.3: contrast of text, and of large text

CONTRAST = Path(__file__).with_name("_contrast.js").read_text(encoding="utf-8")


@pytest.fixture
def live(run):  # noqa: F811
    """A page that shows a barge, and a server that keeps what the page asks for."""
    barge = Recorded(run)
    still = barge.still()
    document = page_document("barge", {"mode": "live"})
    schema = {"properties": {"wind": {"enum": ["still", "wide"]}}, "$defs": {}}
    files = {
        "/": ("text/html; charset=utf-8", lambda: document),
        "/sky": ("application/octet-stream", sky_packet),
        "/schema": ("application/json", lambda: json.dumps(schema).encode()),
    }
    with Server(files, port=0, hello={"drives": True}) as server:
        server.begin(still)
        server.tell(None, **PANEL)
        yield server


PANEL = {
    "type": "panel",
    "paused": False,
    "speed": 1.0,
    "wind": "wide",
    "winds": ["wide", "still"],
    "sliders": [{"label": "wind strength", "value": 1.0, "low": 0.0, "high": 3.0}],
    "ships": [{"name": "ship", "throttle": 0.0, "rudder": 0.0, "route": []}],
    "message": "diverged: the water is faster than sound. Reset starts again.",
    "recording": "",
    "scene": "barge",
    "duration": 2.0,
}


def frame(k: int) -> bytes:
    x = np.linspace(-19.0, 19.0, 20)
    heights = (0.5 * np.sin(0.6 * x[:, None] - 0.1 * k) + 0.0 * x).astype(np.float16)
    poses = np.array([[0.0, 0.2, 0.0, 1.0, 0.0, 0.0, 0.0]], np.float32)
    arrays = {"height": heights.ravel(), "poses": poses, "scalars": np.zeros(1, np.float32)}
    return packet("frame", arrays, time=0.05 * k, seq=k, origin=[0.0, 0.0], fastest=1.0)


def opened(browser: _chromium.Page, server: Server) -> None:
    browser.go(server.address)
    browser.wait("oceanSim.state.worlds.length > 0", 120.0)
    for k in range(3):
        server.show(frame(k), 0.05 * k)
        time.sleep(0.05)
    browser.wait("window.oceanSim?.state.drawn > 0", 120.0)


def asked(server: Server, browser: _chromium.Page, do: str, seconds: float = 10.0) -> list:
    """The commands of one kind that have come in; waits for the first."""
    end, found = time.monotonic() + seconds, []
    while not found:
        found = [order.command for order in server.orders() if order.command.do == do]
        assert time.monotonic() < end, f"no {do}; the page said {browser.said[-3:]}"
        browser.js("1")
        time.sleep(0.02)
    return found


def test_every_word_has_the_contrast_of_wcag_aa_in_the_dark_and_in_the_light(live):
    with _chromium.Page((1000, 700)) as browser:
        opened(browser, live)
        told = {
            "scene": {"name": "barge", "text": "wind: wid\nduration: 3\n", "sets": ["wind.gain=2"]},
            "problems": {"problems": [{"line": 1, "column": 7, "key": "wind", "message": "there is no 'wid'"}]},
            "scenes": {"rows": [{"name": "barge", "sentence": "A barge on a running wave"}]},
            "keys": {
                "rows": [{"key": "seed", "value": 7, "unit": "1", "meaning": "Seed.", "range": ">= 0", "choices": []}]
            },
        }
        for theme in ("dark", "light"):
            browser.js(f"document.documentElement.dataset.theme = '{theme}'")
            worst, count = None, 0
            for tab in TABS:
                browser.js(f"document.getElementById('to-{tab}').click()")
                for kind, message in told.items():
                    live.tell(None, type=kind, **message)
                live.tell(None, type="said", text="building anew ...", bad=tab == "play")
                browser.wait(
                    "document.querySelector('#keys .key') && document.querySelector('.problems li').textContent"
                )
                browser.js("new Promise((done) => setTimeout(done, 400))")  # what fades in is there
                rows = browser.js(CONTRAST)
                count += len(rows)
                low = [row for row in rows if row["least"] < (LARGE if row["large"] else AA)]
                assert low == [], (theme, tab, low)
                worst = min([worst or rows[0], *rows], key=lambda row: row["least"])
            assert count > 100 and worst["least"] >= AA, worst
        browser.js("document.getElementById('help').showModal()")
        assert [row for row in browser.js(CONTRAST) if row["least"] < AA] == []


def test_the_keyboard_alone_suffices(live):
    """Every control is reached by Tab and shows that it is; what a mouse does, a key does."""
    with _chromium.Page((1000, 700)) as browser:
        opened(browser, live)
        wanted = set(
            browser.js(
                "[...document.querySelectorAll('button, select, input, textarea, canvas#sea')].filter((e) => "
                "e.getClientRects().length && !e.disabled && e.tabIndex >= 0).map((e) => e.id || e.textContent)"
            )
        )
        reached, unseen = set(), []
        browser.js("document.activeElement.blur()")
        for _ in range(len(wanted) + 8):
            browser.key("Tab")
            name, outline = browser.js(
                "(() => { const e = document.activeElement, s = getComputedStyle(e); "
                "return [e === document.body ? '' : e.id || e.textContent, "
                "s.outlineStyle !== 'none' && parseFloat(s.outlineWidth) >= 2]; })()"
            )
            reached.add(name)
            unseen += [] if outline or name == "" else [name]
        assert wanted - reached == set() and unseen == []
        browser.js("document.getElementById('sea').focus()")
        for key, do in ((" ", "pause"), ("n", "step"), ("r", "reset"), (".", "speed")):
            live.orders()
            browser.key(key)
            asked(live, browser, do)
        browser.key("ArrowUp", 2.5)  # longer than a picture takes without a graphics processor
        assert asked(live, browser, "steer")[-1].throttle > 0.0
        azimuth, shift = browser.js("[oceanSim.camera.azimuth, oceanSim.camera.shift.join()]")
        browser.key("d", 2.5)
        assert browser.js("oceanSim.camera.azimuth") != azimuth
        browser.key("c")
        assert browser.js("oceanSim.camera.shift.join()") == shift and browser.js("oceanSim.camera.azimuth") == azimuth
        browser.key("3")
        assert browser.js("oceanSim.camera.mode") == "helm"
        browser.key("1")
        # A route without a mouse: the button by Enter, then a waypoint under the cross.
        browser.js("document.getElementById('routeMode').focus()")
        browser.key("Enter")
        assert browser.js("oceanSim.state.picking && document.activeElement.id") == "sea"
        drawn = browser.js("oceanSim.state.drawn")
        live.show(frame(9), 0.45)
        browser.wait(f"oceanSim.state.drawn > {drawn}")
        browser.key("Enter")
        route = asked(live, browser, "route")[-1]
        assert len(route.points) == 1 and np.hypot(*route.points[0]) < 20.0 and route.speed == 3.0
        browser.js("document.getElementById('to-play').focus()")
        browser.key("ArrowRight")
        assert browser.js("document.activeElement.id") == "to-plots"
        live.tell(None, type="scene", name="barge", text="seed: 1\nwind: wid\n", sets=[])
        browser.key("ArrowRight")
        browser.wait("document.getElementById('yaml').value.includes('wid')")  # a text that comes clears its problems
        live.tell(None, type="problems", problems=[{"line": 2, "column": 1, "key": "wind", "message": "no such wind"}])
        browser.wait("document.querySelector('.problems li')?.textContent")
        browser.js("document.querySelector('.problems li').focus()")
        browser.key("Enter")
        assert browser.js("[document.activeElement.id, document.activeElement.selectionStart]") == ["yaml", 8]
        browser.js("document.getElementById('sea').focus()")
        browser.key("m")
        assert browser.js("document.body.classList.contains('folded')")
        browser.key("?")
        assert browser.js("document.getElementById('help').open")
        assert browser.said == []


def downloaded(browser, folder, pattern):
    """Wait for a file that the page hands over."""
    end = time.monotonic() + 30.0
    while not list(folder.glob(pattern)):
        assert time.monotonic() < end, [*folder.iterdir()]
        browser.js("1")
        time.sleep(0.1)


def test_what_is_kept_is_kept(run, live, tmp_path):  # noqa: F811
    """A still, the curves as CSV, a record and a saved scene; and two runs side by side have one clock."""
    with _chromium.Page((800, 600)) as browser:
        browser.ask("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
        opened(browser, live)
        browser.js("document.getElementById('still').click()")
        downloaded(browser, tmp_path, "a_barge_*.png")  # before the page is left
        size = browser.js("[document.getElementById('sea').width, document.getElementById('sea').height]")
        browser.js("document.getElementById('film').click()")  # nothing moves: the film is of the still picture
        browser.js("document.getElementById('film').click()")
        downloaded(browser, tmp_path, "a_barge_*.webm")
        assert browser.js("[document.getElementById('sea').width, document.getElementById('sea').height]") == size
        live.orders()
        browser.js("document.getElementById('record').click()")
        asked(live, browser, "record")
        browser.js("document.getElementById('saveName').value = 'mine'; document.getElementById('save').click()")
        assert asked(live, browser, "save")[0].name == "mine"
        browser.js("document.getElementById('saveName').value = '../mine'; document.getElementById('save').click()")
        browser.wait("document.getElementById('said').textContent.includes('letters, digits')")
        both = replay_file([run, run], tmp_path / "both.html")
        browser.go(both.as_uri())
        browser.wait("window.oceanSim?.state.drawn > 1 && oceanSim.state.worlds.length === 2", 120.0)
        browser.js("document.getElementById('scrub').value = 250; document.getElementById('scrub').oninput()")
        clocks = browser.js("oceanSim.state.worlds.map((w) => w.time)")
        assert (
            clocks == pytest.approx([0.5, 0.5]) and browser.js("document.querySelectorAll('#names span').length") == 2
        )
        browser.js("document.getElementById('csv').click()")
        downloaded(browser, tmp_path, "*.csv")
    assert next(tmp_path.glob("a_barge_*.png")).read_bytes()[:4] == b"\x89PNG"
    assert next(tmp_path.glob("a_barge_*.webm")).read_bytes()[:4] == b"\x1aE\xdf\xa3"
    first, second = (tmp_path / "curves.csv").read_text().split("\n\n")
    assert first.splitlines()[1] == "time_s,elevation_centre_m" and first == second.rstrip()
    (tmp_path / "one.csv").write_text(f"{first}\n")
    kept, logged = read_columns(tmp_path / "one.csv"), read_columns(run / "gauges.csv")
    assert kept["elevation_centre_m"] == pytest.approx(logged["centre_m"], abs=1e-6)
