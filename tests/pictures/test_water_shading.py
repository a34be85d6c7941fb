"""Each term against its closed form; the graphics processor's program against NumPy, pixel by pixel."""

import os
import subprocess
import sys

import _shaded_plane as plane
import numpy as np
import pytest
import shading_reference as reference

from ocean_sim.parts import PACKAGE
from ocean_sim.pictures.stage import opengl
from ocean_sim.pictures.stage import sky as sky_module
from ocean_sim.pictures.water import foam as foam_module
from ocean_sim.pictures.water import water_glsl
from ocean_sim.pictures.water import water_shading as w

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")
UP = np.array([[0.0, 1.0, 0.0]])


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """The pictures that `_shaded_plane` draws."""
    out = tmp_path_factory.mktemp("plane") / "drawn.npz"
    command = [sys.executable, plane.__file__, str(out)]
    inherited = opengl.drawing_environment(opengl.window())
    inherited["PYTHONPATH"] = os.pathsep.join([str(PACKAGE.parent), inherited.get("PYTHONPATH", "")])
    child = subprocess.run(command, env=inherited, capture_output=True, text=True, timeout=240)
    assert child.returncode == 0, child.stderr[-2000:]
    assert "ERR|" not in child.stderr, child.stderr[:2000]  # a mistake in a shader only logs
    with np.load(out) as file:
        return {name: file[name].astype(int) for name in file.files}


def test_fresnel_in_cosines_is_the_thesis_s_formula_in_angles_and_has_a_value_at_both_ends():
    angle = np.radians(np.linspace(0.5, 89.5, 179))
    inside = np.arcsin(np.sin(angle) / w.REFRACTIVE_INDEX)
    sines, tangents = (f(inside - angle) / f(inside + angle) for f in (np.sin, np.tan))
    np.testing.assert_allclose(w.fresnel(np.cos(angle)), 0.5 * (sines**2 + tangents**2), atol=1e-12)
    ends = w.fresnel(np.array([1.0, 0.0]))
    np.testing.assert_allclose(ends, [((w.REFRACTIVE_INDEX - 1) / (w.REFRACTIVE_INDEX + 1)) ** 2, 1.0], atol=1e-12)
    share = w.fresnel(np.cos(np.radians(np.linspace(0.0, 90.0, 9001))))
    assert np.isfinite(share).all() and (np.diff(share) > -1e-12).all()
    np.testing.assert_allclose(w.fresnel(np.cos(angle)) + reference.transmitted(np.cos(angle)), 1.0)


def test_the_widest_refracted_angle_is_that_of_snell():
    assert np.degrees(np.arccos(w.refracted_cosine(0.0))) == pytest.approx(48.607, abs=1e-3)  # the thesis prints 48.59
    assert np.degrees(np.arccos(w.refracted_cosine(0.0, n=4.0 / 3.0))) == pytest.approx(48.59, abs=1e-2)


