"""What `check` says that a scheme takes of the waves of a scene."""

import numpy as np
import pytest

import ocean_sim
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.fluid.sph.initial_state import patch_waves
from ocean_sim.validation import problems

QUIET = {"accuracy": None, "health": None, "timings": None}
TILE = {"length": 1.0, "depth": 0.5, "walls": {"x": "periodic"}}
WAVE = {"kind": "regular_wave", "height": 0.02, "period": 0.8018}


def said(**parts) -> list[str]:
    config = ocean_sim.load({"duration": 1.0, **parts}, QUIET)
    return [one for one in config.fluid.statements(config.preflight) if "m high:" in one or "adds" in one]


def added(case: str, number: int, scheme: str, coarse: bool = False) -> tuple[float, float]:
    """Viscosity [m2/s] that is said to be added in a case, and its wavelength [m]."""
    config = problems(case, slow=coarse, coarse=coarse)[number].load(scheme)
    height = {"standing_wave": 0.1, "wind_growth": 2.0 * 0.06 / 6.2832}[case]
    length = {"standing_wave": 2.0, "wind_growth": 1.0}[case]
    return config.fluid.viscosity_added(config.preflight, length, height, case == "standing_wave"), length


@pytest.mark.parametrize(
    ("case", "number", "coarse", "measured"),
    [("wind_growth", 0, False, 5.0e-5), ("wind_growth", 0, True, 1.42e-4), ("standing_wave", 1, False, 1.92e-5)],
)
def test_what_delta_sph_adds_is_what_the_cases_measure(case, number, coarse, measured):
    """Their own figures without a wind and without viscosity, which the fit does not know."""
    assert added(case, number, "delta_sph", coarse)[0] == pytest.approx(measured, rel=0.35)


def test_finer_and_lower_waves_lose_less():
    def rate(**keys) -> float:
        config = ocean_sim.load(
            {"duration": 1.0, "basin": TILE, "fluid": {"kind": "delta_sph", "spacing": 0.02}}, QUIET
        )
        numbers = {"length": 1.0, "height": 0.02, "standing": False} | keys
        return config.fluid.viscosity_added(config.preflight, **numbers)

    assert rate(height=0.0) < rate() < rate(height=0.04)
    assert rate(standing=True) < rate() < rate(length=0.5)


@pytest.mark.parametrize("scheme", ["delta_sph", "dfsph", "mueller"])
def test_it_is_said_of_the_waves_that_a_scene_has(scheme):
    fluid = {"kind": scheme, "spacing": 0.02}
    (one,) = said(basin=TILE, fluid=fluid | {"initial": WAVE})
    assert "waves 1 m long and 0.02 m high" in one and f"{scheme} adds" in one and "in a period" in one
    assert said(basin=TILE, fluid=fluid) == []
    (of_piston,) = said(
        basin={"length": 4.0, "depth": 0.5, "wavemaker": {"wall": "x_min", "height": 0.04, "period": 1.2}}, fluid=fluid
    )
    assert "0.04 m high" in of_piston
    sea = {"kind": "spectrum", "spectrum": {"kind": "jonswap", "significant_wave_height": 0.03, "peak_period": 0.8}}
    (of_sea,) = said(basin=TILE | {"length": 8.0}, fluid=fluid | {"initial": sea})
    assert "0.03 m high" in of_sea
    target = {"kind": "absorbing", "target": {"waves": {"height": 0.05, "period": 0.8}}}
    (of_target,) = said(basin=TILE | {"length": 8.0, "walls": {"x_min": "reflecting", "x_max": target}}, fluid=fluid)
    assert "0.05 m high" in of_target


def test_it_is_not_said_next_to_more_viscosity_nor_at_another_support():
    fluid = {"kind": "delta_sph", "spacing": 0.02, "initial": WAVE}
    assert said(basin=TILE, fluid=fluid | {"kinematic_viscosity": 0.01}) == []
    (unknown,) = said(basin=TILE, fluid=fluid | {"support_ratio": 3.0})
    assert "was measured at a support of 4 spacings, and is not known at 3" in unknown


def test_standing_waves_travel_nowhere():
    fluid = {"kind": "delta_sph", "spacing": 0.02, "initial": {"kind": "standing_wave", "height": 0.02}}
    (one,) = said(basin={"length": 1.0, "depth": 0.5}, fluid=fluid)
    assert "over a wavelength travelled" not in one and "waves 2 m long and 0.02 m high" in one


@pytest.mark.parametrize(
    ("cut_off", "spacing", "warned", "stated"),
    [(4.0, 0.8, True, False), (2.0, 0.8, False, False), (4.0, 0.4, False, True), (4.0, 0.2, False, False)],
)
def test_waves_too_short_to_be_carried_are_left_out_and_told(cut_off, spacing, warned, stated):
    """A JONSWAP sea with 37 spacings to the highest waves; of its variance 4 % lies in waves of fewer than ten."""
    spectrum = {"significant_wave_height": 0.8, "peak_period": 4.5, "heading_deg": 90.0, "cut_off": cut_off}
    scene = {
        "duration": 60.0,
        "basin": {"length": 120.0, "depth": 10.0, "walls": "periodic"},
        "sea": {"kind": "linear_waves", "spectrum": spectrum},
        "fluid": {"kind": "delta_sph", "spacing": spacing},
    }
    config = ocean_sim.load(scene, QUIET)
    sea = patch_waves(config.preflight.tank, spacing)
    assert (2.0 * np.pi / sea.wavenumber).min() > 0.999 * 10.0 * spacing
    part = (sea.significant_height / 0.8) ** 2
    for said, expected in ((config.fluid.warnings, warned), (config.fluid.statements, stated)):
        found = [one for one in said(config.preflight) if "fewer than 10 particles" in one]
        assert len(found) == expected
        assert all(f"{1.0 - part:.2g} of the variance" in one for one in found)
        assert all(f"{sea.significant_height:.4g} m on the patch (asked for: 0.8 m)" in one for one in found)
    assert part == pytest.approx(1.0, abs=1e-9) or warned or stated


@pytest.mark.parametrize(
    ("spacing", "height", "warned"),
    [
        (0.05, 0.05, []),
        (0.1, 0.05, ["10 particles to a wavelength"]),
        (0.05, 0.09, ["(k a = 0.28)"]),
        (0.125, 0.05, ["the water is 4 particles deep", "8 particles to a wavelength"]),
    ],
)
def test_waves_that_are_coarse_or_break_are_warned_of(spacing, height, warned):
    wave = WAVE | {"height": height}
    config = ocean_sim.load(
        {"duration": 1.0, "basin": TILE, "fluid": {"kind": "delta_sph", "spacing": spacing, "initial": wave}}, QUIET
    )
    found = [one for one in config.fluid.warnings(config.preflight) if "too few" in one or "steep" in one]
    assert len(found) == len(warned) and all(part in one for part, one in zip(warned, found, strict=True))


def test_particles_larger_than_the_depth_are_refused():
    with pytest.raises(SceneError, match=r"fluid\.spacing: is larger than the water is deep, 1 m; .* 0\.25 m or less"):
        ocean_sim.load({"basin": {"length": 2.0, "depth": 1.0}, "fluid": {"kind": "delta_sph", "spacing": 5.0}})
