"""The page in a real browser without a screen: it loads, the water moves, what is pressed arrives, a replay scrubs."""

import html
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ocean_sim.parts import PACKAGE
from ocean_sim.verbs.serve import live_files, scene_rows
from ocean_sim.viewer.replay import MAX_DROP_BYTES, Recorded, replay_file
from ocean_sim.viewer.still import page_document
from tests.viewer import _chromium
from tests.viewer.page_packets import unpack

pytest.importorskip("aiohttp", reason="the page needs aiohttp: pip install '.[browser]'")
in_a_browser = pytest.mark.skipif(
    _chromium.installed() is None,
    reason="no Chromium on this machine; as root, apt-get install chromium tries the page",
)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run folder with a yacht on a running wave, as `run` leaves one: frames, manifest and a table."""
    folder = tmp_path_factory.mktemp("run")
    (folder / "frames").mkdir()
    x = np.linspace(-19.0, 19.0, 20)
    box = np.array([[a, b, c] for a in (-2.0, 2.0) for b in (-1.0, 1.0) for c in (-6.0, 6.0)])
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = [[a, *pair] for a, b, c, d in sides for pair in ((b, c), (c, d))]
    np.savez(
        folder / "frames" / "grid.npz",
        **dict(x=x, z=x, lower=[-20.0, -5.0, -20.0], upper=[20.0, 5.0, 20.0], depth=5.0, spacing=2.0, every=0.05),
        **dict(obstacles=np.zeros((0, 2, 3)), has_surface=True),
        **dict(
            ship_vertices=box,
            ship_triangles=faces,
            ship_look="barge",
            ship_helm=np.zeros(0),
            ship_still_water=np.eye(4)[1],
        ),
    )
    places = np.random.default_rng(4).uniform([-20.0, -5.0, -20.0], [20.0, 0.0, 20.0], (400, 3))
    for k in range(41):
        time = 0.05 * k
        wave = 0.5 * np.sin(0.6 * x[:, None] - 2.4 * time) + 0.0 * x
        wave = np.where(
            (np.abs(x[:, None]) < 2.5) & (np.abs(x - time) < 6.5), -1.5, wave
        )  # as particles follow her bottom
        moved = places + [0.0, 0.1 * np.sin(2.4 * time), 0.0]
        np.savez(
            folder / "frames" / f"frame_{k:05d}.npz",
            **dict(time=time, elevation=wave.astype(np.float32), ship_position=[0.0, 0.2, time], ship_turn=np.eye(3)),
            **dict(drops=np.random.default_rng(k).uniform(0.0, 9.0, (20 if k < 40 else 2000, 9))),
            **dict(position=moved.astype(np.float32), velocity=0.1 * places.astype(np.float32), id=np.arange(400)),
        )
    scene = {"title": "A barge on a running wave", "gauges": {"elevation": {"centre": [0.0, 0.0]}}}
    (folder / "manifest.json").write_text(json.dumps({"scene": scene}))
    rows = "\n".join(f"{0.05 * k:.3f},{0.5 * np.sin(-0.12 * k):.6f}" for k in range(41))
    (folder / "gauges.csv").write_text(f"# seed: 1\ntime_s,centre_m\n{rows}\n")
    return folder


def test_scenes_of_the_gallery_are_listed_with_their_pictures():
    rows, files = {row["name"]: row for row in scene_rows()}, live_files("")
    assert rows["showcase"]["picture"] == "showcase.jpg" and rows["thesis/long_hour"]["picture"] == ""
    kind, content = files["/" + rows["gallery/two_ships"]["picture"]]
    assert kind == "image/jpeg" and content()[:3] == b"\xff\xd8\xff"


def test_the_page_is_small_and_calls_nobody():
    document = page_document("<a> title", {"mode": "live"}).decode()
    assert len(document) < 200_000 and "&lt;a&gt; title" in document
    assert "/*program*/" not in document and "<!--data-->" not in document
    for word in ("http://", "https://", "src=", "@import"):
        assert word not in document.replace("http://www.w3.org/2000/svg", ""), word


PLACES = "a /*program*/ /*start*/ <!--data--> {0} {{x}} \\g<0> %s </title></script><script>b()</script>\n\u2028"


def test_words_that_stand_for_places_of_the_page_are_only_words():
    """In the title, and in the names of runs: the rest of the document is as with any other."""
    plain = page_document("title", {"mode": "live"}, {"sky": b"0"}).decode()
    assert (
        page_document(PLACES, {"mode": "live"}, {"sky": b"0"}).decode().replace(html.escape(PLACES), "title") == plain
    )
    start = {"mode": "replay", "runs": [{"title": PLACES, "name": PLACES}]}
    document = page_document(PLACES, start).decode()
    assert (
        document.count("<script") == document.count("</script") == page_document("title", {}).decode().count("</script")
    )
    (given,) = re.findall(r"const START = (\{.*\});\n", document)
    assert json.loads(given) == start


def test_a_replay_has_a_title_whatever_its_folder_is_called(run, tmp_path):
    """Also one whose bytes are no UTF-8, as archives of old systems leave them."""
    folder = Path(os.fsdecode(bytes(tmp_path) + b"/run \xff <b>"))
    shutil.copytree(run, folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["scene"].pop("title")
    (folder / "manifest.json").write_text(json.dumps(manifest))
    document = replay_file([folder], tmp_path / "replay.html").read_text(encoding="utf-8")
    assert "<title>run ? &lt;b&gt;</title>" in document


def test_a_replay_keeps_of_many_drops_every_second_or_third(run):
    """All of few; places to a centimetre, with velocities."""
    found = unpack(Recorded(run).stream())[1]["drops"].astype(float)
    assert found.nbytes / 4 <= MAX_DROP_BYTES
    few, many = (np.load(run / "frames" / f"frame_{k:05d}.npz")["drops"][:, :6] for k in (3, 40))
    np.testing.assert_allclose(found[3, :20], few, atol=0.005)
    assert np.isnan(found[3, 20:]).all()
    np.testing.assert_allclose(found[40, : len(many[::3])], many[::3], atol=0.005)


@pytest.mark.anchor
@in_a_browser
def test_a_replay_opens_from_a_file_and_scrubs(run, tmp_path):
    path = replay_file([run], tmp_path / "replay.html")
    with _chromium.Page((480, 360)) as browser:
        browser.go(path.as_uri())
        browser.wait("window.oceanSim?.state.drawn > 1", 120.0)
        assert browser.js("document.getElementById('title').textContent") == "A barge on a running wave"
        browser.js("document.getElementById('scrub').value = 500; document.getElementById('scrub').oninput()")
        assert browser.js("oceanSim.state.paused") and browser.js("oceanSim.state.time") == pytest.approx(1.0, abs=1e-6)
        heights = np.array(browser.js("[...oceanSim.state.worlds[0].heights]")).reshape(20, 20)
        with np.load(run / "frames" / "frame_00020.npz") as frame:
            wave, along = frame["elevation"], np.linspace(-19.0, 19.0, 20)
        off = (np.abs(along[:, None]) > 4.0) | (np.abs(along - 1.0) > 8.0)
        assert np.abs(heights - wave)[off].max() < 2e-3
        assert wave.min() == -1.5 and heights.min() > -0.6  # under her the water around goes on
        assert browser.js("oceanSim.state.worlds[0].poses[0].position[2]") == pytest.approx(1.0, abs=1e-5)
        balls = browser.js("oceanSim.state.worlds[0].balls.count")
        assert balls == 400 and browser.js("oceanSim.state.worlds[0].spray.count") == 20
        before = browser.picture()
        drawn = browser.js("oceanSim.state.drawn")
        browser.js("document.getElementById('scrub').value = 900; document.getElementById('scrub').oninput()")
        browser.wait(f"oceanSim.state.drawn > {drawn}")
        assert browser.picture() != before
        # A heading that passes south goes on, and is told with its side.
        turned = browser.js(
            "(() => { const { plots } = oceanSim, yaw = { group: 'yaw', label: 'heading', unit: 'deg', name: 'yaw' }; "
            "document.getElementById('fold').click(); plots.begin([{ scalars: [yaw], name: '' }]); "
            "plots.add(0, 0, [170]); plots.add(0, 1, [-170]); plots.draw(0); "
            "return [plots.sets[0].rows[1][0], document.querySelector('#plots .legend').textContent]; })()"
        )
        assert turned[0] == 190.0 and turned[1].split() == ["heading", "170°", "starboard"]
        # Water of particles at rest is a line in the middle of its plot, in millimetres; a wave fills it.
        words = browser.js(
            "[3e-5, 0.2].map((high) => { const { plots } = oceanSim, group = 'elevation', rows = new Set(); "
            "plots.begin([{ scalars: [{ group, label: 'middle', unit: 'm' }], name: '', spacing: 0.05 }]); "
            "for (let k = 0; k < 9; k++) plots.add(0, k, [high * (k % 2) - 3.6e-5]); plots.draw(0); "
            "const { data } = plots.cards[0].canvas.getContext('2d').getImageData(60, 0, 180, 90); "  # the blue curve
            "data.forEach((v, k) => { if (k % 4 === 2 && v > 150 && data[k - 2] < 110) rows.add(k / 720 | 0); }); "
            "return [document.querySelector('#plots .legend').textContent, Math.max(...rows) - Math.min(...rows)]; })"
        )
        assert words[0][0].split() == ["middle", "0.000", "m"] and words[0][1] < 5 < 60 < words[1][1]
        # Of a live page, the last minute: at most so many moments, and so many bytes.
        kept = browser.js(
            "(() => { const kept = new oceanSim.History(); "
            "for (let k = 0; k < 3000; k++) kept.add(0.05 * k, new ArrayBuffer(4e5)); "
            "return [kept.times.length, kept.times[0], kept.end, kept.bytes, kept.before(120)]; })()"
        )
        assert 100 < kept[0] <= 600 and 85.0 < kept[1] < 95.0 and kept[2] > 148.0 and kept[3] <= 96e6
        assert 0 < kept[4] < kept[0]
        assert browser.said == []


@pytest.mark.slow
@in_a_browser
def test_two_runs_have_one_clock_and_the_longer_one_goes_on(run, tmp_path):
    shorter = shutil.copytree(run, tmp_path / "shorter")
    for k in range(21, 41):
        (shorter / "frames" / f"frame_{k:05d}.npz").unlink()
    path = replay_file([shorter, run], tmp_path / "replay.html")
    with _chromium.Page((480, 360)) as browser:
        browser.go(path.as_uri())
        browser.wait("window.oceanSim?.state.drawn > 1", 120.0)
        assert browser.js("document.getElementById('names').innerText").split() == ["shorter", run.name]
        browser.js("document.getElementById('scrub').value = 400; document.getElementById('scrub').oninput()")
        assert browser.js("oceanSim.state.worlds.map(world => world.time)") == pytest.approx([0.8, 0.8], abs=1e-3)
        browser.js("document.getElementById('go').click()")
        browser.wait("oceanSim.state.paused", 120.0)
        assert browser.js("oceanSim.state.time") == pytest.approx(2.0, abs=1e-6)
        assert browser.js("oceanSim.state.worlds.map(world => world.time)") == pytest.approx([1.0, 2.0], abs=1e-3)
        assert browser.said == []


HEADSET = """
(() => {
  const one = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const projectionMatrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 0, 0, -0.2, 0];
  const moment = { getViewerPose: () => ({ views: [{ transform: { matrix: one }, projectionMatrix }] }) };
  const session = {
    inputSources: [], addEventListener() {}, updateRenderState() {}, requestReferenceSpace: async () => ({}),
    requestAnimationFrame(draw) { setTimeout(() => draw(performance.now(), moment), 30); },
  };
  const value = { isSessionSupported: async () => true, requestSession: async () => session };
  Object.defineProperty(navigator, "xr", { value });
  WebGL2RenderingContext.prototype.makeXRCompatible = async () => {};
  window.XRWebGLLayer = class { framebuffer = null; getViewport() { return { x: 0, y: 0, width: 200, height: 150 }; } };
})();
"""


@in_a_browser
@pytest.mark.slow
def test_in_virtual_reality_one_stands_at_the_helm_and_a_platform_moves_the_sea_once(run, tmp_path):
    """With an emulator of a headset that looks straight ahead."""
    path = replay_file([run], tmp_path / "replay.html")
    with _chromium.Page((320, 240)) as browser:
        browser.ask("Page.addScriptToEvaluateOnNewDocument", source=HEADSET)
        browser.go(path.as_uri())
        browser.wait("window.oceanSim?.state.drawn > 0 && !document.getElementById('vr').hidden", 120.0)
        browser.js("document.getElementById('vr').onclick()")
        browser.wait("oceanSim.XR.drawn > 0")
        # Both of one moment: the replay goes on.
        seen, at = browser.js("[[...oceanSim.XR.eye], [...oceanSim.state.worlds[0].poses[0].position]]")
        eye = np.array(seen).reshape(4, 4).T
        helm = np.array(browser.js("oceanSim.state.worlds[0].still.ships[0].helm"))
        assert eye[:3, 3] == pytest.approx(np.array(at) + helm, abs=1e-4)
        assert eye[:3, :3] @ [0.0, 0.0, -1.0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)  # ahead is the bow
        # A head that only the platform moves sees what a head at rest sees.
        browser.js("window.carried = oceanSim.XR.platform([0.1, -0.2, 0.05, 0.2, -0.1, 0.3])")
        browser.js("window.pose = oceanSim.state.worlds[0].ships[0].pose")
        moved, still = (
            np.array(browser.js(f"oceanSim.M.mul(oceanSim.XR.space(pose, [0, 2, 1], {carried}), {head})"))
            for carried, head in (("carried", "carried"), ("null", "oceanSim.M.one()"))
        )
        assert moved == pytest.approx(still, abs=1e-6)
        # Rolled to starboard, as positive roll of X forward, Y left, Z up is: the right hand goes down.
        rolled = np.array(browser.js("oceanSim.XR.platform([0, 0, 0, 0.3, 0, 0])")).reshape(4, 4).T
        assert rolled[1, 0] == pytest.approx(-np.sin(0.3))


# Mean place across the picture, -1 to 1, of the yellow mark of the wheel in the wheelhouse, from the middle of what no
# panel hides; 0 where there is none.
WHEEL_MARK = """(() => {
  oceanSim.state.scale = 1;  // all pixels, however slow the machine is
  const { gl } = oceanSim.painter, w = gl.drawingBufferWidth, h = gl.drawingBufferHeight;
  const seen = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, seen);
  let sum = 0, count = 0;
  for (let k = 0; k < w * h; k++) {
    const [r, g, b] = seen.subarray(4 * k, 4 * k + 3);
    if (r > 150 && g > 0.85 * r && b < 0.5 * g) { sum += (2 * (k % w)) / w - 1; count++; }
  }
  return count > 3 ? sum / count : 0;
})()"""


@pytest.mark.slow
@in_a_browser
def test_a_scene_is_played_in_the_page(tmp_path):
    """Of a coarse showcase: the first picture, moving water, a slider, the helm, an error at its line, another wind."""
    command = [sys.executable, "-m", "ocean_sim", "serve", "showcase", "--no-open", "--json", "--port", "8899"]
    command += ["--set", "fluid.spacing=2.5", "--out", str(tmp_path)]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=PACKAGE.parent)
    try:
        lines = [server.stdout.readline() for _ in range(3)]
        address = json.loads("".join(lines))["address"]
        with _chromium.Page((640, 480)) as browser:
            browser.go(address)
            browser.wait("window.oceanSim?.state.drawn > 1", 240.0)
            now = "[...oceanSim.state.worlds[0].heights].map(h => h.toFixed(4)).join()"
            still = browser.js(now)
            browser.wait(f"{now} !== {json.dumps(still)}")
            slide = "document.querySelector('#sliders input[aria-label^=\"wind strength\"]')"
            browser.wait(f"{slide} !== null")
            browser.js(f"{slide}.value = 1000; {slide}.oninput()")
            browser.wait("oceanSim.state.panel.sliders[0].value === 3")
            heading = "oceanSim.state.worlds[0].poses[0].turn[2]"
            browser.js("document.getElementById('throttle').value = 1; document.getElementById('throttle').oninput()")
            browser.js("document.getElementById('sea').focus()")
            browser.key("ArrowLeft", 1.5)
            assert browser.js("oceanSim.state.rudder") > 0.02  # to port; how far depends on how fast pictures are drawn
            browser.js("document.querySelector('#cameras [data-name=helm]').click()")
            browser.js("document.getElementById('rudder').value = -8; document.getElementById('rudder').oninput()")
            assert browser.js("document.getElementById('wheelTurn').getAttribute('transform')").startswith("rotate(-")
            browser.wait(f"{WHEEL_MARK} < -0.02", 60.0)  # how far depends on what the bars leave
            browser.js("document.querySelector('#cameras [data-name=orbit]').click()")
            browser.wait("oceanSim.state.panel.ships[0].name === 'ship' && oceanSim.state.time > 0.5", 120.0)
            before = browser.js(heading)
            browser.wait(f"Math.abs({heading} - {before}) > 2e-4", 120.0)
            sea = "document.querySelector('#readings').innerText"
            assert "kn" in browser.js(sea) and "port of north" in browser.js(sea).replace("\n", " ")
            pace = "document.getElementById('pace').textContent"
            browser.wait(f"/^(keeps up|[0-9.]+ × real time)$/.test({pace})", 60.0)
            upright = "letter => { const m = letter.getScreenCTM(); return m.a > 0 && Math.abs(m.b) < 1e-3 * m.a; }"
            for camera in ("top", "follow"):
                browser.js(f"document.querySelector('#cameras [data-name={camera}]').click()")
                browser.wait(f"[...document.querySelectorAll('#rose text')].every({upright})")
            browser.js("document.getElementById('scrub').value = 300; document.getElementById('scrub').oninput()")
            past = browser.js("[oceanSim.state.back, oceanSim.state.time, oceanSim.state.worlds[0].time]")
            assert past[0] and past[1] == pytest.approx(past[2], abs=1e-6)
            words = "['clock', 'link', 'ago'].map(id => document.getElementById(id).textContent)"
            browser.wait(f"{words}[1] === 'looking back'")
            clock, _, ago = browser.js(words)
            assert clock == f"t = {past[1]:.2f} s" and re.fullmatch(r"[0-9.]+ s ago", ago)
            browser.js("document.getElementById('toLive').click()")
            browser.wait(f"!oceanSim.state.back && oceanSim.state.time > {past[1]}", 30.0)
            browser.js("document.getElementById('to-scene').click()")
            browser.wait("document.getElementById('yaml').value.length > 50")
            browser.js(
                "(() => { const box = document.getElementById('yaml'); box.value = box.value.replace('wind: wide', "
                "'wind: wid'); box.dispatchEvent(new Event('input')); })()"
            )
            problem = browser.wait("document.querySelector('.problems li')?.textContent")
            assert problem.startswith("line 7 wind") and "did you mean 'wide'" in problem
            assert browser.js("document.querySelector('.lines .bad').textContent") == "7"
            browser.js("document.getElementById('to-play').click()")
            browser.key(" ")
            browser.wait("oceanSim.state.paused && oceanSim.state.panel.paused")
            ends = "[oceanSim.live.history.times[0], oceanSim.plots.sets[0].times[0], oceanSim.live.history.end]"
            first, plotted, last = browser.js(ends)
            browser.js("location.reload()")  # a page that opens late has the curves and the minute of one before it
            browser.wait(f"oceanSim.state.drawn > 1 && {ends}[0] < {last} - 0.5", 60.0)
            assert browser.js(ends) == pytest.approx([first, plotted, last], abs=0.3)
            assert browser.said == []
    finally:
        server.terminate()
        server.wait(30.0)