def test_the_mirrored_ray_makes_the_angle_of_the_eye_with_the_normal():
    rng = np.random.default_rng(0)
    eye, normal = (sky_module.unit_vector(rng.normal(size=(200, 3))) for _ in range(2))
    ray = reference.reflected(eye, normal)
    np.testing.assert_allclose(reference.cosine(ray, normal), reference.cosine(eye, normal), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(ray, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(np.cross(eye, normal), np.cross(normal, ray), atol=1e-12)  # in one plane


def test_lights_of_a_surface_towards_the_sun_and_away_from_it():
    sun = np.array([0.0, 1.0, 0.0])
    one = np.ones(3)
    np.testing.assert_allclose(reference.diffuse(one, one, np.array([[0.0, 0.5, 0.75**0.5]]), sun), 0.5)
    np.testing.assert_allclose(reference.diffuse(one, one, -UP, sun), 0.0)
    np.testing.assert_allclose(reference.specular(1.0, one, UP, UP, sun, reference.SHININESS), 1.0)
    np.testing.assert_allclose(reference.specular(1.0, one, -UP, UP, sun, reference.SHININESS), 0.0)
    np.testing.assert_allclose(reference.ambient(0.3 * one, one), 0.3)


def test_the_imitative_range_lifts_only_what_is_brighter_than_the_threshold():
    dim, bright = np.full((1, 3), 0.9), np.full((1, 3), 1.2)
    np.testing.assert_array_equal(reference.hdr(dim), dim)
    np.testing.assert_allclose(reference.hdr(bright), 1.2 * (1.0 + w.HDR_FACTOR * 0.3))
    np.testing.assert_allclose(reference.hdr(np.full((1, 3), 1.0), factor=100.0), 11.0)  # the thesis's own factor


@pytest.mark.parametrize("variance", [0.002, 0.01, 0.03])
def test_facets_of_every_slope_make_up_the_whole_surface(variance):
    """The density of normals, each seen at its cosine, integrates to one over the hemisphere."""
    cosine = np.linspace(0.02, 1.0, 20001)
    whole = 2.0 * np.pi * np.trapezoid(w.beckmann(cosine, variance) * cosine, cosine)
    assert whole == pytest.approx(1.0, rel=1e-3)


def test_no_colour_is_not_a_number_straight_down_or_along_the_water():
    sky = plane.smooth_sky()
    for eye in (UP, sky_module.unit_vector(np.array([[1.0, 1e-9, 0.0]])), np.array([[1.0, 0.0, 0.0]])):
        for terms in plane.CASES.values():
            seen = reference.Water(UP, eye, np.array([10.0]), np.zeros(1), np.full(1, 0.004), np.ones(1))
            assert np.isfinite(reference.final_colour(seen, sky, terms)).all()


def test_switching_a_term_off_changes_the_picture():
    sky, seen = plane.smooth_sky(), plane.water(np.array(plane.EYES["aslant"]), foam=0.3)
    whole = reference.final_colour(seen, sky)
    for terms in (
        reference.ShadingTerms(fresnel=False),
        reference.ShadingTerms(foam=False),
        reference.ShadingTerms(body=False),
        reference.ShadingTerms(reflection=False),
    ):
        assert np.abs(reference.final_colour(seen, sky, terms) - whole).mean() > 0.01


def test_algorithm_6_is_the_sum_of_its_terms():
    """Golden numbers by hand: flat water under an even sky, seen from straight above, the sun at the zenith."""
    sky = sky_module.Sky(np.full((8, 8, 3), 0.5), np.array([0.0, 1.0, 0.0]), np.ones(3))
    seen = reference.Water(UP, UP, np.array([5.0]), np.zeros(1), np.zeros(1), np.zeros(1))
    share = ((w.REFRACTIVE_INDEX - 1) / (w.REFRACTIVE_INDEX + 1)) ** 2
    expected = w.DEEP_LIGHT + (1.0 - share) * w.CREST_LIGHT + share * 0.5 + 1.0
    np.testing.assert_allclose(reference.algorithm_6(seen, sky), expected[None], rtol=1e-6)
    np.testing.assert_allclose(reference.algorithm_6(seen._replace(foam=np.ones(1)), sky), w.FOAM_REFLECTANCE[None])
    without = reference.ShadingTerms(fresnel=False, glint="none")
    np.testing.assert_allclose(
        reference.algorithm_6(seen, sky, without), (w.DEEP_LIGHT + 0.6 * w.CREST_LIGHT + 0.2)[None], rtol=1e-6
    )


@with_opengl
@pytest.mark.parametrize("at", plane.EYES)
@pytest.mark.parametrize("case", plane.CASES)
def test_the_program_draws_what_numpy_says(drawn, case, at):
    colours = reference.final_colour(plane.water(np.array(plane.EYES[at])), plane.smooth_sky(), plane.CASES[case])
    expected = w.display_colours(colours, w.SEA_EXPOSURE).reshape(plane.PIXELS, plane.PIXELS, 3).astype(int)
    picture = drawn[f"{case} {at}"]
    assert picture.mean() > 5.0 and picture.std() > 1.0  # something was drawn
    assert np.abs(picture - expected).max() <= 2


@with_opengl
def test_the_comparison_sees_a_wrong_refractive_index(drawn, monkeypatch):
    monkeypatch.setattr(w.fresnel, "__defaults__", (1.5,))
    colours = reference.final_colour(
        plane.water(np.array(plane.EYES["above"])), plane.smooth_sky(), reference.ShadingTerms()
    )
    expected = w.display_colours(colours, w.SEA_EXPOSURE).reshape(plane.PIXELS, plane.PIXELS, 3).astype(int)
    assert np.abs(drawn["all above"] - expected).max() > 2


@with_opengl
@pytest.mark.parametrize("name", ["+x", "-x", "+z", "-z", "+y"])
def test_each_direction_of_a_six_coloured_sky_is_mirrored_from_where_it_is(drawn, name):
    picture = drawn[f"six {name}"].reshape(-1, 3).mean(axis=0)
    lit = np.array(plane.FACES[name]) > 0
    assert picture[lit].min() > 15.0 and picture[~lit].max() < 0.05 * picture[lit].min()


def test_no_direction_below_the_horizon_shows_the_nadir():
    below = sky_module.unit_vector(np.array([[1.0, -0.5, 0.0], [0.0, -0.9, -0.4], [0.01, -1.0, 0.0]]))
    np.testing.assert_allclose(plane.six_colours().sample(below), [(1, 0, 0), (1, 1, 0), (1, 0, 0)], atol=1e-6)


@with_opengl
def test_ripples_of_the_program_are_numpy_s(drawn):
    water = plane.water(np.array(plane.EYES["above"]))
    points = plane.positions().reshape(-1, 3)
    footprint = reference.lengthened(plane.footprints(water), reference.cosine(water.to_eye, water.normal))
    x, z, lost = reference.slopes(points[:, 0], points[:, 2], 0.0, footprint, 0.0, 1.0, 0.03)
    water = water._replace(normal=reference.tilted(water.normal, x, z), variance=water.variance + lost)
    expected = w.display_colours(reference.final_colour(water, plane.smooth_sky()), w.SEA_EXPOSURE).reshape(
        plane.PIXELS, plane.PIXELS, 3
    )
    difference = np.abs(drawn["ripples"] - expected.astype(int))
    assert difference.mean() < 0.5 and np.quantile(difference, 0.99) <= 4  # 32-bit places in the finest octaves
    assert np.abs(drawn["all above"] - expected.astype(int)).mean() > 4.0  # ripples do something


def test_ripples_have_the_slopes_of_cox_and_munk_whether_seen_or_not():
    x, z = np.random.default_rng(1).uniform(-200.0, 200.0, (2, 200_000))
    variance = w.slope_variance(7.0)
    assert variance == pytest.approx(0.0388, abs=1e-4)
    for footprint in (1e-3, 0.1, 0.5, 50.0):
        along, across, lost = reference.slopes(x, z, 3.0, np.full(x.shape, footprint), 0.4, 2.5, variance)
        seen = (along**2 + across**2).mean()
        assert seen + 2.0 * lost.mean() == pytest.approx(variance, rel=0.06)
    assert seen == 0.0


def test_ripples_are_steeper_along_the_wind_than_across_it():
    x, z = np.random.default_rng(2).uniform(-200.0, 200.0, (2, 100_000))
    for angle in (0.0, 1.1):
        a, b, _ = reference.slopes(x, z, 0.0, np.full(x.shape, 1e-3), angle, 2.5, 0.04)
        along, across = a * np.cos(angle) + b * np.sin(angle), b * np.cos(angle) - a * np.sin(angle)
        assert along.var() > 1.4 * across.var()


@pytest.mark.parametrize("cover", [0.02, 0.05, 0.10, 0.3])
def test_the_cover_of_foam_is_the_one_asked_for(cover):
    rng = np.random.default_rng(4)
    x, z = (a.ravel() for a in np.meshgrid(np.arange(0.0, 120.0, 0.3), np.arange(0.0, 120.0, 0.3)))
    crests = sum(np.cos(k[0] * x + k[1] * z + k[2]) for k in rng.uniform(-3.0, 3.0, (30, 3)))
    share = foam_module.white_shares(crests, cover)
    assert share.mean() == pytest.approx(cover, rel=0.05)
    for footprint in (0.01, 0.2, 2.0):
        white = reference.white(share, x, z, np.full(x.shape, footprint))
        assert white.mean() == pytest.approx(cover, rel=0.2)
        assert ((white >= 0.0) & (white <= 1.0)).all()


@pytest.mark.parametrize("share", [0.05, 0.15, 0.3, 0.6])
def test_foam_is_lace_that_covers_as_much_as_is_white_and_is_grey_where_it_is_thin(share):
    x, z = (a.ravel() for a in np.meshgrid(np.arange(0.0, 150.0, 0.25), np.arange(0.0, 150.0, 0.25)))
    white = reference.white(np.full(x.shape, share), x, z, np.full(x.shape, 1e-6))
    assert white.mean() == pytest.approx(share, rel=0.1)
    threads = reference.patches(x, z, np.zeros(x.shape))[0]
    assert threads[white > 0.3].min() > threads[white < 0.01].max()  # white on the threads, water in the bubbles
    assert white.max() == pytest.approx(min(0.4 + 1.2 * share, 1.0), abs=0.02)


@with_opengl
@pytest.mark.parametrize("share", [0.1, 0.3, 0.7])
def test_foam_of_the_program_is_numpy_s(drawn, share):
    water = plane.water(np.array(plane.EYES["above"]))
    points = plane.positions().reshape(-1, 3)
    footprint = plane.footprints(water)
    white = reference.white(np.full(len(points), share), points[:, 0], points[:, 2], footprint)
    heap = np.stack(reference.heaps(points[:, 0], points[:, 2], footprint), axis=1)
    water = water._replace(foam=white, bubbles=share, heap=heap)
    colours = reference.final_colour(water, plane.smooth_sky(), reference.ShadingTerms(glint="none"))
    expected = w.display_colours(colours, w.SEA_EXPOSURE).reshape(plane.PIXELS, plane.PIXELS, 3).astype(int)
    assert np.abs(drawn[f"foam {share}"] - expected).max() <= 2


def test_thick_foam_is_no_plain_sheet_and_is_as_bright_as_one():
    sky = plane.smooth_sky()
    seen = plane.water(np.array(plane.EYES["above"]), foam=1.0)
    points = plane.positions().reshape(-1, 3)
    flat = reference.final_colour(seen, sky, reference.ShadingTerms(glint="none"))
    for footprint, least, most in ((0.004, 0.04, 0.3), (0.2, 0.02, 0.15), (2.0, 0.0, 1e-9)):
        heap = np.stack(reference.heaps(points[:, 0], points[:, 2], np.full(len(points), footprint)), axis=1)
        ratio = (reference.final_colour(seen._replace(heap=heap), sky, reference.ShadingTerms(glint="none")) / flat)[
            :, 1
        ]
        assert least <= ratio.std() <= most
        assert ratio.mean() == pytest.approx(1.0, abs=0.06)


def test_calm_water_has_no_foam_by_either_rule():
    assert (
        not foam_module.white_shares(np.zeros((9, 9)), 0.05).any() and foam_module.crest_cover(np.zeros((9, 9))) == 0.0
    )
    ripples, far = np.linspace(0.0, 1.0, 500), np.array([0.5, 2.0])  # beyond the basin one is stronger than any inside
    assert (
        not foam_module.white_shares(far, 1e-12, ripples).any()
        and foam_module.white_shares(far, 0.05, ripples)[1] == 1.0
    )
    np.testing.assert_allclose(
        reference.foam_by_height(np.array([-1.0, 0.0, 0.2, 0.8, 2.0])), [0.0, 0.0, 0.375, 1.0, 1.0]
    )


def test_the_scattered_sky_is_blue_above_and_brightest_at_the_sun():
    sky = sky_module.Sky(**{k: v for k, v in sky_module.make_sky(128).items() if k == "image"})
    assert np.isfinite(sky.image).all() and (sky.image >= 0.0).all()
    away = sky_module.unit_vector(np.array([[-sky_module.SUN_DIRECTION[0], 1.0, -sky_module.SUN_DIRECTION[2]]]))
    clear = sky_module.scattered_light(away, sky_module.SUN_DIRECTION)[0][0]
    assert clear[2] > 1.5 * clear[0]
    d = sky_module.sky_directions(128).reshape(-1, 3)
    brightest = d[sky.image.reshape(-1, 3).sum(axis=1).argmax()]
    assert brightest @ sky_module.SUN_DIRECTION > np.cos(np.radians(2.0))


def test_the_tone_curve_is_that_of_a_power_of_1_over_2_2():
    root, (a, b, c, d, e) = np.linspace(0.0, 1.0, 2001), water_glsl.GAMMA_POLYNOMIAL
    curve = root * (a + root * (b + c * root)) / (d + root * (e + root))
    assert 255.0 * np.abs(curve - root ** (2.0 / 2.2)).max() < 0.08
