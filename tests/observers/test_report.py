import json
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest

from ocean_sim.observers import accuracy, gauges, manifest, report, timings
from ocean_sim.observers.shared.page import (
    CURVE_COLOURS,
    MAX_POINTS,
    PAGE_FILE,
    draw_curves,
    keep_crests,
    round_ticks,
    scene_text,
)
from ocean_sim.pictures.stage.picture import Moments

VOID = {"meta", "img", "br", "hr", "link"}


class Nested(HTMLParser):
    """Fails where an element is not closed in its turn."""

    def __init__(self, page):
        super().__init__(convert_charrefs=True)
        self.open, self.seen, self.sources, self.words = [], [], [], []
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.seen.append(tag)
        self.sources += [value for name, value in attributes if name in ("src", "href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.seen.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


def checked(folder):
    """The page of a folder as a parser reads it: well nested, from no network, without scripts."""
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>") and "http" not in re.sub("<[^>]*xmlns[^>]*>", "", page)
    parsed = Nested(page)
    assert "script" not in parsed.seen and "link" not in parsed.seen
    assert all(s.startswith(("data:image/", "#part")) or (folder / s).exists() for s in parsed.sources)
    for drawing in re.findall("<svg.*?</svg>", page, re.DOTALL):
        ElementTree.fromstring(drawing)
    return page, parsed


@pytest.fixture
def ran(tmp_path, watched):
    def build(observers=(), **scene):
        simulation = watched()
        simulation.scene.platform = None
        resolved = {"title": "Wind <& water>", "basin": {"length": 4.0, "width": 4.0, "depth": 1.0}} | scene
        simulation.scene.resolved = lambda: resolved
        simulation.scene.warnings = lambda: ["the time step is <small>"]
        simulation.observers = [manifest.Config().build(tmp_path, simulation)]
        simulation.observers += [config.build(tmp_path, simulation) for config in observers]
        simulation.observers.append(report.Config().build(tmp_path, simulation))
        return simulation

    return build


def test_a_page_tells_what_was_run_and_how_it_ended(tmp_path, ran):
    watching = (gauges.Config(elevation={"centre": [0.0, 0.0]}), accuracy.Config(), timings.Config(every=0.1))
    ran(watching, wind={"kind": "gusts"}, fluid={"kind": "computed"}).run(until=0.3)
    page, parsed = checked(tmp_path)
    assert "<h1>Wind &lt;&amp; water&gt;</h1>" in page and "done at t = 0.300 s after 30 steps" in page
    assert "gusts" in page and "computed" in page and "the time step is &lt;small&gt;" in page
    assert "numpy" in page and "length: 4.0" in page and 'name="viewport"' in page and "@media print" in page
    assert page.count('<figure class="plot">') == 7 and "milliseconds a step" in page
    assert [f for f in ("gauges.csv", "accuracy.csv", "timings.csv") if f not in parsed.sources] == []


def test_a_page_names_every_train_of_waves_and_no_force_that_never_acts(tmp_path, ran):
    swell = {"height": 0.5, "period": 9.0, "heading_deg": 90.0}
    spectrum = {"kind": "pierson_moskowitz", "significant_wave_height": 1.2, "peak_period": 5.07, "heading_deg": 0.0}
    sea = {"kind": "spectral_sea", "spectrum": spectrum, "spectra": [swell], "components": "swell.csv"}
    ran((accuracy.Config(),), fluid=sea).run(until=0.2)
    page, _ = checked(tmp_path)
    assert "<td>pierson moskowitz, significant height 1.2 m, peak period 5.07 s, heading 0 deg</td>" in page
    assert "<td>regular, 0.5 m high, period 9 s, heading 90 deg</td>" in page and "plane waves of swell.csv" in page
    assert re.findall('aria-label="horizontal impulse by force .kN s., (.*?)"', page) == ["wind"]


def test_a_page_tells_the_gain_of_a_wind(tmp_path, ran):
    ran(wind={"kind": "stress", "gain": 300.0}, fluid={"kind": "computed"}).run(until=0.02)
    page, _ = checked(tmp_path)
    assert "stress, 300 times a real wind (gain)" in page


def test_a_run_that_diverged_has_a_page_that_says_so(tmp_path, ran):
    simulation = ran()
    simulation.outcome, simulation.reason = "diverged", "density reached 3e3 kg/m^3"
    for observer in simulation.observers:
        observer.close()
    page, _ = checked(tmp_path)
    assert 'class="outcome bad"' in page and "density reached 3e3" in page and '<figure class="plot">' not in page


def test_a_run_that_was_killed_has_a_page_of_what_it_left(tmp_path, ran):
    simulation = ran((accuracy.Config(every=0.01),))
    simulation.observers, kept = simulation.observers[:-1], simulation.observers
    for _ in range(5):
        simulation.step()
        kept[1].observe(simulation)
    whole = '{"time_s": 0.0, "step": 0, "event": "start", "sound_speed_m_s": 12.5}\n'
    (tmp_path / "events.jsonl").write_text(whole + '{"time_s": 0.1, "ste')  # torn
    (tmp_path / "gauges.csv").write_text("")
    (tmp_path / "preview.png").write_bytes(b"\x89PNG not a picture")
    report.write_report(tmp_path)
    page, parsed = checked(tmp_path)
    assert (
        "This run has not ended: it is still running, or was killed." in page
        and "12.5 m/s" in page
        and "img" not in parsed.seen
    )


def test_an_empty_folder_has_a_page(tmp_path):
    report.write_report(tmp_path)
    assert "no manifest" in checked(tmp_path)[0]


def test_pictures_are_inside_the_page_and_small(tmp_path, ran):
    import imageio.v2 as imageio

    noise = np.random.default_rng(0).integers(0, 255, (90, 160, 3), np.uint8)
    large = np.kron(noise, np.ones((12, 12, 1), np.uint8))  # 1920 x 1080
    for name in ("preview.png", "strip.png", "still_0001.500.png"):
        imageio.imwrite(tmp_path / name, large)
    (tmp_path / "film.mp4").write_bytes(b"a film")
    ran().run(until=0.02)
    page, parsed = checked(tmp_path)
    assert parsed.seen.count("img") == 3 and "film.mp4" in parsed.sources and "t = 1.500 s" in page
    assert len(page) < 3 * 0.9e6 and 'width="1200" height="675"' in page


def test_motions_and_platform_are_drawn(tmp_path, ran):
    time = np.arange(0.0, 5.0, 0.01)
    axes, parts = "xyz", ("gravity", "wind_drag", "total")
    names = ["heave_m", "roll_rad", "pitch_rad", "yaw_rad", "throttle", "rudder_rad"]
    names += [f"{n}_velocity_m_s" for n in ("surge", "sway", "heave")] + [f"specific_force_{a}_m_s2" for a in axes]
    names += [f"force_{part}_y_N" for part in parts]
    legs = [f"leg{k}_m" for k in range(1, 7)] + [f"leg{k}_velocity_m_s" for k in range(1, 7)]
    poses = [f"{n}_rad" for n in ("roll", "pitch", "yaw")] + [f"{a}_m" for a in axes]
    poses += [f"felt_force_{a}_m_s2" for a in axes] + ["limited"]
    for name, columns in (("motion", names), ("platform", legs + poses)):
        rows = np.column_stack([time] + [np.sin(time * (k + 1)) for k in range(len(columns))])
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header=",".join(["time_s", *columns]), comments="")
    ran().run(until=0.02)
    page, _ = checked(tmp_path)
    assert page.count('<figure class="plot">') == 7 + 5 and "wind_drag" in page and "leg 6" in page
    assert len(page) < 600_000


def luminance(colour):
    """Relative luminance of #rgb or #rrggbb (WCAG 2.2)."""
    digits = colour[1:] if len(colour) == 7 else "".join(2 * digit for digit in colour[1:])
    parts = np.array([int(digits[k : k + 2], 16) for k in (0, 2, 4)]) / 255.0
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(a, b):
    dark, light = sorted((luminance(a), luminance(b)))
    return (light + 0.05) / (dark + 0.05)


def test_every_word_of_a_page_has_a_contrast_of_4_5_to_1_in_both_themes():
    assert contrast("#000", "#ffffff") == pytest.approx(21.0) and contrast("#777777", "#fff") < 4.5
    themes = re.findall(r":root \{([^}]*)\}", PAGE_FILE.read_text())
    light, dark = (dict(re.findall(r"--(\w+): (#[0-9a-f]+)", theme)) for theme in themes[:2])
    for theme in (light, light | dark):
        for words in ("ink", "soft", "bad", "link"):
            assert contrast(theme[words], theme["paper"]) >= 4.5, (words, theme)
        assert contrast(theme["ink"], theme["block"]) >= 4.5


def test_every_curve_has_a_contrast_of_4_5_to_1_in_both_themes():
    """That of words, with the factor by which a theme makes its colours darker or lighter."""
    for theme in re.findall(r":root \{([^}]*)\}", PAGE_FILE.read_text())[:2]:
        factor, paper = (re.search(rf"--{name}: ([^;]+);", theme).group(1) for name in ("curves", "paper"))
        for colour in CURVE_COLOURS:
            parts = [min(round(float(factor) * int(colour[k : k + 2], 16)), 255) for k in (1, 3, 5)]
            assert contrast("#{:02x}{:02x}{:02x}".format(*parts), paper) >= 4.5, (colour, theme)


def test_many_curves_are_told_apart_and_named_beside_their_title():
    """All forces of a ship: every name stands by a line of its curve's look, and no two look alike."""
    names = ["gravity", "buoyancy", "wind_drag", "wind_lift", "wave", "damping", "propeller", "rudder", "total"]
    time = np.linspace(0.0, 1.0, 5)
    drawing = draw_curves(time, {name: time + k for k, name in enumerate(names)}, "vertical force [kN]")
    caption, plot = drawing.split("</figcaption>")
    look = r'stroke="([^"]+)" [^>]*?stroke-dasharray="([^"]+)"'
    looks = re.findall(rf'<polyline points="[^"]*" fill="none" {look}', plot)
    assert len(set(looks)) == len(names)
    assert [row[-1] for row in re.findall(rf"<span>.*?{look}.*?</svg> (\w+)</span>", caption)] == names
    assert re.findall(look, caption) == looks


def test_limits_of_the_legs_are_drawn(tmp_path, ran):
    time = np.arange(0.0, 1.0, 0.01)
    names = [f"leg{k}_m" for k in range(1, 7)] + [f"leg{k}_velocity_m_s" for k in range(1, 7)]
    names += [f"{n}_rad" for n in ("roll", "pitch", "yaw")] + [f"{a}_m" for a in "xyz"]
    names += [f"felt_force_{a}_m_s2" for a in "xyz"] + ["limited"]
    rows = np.column_stack([time] + [0.1 * np.sin(time * (k + 1)) for k in range(len(names))])
    np.savetxt(tmp_path / "platform.csv", rows, delimiter=",", header=",".join(["time_s", *names]), comments="")
    ran(platform={"geometry": {"shortest": 2.1, "longest": 3.3, "leg_speed": 1.0}}).run(until=0.02)
    page, _ = checked(tmp_path)
    for words in ("shortest", "longest", "fastest", "fastest, shortening"):
        assert f">{words}</text>" in page
    assert '<th scope="row">' in page and "Contents" in page and "<td class" not in page


def test_a_film_leaves_a_sheet_of_half_its_size_however_long_it_is():
    for length in (1, 7, 16, 17, 100, 1000):
        moments = Moments()
        for k in range(length):
            moments.see(np.full((8, 16, 3), k * 255 // max(length - 1, 1), np.uint8))
            assert len(moments.kept) <= 12
        sheet = moments.sheet()
        tones = sheet[:: 4 + 6, :: 8 + 6, 0].astype(int).ravel()
        assert sheet.shape == (2 * 4 + 6, 3 * 8 + 2 * 6, 3) and len(tones) == 6
        assert tones[0] == 0 and (np.diff(tones) > 0).all() == (length > 1) and tones[-1] >= 255 * 0.85 * (length > 1)


def test_a_scene_is_told_as_yaml(tmp_path):
    from ocean_sim.files.yaml_file import read_mapping

    scene = {
        "title": "Wind: <& water>, # not a comment",
        "seed": 7,
        "ship": {
            "hull": "yacht",
            "position": [0.0, -4.0],
            "free": ["heave"],
            "controls": [{"time": 0.0, "rudder": 0.1}],
        },
        "report": {},
    }
    path = tmp_path / "scene.yaml"
    path.write_text(scene_text(scene | {"platform": None}))
    assert read_mapping(path).plain() == scene
    assert json.loads(json.dumps(scene)) == scene


@pytest.mark.parametrize("low, high", [(0.0, 1.0), (-3.0, 17.0), (1e-9, 3e-9), (-2e6, 5e6)])
def test_ticks_are_round_and_enough(low, high):
    marks = round_ticks(low, high)
    assert 3 <= len(marks) <= 9 and marks[0] >= low - 1e-9 * (high - low) and marks[-1] <= high + 1e-9 * (high - low)
    step = marks[1] - marks[0]
    assert float(f"{step / 10.0 ** np.floor(np.log10(step * 1.0000001)):.6f}") in (1.0, 2.0, 5.0)


def test_a_long_curve_keeps_its_crests():
    time = np.linspace(0.0, 3600.0, 100_000)
    values = np.sin(2.0 * np.pi * time / 0.37)
    values[54_321] = 7.0
    few, kept = keep_crests(time, values)
    assert len(few) <= MAX_POINTS and kept.max() == 7.0 and kept.min() < -0.99 and (np.diff(few) > 0.0).all()


def test_curves_survive_flat_lines_gaps_and_a_single_row():
    time = np.linspace(0.0, 1.0, 5)
    for values in (np.zeros(5), np.array([0.0, np.nan, 1.0, np.inf, 2.0]), np.full(5, np.nan)):
        assert "nan" not in draw_curves(time, {"a": values}, "a")
    assert "nan" not in draw_curves(np.zeros(1), {"a": np.ones(1)}, "a")


@pytest.mark.parametrize("height, explained, cut", [(1.0, False, False), (5.0, True, False), (40.0, True, True)])
def test_needles_are_explained_where_they_stand_out(height, explained, cut):
    time = np.linspace(0.0, 10.0, 1001)
    values = np.sin(time)
    values[500] = height
    drawing = draw_curves(time, {"a": values}, "force [N]", on_needles="A needle is a slam.")
    assert ("A needle is a slam." in drawing, "1 values cut" in drawing) == (explained, cut)


def test_no_axis_has_a_negative_zero():
    time = np.linspace(0.0, 0.3, 7)
    drawing = draw_curves(time, {"a": time - 0.1}, "label")
    assert re.findall(r">(-?[\d.e+-]+)</text>", drawing)[:2] and ">-0<" not in drawing and ">0<" in drawing
    assert not np.signbit(round_ticks(-1e-12, 1.0)).any()
