"""Seas from files of spectra: one sea in every dialect, its directions and energy in every kind of water, bad files."""

import json
import shutil
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from scipy.io import netcdf_file

from ocean_sim import waves
from ocean_sim.__main__ import run_command_line
from ocean_sim.conventions import Refused
from ocean_sim.files.input_file import Unreadable
from ocean_sim.fluid.spectral_sea import SPECTRUM_COMPONENTS, snapped
from ocean_sim.fluid.sph.initial_state import patch_waves
from ocean_sim.parts import library
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.waves.directional import DirectionalSpectrum
from ocean_sim.waves.spectrum_files import ERA5_DIRECTIONS, ERA5_FREQUENCIES, read_spectra, read_spectrum

F, TOWARDS = ERA5_FREQUENCIES, ERA5_DIRECTIONS
TIME = datetime(2026, 10, 3, 12)
BUOY = library("scenes") / "41010.data_spec"


def cos_2s(angle_deg: np.ndarray, s: float) -> np.ndarray:
    return np.cos(0.5 * np.radians(angle_deg)) ** (2.0 * s)


def one_sea(mean: float = 250.0) -> DirectionalSpectrum:
    """A JONSWAP sea of 2 m and 9 s whose mean direction turns by 30 degrees from low to high frequencies."""
    spectrum = waves.Spectrum(significant_wave_height=2.0, peak_period=9.0)
    direction = (TOWARDS + 180.0) % 360.0
    shape = cos_2s(direction - (mean + 30.0 * np.linspace(-0.5, 0.5, len(F)))[:, None], 6.0)
    shape /= shape.sum(axis=1, keepdims=True) * np.radians(15.0)
    return DirectionalSpectrum(F, np.sort(direction), (spectrum.density(F)[:, None] * shape)[:, direction.argsort()])


def moments_of(sea: DirectionalSpectrum) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """S [m2/Hz], c1 and c2 (n,) about north and east, of the directions from which waves come."""
    density = sea.density.sum(axis=1) * sea.step
    angle, per = np.radians(sea.direction), sea.density * sea.step / np.maximum(density, 1e-30)[:, None]
    return density, per @ np.exp(1j * angle), per @ np.exp(2j * angle)


def degrees_of(moment: np.ndarray, order: int) -> np.ndarray:
    return np.degrees(np.angle(moment)) / order % (360.0 / order)


def write_ndbc(folder: Path, sea: DirectionalSpectrum) -> Path:
    s, c1, c2 = moments_of(sea)
    columns = {".data_spec": s, ".swdir": degrees_of(c1, 1), ".swdir2": degrees_of(c2, 2)}
    for ending, values in (columns | {".swr1": abs(c1), ".swr2": abs(c2)}).items():
        cells = [f"{value:.4f} ({f:.5f})" for value, f in zip(values, F)]
        separation = ["9.999"] if ending == ".data_spec" else []
        head = f"#YY  MM DD hh mm {'Sep_Freq < ' if separation else ''}x_1 (freq_1) ... >\n"
        (folder / f"b{ending}").write_text(head + " ".join(["2026 10 03 12 00", *separation, *cells]) + "\n")
    return folder / "b.data_spec"


def write_ndbc_year(folder: Path, sea: DirectionalSpectrum) -> Path:
    s, c1, c2 = moments_of(sea)
    columns = {"w": s, "d": degrees_of(c1, 1), "i": degrees_of(c2, 2), "j": 100.0 * abs(c1), "k": 100.0 * abs(c2)}
    for letter, values in columns.items():
        head = "#YY MM DD hh mm " + " ".join(f"{f:.5f}" for f in F)
        rows = "2026 10 03 12 00 " + " ".join(f"{value:.3f}" for value in values)
        (folder / f"b{letter}2026.txt").write_text(f"{head}\n{rows}\n")
    return folder / "bw2026.txt"


def write_cdip(folder: Path, sea: DirectionalSpectrum) -> Path:
    s, c1, c2 = moments_of(sea)
    head = "File Name: sp09801202610031200     Analyzed(UTC): 2026/10/03 1233 hrs\nStation Name: MADE UP\nHs(m): 2.00\n"
    head += " freq   Band      energy   Dmean     a1       b1       a2       b2    Check\n  Hz    width     m*m/Hz\n"
    for f, e, d, one, two in zip(F, s, degrees_of(c1, 1), c1, c2):
        head += f"{f:.5f} 0.0050 {e:10.4f} {d:.0f} {one.real:.4f} {one.imag:.4f} {two.real:.4f} {two.imag:.4f} 1.0\n"
    (folder / "sp.txt").write_text(head)
    return folder / "sp.txt"


def write_spotter(folder: Path, sea: DirectionalSpectrum) -> Path:
    """An angle t from east, counter-clockwise, to which waves travel, is 270 deg less the direction they come from."""
    s, c1, c2 = moments_of(sea)
    east, twice = np.exp(1.5j * np.pi) * c1.conj(), np.exp(3j * np.pi) * c2.conj()
    columns = {"f": F, "varianceDensity": s, "a1": east.real, "b1": east.imag, "a2": twice.real, "b2": twice.imag}
    cells = {f"{name}_{k}": f"{v:.6f}" for name, values in columns.items() for k, v in enumerate(values)}
    cells = {"Battery Voltage (V)": "4.1", "Epoch Time": "1791028800"} | cells | {"Surface Temperature (°C)": "-"}
    (folder / "spot.csv").write_text(f"{' ,'.join(cells)}\n{' ,'.join(cells.values())}\n")
    return folder / "spot.csv"


def swan_text(sea: DirectionalSpectrum, key: str, angles: np.ndarray, table: np.ndarray, name: str, unit: str) -> str:
    factor = table.max() / 9998.0
    rows = "\n".join(" ".join(f"{value:5.0f}" for value in row) for row in table / factor)
    axes = f"AFREQ  absolute frequencies in Hz\n {len(F)}\n" + "".join(f"{f:.5f}\n" for f in F)
    axes += f"{key}  directions\n {len(angles)}\n" + "".join(f"{angle:.4f}\n" for angle in angles)
    head = "SWAN   1\n$ made up\nTIME\n 1 coding\nLONLAT\n 2 places\n 1.0 2.0\n 3.0 4.0\n" + axes
    head += f"QUANT\n 1 number\n{name}  densities\n{unit} unit\n -99 exception value\n"
    return f"{head}20261003.120000 date\nFACTOR\n {factor:.8E}\n{rows}\nNODATA\n"


def write_swan(folder: Path, sea: DirectionalSpectrum) -> Path:
    (folder / "a.spc").write_text(
        swan_text(sea, "NDIR", sea.direction, np.radians(sea.density), "VaDens", "m2/Hz/degr")
    )
    return folder / "a.spc"


def write_swan_cartesian(folder: Path, sea: DirectionalSpectrum) -> Path:
    table = 1025.0 * 9.81 * sea.density
    (folder / "c.spc").write_text(
        swan_text(sea, "CDIR", (270.0 - sea.direction) % 360.0, table, "EnDens", "J/m2/Hz/rad")
    )
    return folder / "c.spc"


def in_rows(values: np.ndarray) -> str:
    return "\n".join(" ".join(f"{v:.3E}" for v in values[k : k + 7]) for k in range(0, len(values), 7))


def write_ww3(folder: Path, sea: DirectionalSpectrum) -> Path:
    text = f"'WAVEWATCH III SPECTRA'     {len(F)}    24     1 'spectral resolution for points'\n{in_rows(F)}\n"
    text += f"{in_rows(np.radians((sea.direction + 180.0) % 360.0))}\n20261003 120000\n"
    text += f"'41 010    '  28.9 -78.5  890.0  8.0 45.0  0.1 90.0\n{in_rows(sea.density.T.ravel())}\n"
    (folder / "ww3.spec").write_text(text)
    return folder / "ww3.spec"


def write_era5(folder: Path, sea: DirectionalSpectrum) -> Path:
    """The second of two places is land; densities below 1e-4 are missing."""
    order = ((sea.direction + 180.0) % 360.0).argsort()
    with netcdf_file(folder / "era5.nc", "w") as file:
        for name, size in {"time": 1, "frequency": 30, "direction": 24, "latitude": 1, "longitude": 2}.items():
            file.createDimension(name, size)
        clock = file.createVariable("time", "i4", ("time",))
        clock[:] = (TIME - datetime(1900, 1, 1)).days * 24 + 12
        clock.units = "hours since 1900-01-01 00:00:00.0"
        found = file.createVariable("d2fd", "f8", ("time", "frequency", "direction", "latitude", "longitude"))
        found._FillValue = -32767.0
        logarithm = np.log10(np.maximum(sea.density[:, order], 1e-30))
        found[:] = -32767.0
        found[0, :, :, 0, 0] = np.where(logarithm > -4.0, logarithm, -32767.0)
    return folder / "era5.nc"


DIALECTS = (
    *(write_ndbc, write_ndbc_year, write_cdip, write_spotter),
    *(write_swan, write_swan_cartesian, write_ww3, write_era5),
)


@pytest.mark.parametrize("write", DIALECTS)
@pytest.mark.parametrize("mean", [250.0, 5.0])
def test_one_sea_reads_alike_in_every_dialect(write, mean, tmp_path):
    sea = one_sea(mean)
    time, found = read_spectrum(write(tmp_path, sea), "2026-10-03T12:00", 1)
    state, expected = found.spread("mem").state(), sea.state()
    assert time == TIME
    assert state.hm0_m == pytest.approx(expected.hm0_m, rel=2e-3)
    assert state.tp_s == pytest.approx(expected.tp_s, rel=1e-3)
    assert state.tm02_s == pytest.approx(expected.tm02_s, rel=2e-3)
    assert (state.from_deg - expected.from_deg + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=0.2)
    assert state.spread_deg == pytest.approx(expected.spread_deg, abs=0.2)


@pytest.mark.parametrize(("time", "height", "peak", "mean"), [(0, 2.988, 9.09, 6.63), (1, 2.744, 8.33, 6.47)])
def test_the_buoy_off_cape_canaveral_is_as_published(time, height, peak, mean):
    """Of station 41010 on 2020-06-02 at 02:50 and 04:50."""
    state = read_spectra(BUOY)[time].points[0].spread("mem").state()
    assert state[:3] == (pytest.approx(height, abs=5e-4), pytest.approx(peak, abs=5e-3), pytest.approx(mean, abs=5e-3))


def test_values_that_stand_for_none_are_gaps(tmp_path):
    """MM, 999 and an absent row: a frequency without a density is left out, one without direction takes the nearest."""
    path = write_ndbc(tmp_path, one_sea())
    text = path.read_text().splitlines()
    words = text[1].split()
    words[6 + 2 * 5], words[6 + 2 * 9] = "MM", "999.00"
    path.write_text("\n".join([text[0], " ".join(words), text[1].replace("10 03 12", "10 03 13")]))
    for name in (".swdir", ".swr1", ".swr2", ".swdir2"):
        own = (path.with_suffix(name)).read_text().splitlines()
        row = own[1].split()
        row[5 + 2 * 12] = "999.0"
        path.with_suffix(name).write_text("\n".join([own[0], " ".join(row)]))
    record, second = read_spectra(path)
    found = record.points[0]
    assert len(found.frequency) == len(F) - 2 and record.time == TIME and second.points == [None]
    np.testing.assert_allclose(found.moments[:, 10], found.moments[:, 9])


@pytest.mark.parametrize("s", [1.0, 4.0, 15.0, 50.0])
def test_maximum_entropy_has_the_spread_of_a_cos_2s(s):
    """r1 = s / (s + 1) and r2 = s (s - 1) / ((s + 1) (s + 2))."""
    r1, r2 = s / (s + 1.0), s * (s - 1.0) / ((s + 1.0) * (s + 2.0))
    turn = np.exp(1j * np.radians(70.0))
    moments = np.array([[r1 * turn], [r2 * turn**2]])
    buoy = DirectionalSpectrum(np.array([0.1, 0.2]), np.zeros(1), np.ones((2, 1)), np.repeat(moments, 2, axis=1))
    state = buoy.spread("mem").state()
    assert state.from_deg == pytest.approx(70.0, abs=1e-6)
    assert state.spread_deg == pytest.approx(np.degrees(np.sqrt(2.0 / (s + 1.0))), rel=1e-3)
    clipped = buoy.spread("fourier")
    assert clipped.state().from_deg == pytest.approx(70.0, abs=1e-3) and clipped.density.min() >= 0.0
    assert clipped.state().spread_deg >= state.spread_deg - 1e-6  # a series cut short is wider than a narrow sea
    assert clipped.variance.sum() == pytest.approx(buoy.variance.sum())


@pytest.mark.parametrize("largest", [1.0, 0.0])
def test_moments_keep_the_mean_direction_of_each_band(largest):
    """Feasible second moments, up to the bound |c2 - c1^2| = 1 - |c1|^2, and any others; the cells are of 1 degree."""
    uniform = np.random.default_rng(0).uniform(size=(4, 2000))
    first, other = np.sqrt(0.0004 + 0.9996 * uniform[:2]) * np.exp(2j * np.pi * uniform[2:])
    second = first**2 + other * (1.0 - np.abs(first) ** 2) if largest else other
    outside = (np.abs(second - first**2) > 1.0 - np.abs(first) ** 2).sum()
    buoy = DirectionalSpectrum(np.linspace(0.1, 1.0, 2000), np.zeros(1), np.ones((2000, 1)), np.array([first, second]))
    found = buoy.spread("mem")
    assert np.abs(np.degrees(np.angle(found.moment / first))).max() < 1.0
    assert found.density.min() >= 0.0 and found.variance == pytest.approx(buoy.variance)
    assert found.remark == "" if largest else f"{outside} of 2000 bands" in found.remark


def test_a_sea_and_a_swell_are_two_partitions():
    swell, wind_sea = one_sea(250.0), one_sea(20.0)
    shifted = np.roll(wind_sea.density, 8, axis=0)
    shifted[:8] = 0.0
    both = DirectionalSpectrum(F, swell.direction, swell.density + 0.3 * shifted)
    first, second = both.partitions()
    parts = [part.state() for part in (first, second)]
    assert [round(part.from_deg, -1) for part in parts] == [250.0, 20.0]
    assert first.variance.sum() + second.variance.sum() == pytest.approx(both.variance.sum(), rel=0.02)


def direction_of(sea: waves.Components) -> np.ndarray:
    """Unit vector, x and z, of the mean direction to which waves travel."""
    ahead = (sea.amplitude**2 / sea.wavenumber) @ sea.wavevector
    return ahead / np.linalg.norm(ahead)


@pytest.mark.parametrize(
    ("north", "east"), [(None, [-1.0, 0.0]), (0.0, [-1.0, 0.0]), (90.0, [0.0, 1.0]), (180.0, [1.0, 0.0])]
)
def test_a_sea_from_the_west_travels_east(north, east, tmp_path):
    """Axes are right-handed and y points up: seen from above, east lies 90 degrees clockwise of north."""
    path = write_swan(tmp_path, one_sea(270.0))
    sea = waves.FileSpectrum(file=str(path), north_deg=north).components(np.array([0.0, 1.0]), 100.0)
    np.testing.assert_allclose(direction_of(sea), east, atol=0.02)


BASIN = {"length": 600.0, "width": 600.0, "depth": 400.0}
SPECTRUM = {"file": str(BUOY), "time": "2020-06-02T04:50"}
OPEN = {"basin": BASIN | {"walls": "none"}, "duration": 4.0}
PATCH = {
    "basin": BASIN | {"depth": 20.0, "walls": "periodic"},
    "fluid": {"kind": "delta_sph", "spacing": 1.0},
    "duration": 4.0,
}


def realised(kind: str) -> waves.Components:
    """The sea of station 41010 in a kind of water, as it begins."""
    if kind == "patch":
        tank = load(PATCH | {"sea": {"kind": "linear_waves", "spectrum": SPECTRUM}}).preflight.tank
        return tank.sea.plane_waves(tank)
    scene = load(
        OPEN
        | {
            "fluid": {"kind": kind.split()[0]}
            | ({"components": SPECTRUM} if "c" in kind.split()[1:] else {"spectrum": SPECTRUM})
        }
    )
    tank = scene.preflight.tank
    return scene.fluid.sea(tank) if kind == "linear_waves" else scene.fluid.sea_of(tank)


@pytest.mark.parametrize("kind", ["linear_waves", "spectral_sea", "spectral_sea c", "patch"])
@pytest.mark.parametrize("spreading", ["mem", "fourier"])
def test_a_realised_sea_has_the_height_and_the_directions_of_its_file(kind, spreading, monkeypatch):
    monkeypatch.setitem(SPECTRUM, "spreading", spreading)
    sea, buoy = realised(kind), read_spectra(BUOY)[1].points[0]
    assert sea.significant_height == pytest.approx(buoy.significant_height, rel=1e-9)
    coming = np.exp(-1j * (np.arctan2(*sea.wavevector.T) + np.pi))
    band = np.searchsorted(buoy.edges, sea.omega / (2.0 * np.pi)) - 1
    for k in np.flatnonzero(buoy.density[:, 0]):
        own = sea.amplitude**2 * (band == k)
        assert abs(np.degrees(np.angle(own @ coming * buoy.moments[0, k].conj()))) < 0.01
        assert 0.5 * own.sum() == pytest.approx(buoy.variance[k], rel=1e-9)
    state, found = buoy.spread(spreading).state(), own_state(sea, coming)
    assert found[0] == pytest.approx(state.from_deg, abs=1.0) and found[1] == pytest.approx(state.spread_deg, abs=2.0)


def test_seas_fitted_to_a_tile_or_a_patch_keep_height_and_mean_direction():
    """Waves that fit move to other bands; on a tile of 1600 m each band of a twentieth of the variance or more keeps
    its direction within a degree, on a patch of 600 m only the sea as a whole does."""
    buoy = read_spectra(BUOY)[1].points[0]
    tile = {"kind": "spectral_sea", "order": 3, "tile": 1600.0, "cells": 1024, "spectrum": SPECTRUM}
    scene = load(OPEN | {"fluid": tile})
    tank = scene.preflight.tank
    steep = snapped(scene.fluid.sea_of(tank, SPECTRUM_COMPONENTS), scene.fluid.tile_of(tank))
    patch = patch_waves(load(PATCH | {"sea": {"kind": "linear_waves", "spectrum": SPECTRUM}}).preflight.tank, 1.0)
    state = buoy.spread("mem").state()
    for sea in (steep, patch):
        coming = np.exp(-1j * (np.arctan2(*sea.wavevector.T) + np.pi))
        assert sea.significant_height == pytest.approx(buoy.significant_height, rel=5e-3)
        assert own_state(sea, coming) == (
            pytest.approx(state.from_deg, abs=1.0),
            pytest.approx(state.spread_deg, abs=1.0),
        )
        band = np.searchsorted(buoy.edges, sea.omega / (2.0 * np.pi)) - 1
        for k in np.flatnonzero(buoy.variance > 0.05 * buoy.variance.sum()) if sea is steep else ():
            own = sea.amplitude**2 * (band == k)
            assert abs(np.degrees(np.angle(own @ coming * buoy.moments[0, k].conj()))) < 1.0


def own_state(sea: waves.Components, coming: np.ndarray) -> tuple[float, float]:
    mean = sea.amplitude**2 @ coming / (sea.amplitude**2).sum()
    return float(np.degrees(np.angle(mean))) % 360.0, float(np.degrees(np.sqrt(2.0 - 2.0 * abs(mean))))


def test_gauges_read_the_sea_of_the_file():
    """A gauge stands in the sum of the file's waves; its variance over long is theirs."""
    scene = load(OPEN | {"fluid": {"kind": "linear_waves", "spectrum": SPECTRUM, "ramp": 0.0}})
    sea = scene.fluid.sea(scene.preflight.tank)
    with Simulation(scene) as simulation:
        simulation.step()
        at = np.array([[3.0, -20.0], [100.0, 50.0]])
        expected = waves.elevation(sea, at, simulation.time)
        np.testing.assert_allclose(simulation.fluid.elevations(at), expected, atol=2e-4)
    heights = waves.elevation(sea, np.random.default_rng(1).uniform(-1e6, 1e6, (100_000, 2)))
    assert 4.0 * heights.std() == pytest.approx(sea.significant_height, rel=0.01)


def test_in_a_slice_all_waves_travel_along_x_and_no_direction_may_be_given():
    slice_ = {"basin": {"length": 600.0, "depth": 400.0, "walls": "none"}, "duration": 4.0}
    scene = load(slice_ | {"fluid": {"kind": "linear_waves", "spectrum": SPECTRUM}})
    sea = scene.fluid.sea(scene.preflight.tank)
    assert (sea.wavevector[:, 1] == 0.0).all() and (sea.wavevector[:, 0] > 0.0).all()
    assert sea.significant_height == pytest.approx(2.7442, abs=1e-3)
    assert any("in 2-D all waves travel along +x" in note for note in scene.notes)
    with pytest.raises(Exception, match="in 2-D waves have one direction; leave north_deg out"):
        load(slice_ | {"fluid": {"kind": "linear_waves", "spectrum": SPECTRUM | {"north_deg": 0.0}}})


def test_check_states_where_north_and_east_lie(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = OPEN | {"fluid": {"kind": "spectral_sea", "spectrum": SPECTRUM}}
    (note,) = [note for note in load(scene).notes if "41010" in note]
    assert note.endswith("waves from 50 deg on average; north is +z, east is -x")
    Path("scene.yaml").write_text(json.dumps(scene | {"title": "sea"}))
    assert run_command_line(["check", "scene.yaml"]) == 0 and "north is +z, east is -x" in capsys.readouterr().out


def test_the_verb_lists_times_and_describes_one(tmp_path, capsys):
    assert run_command_line(["sea", str(BUOY)]) == 0
    said = capsys.readouterr().out
    assert "2020-06-02T02:50" in said and "2020-06-02T04:50" in said and not list(tmp_path.glob("*.png"))
    words = ["sea", str(BUOY), "--time", "2020-06-02T02:50", "--out", str(tmp_path), "--json"]
    assert run_command_line(words) == 0
    whole, *parts = json.loads(capsys.readouterr().out)["rows"]
    assert whole["hm0_m"] == pytest.approx(2.988, abs=1e-3) and len(parts) == 2
    assert (tmp_path / "41010_spectrum.png").stat().st_size > 10_000
    assert run_command_line(["sea", str(BUOY), "--swd", "a.swd"]) == 2
    assert run_command_line(["sea", "linear_sea", "--time", "2020-06-02T02:50"]) == 2


BAD = {
    "negative": (write_ndbc, " 0.0000 (0.03453)", " -0.5 (0.03453)", "a density of -0.5 at 0.03453 Hz"),
    "row": (
        write_ndbc,
        "(0.03453)",
        "",
        r"b\.data_spec: line 2: expected a date and a value for each frequency, got '2026",
    ),
    "frequency": (write_ndbc, "(0.03453)", "(low)", r"line 2: expected a date and a value for each frequency"),
    "date": (write_ndbc, "2026 10 03", "2026 13 03", "line 2: expected a date and a value"),
    "cdip row": (write_cdip, " 0.0050 ", " ", r"sp\.txt: line 6: expected nine numbers, .* got"),
    "cdip order": (
        write_cdip,
        "0.03798 0.0050",
        "0.03453 0.0050",
        r"line 7: expected .* a higher frequency .* '0.03453",
    ),
    "order": (write_ww3, "3.798E-02", "3.453E-02", "0.03453 Hz follows 0.03453 Hz"),
    "spotter clock": (
        write_spotter,
        "1791028800",
        "1791028800000",
        r"Epoch Time is 1791028800000 s: is it in milliseconds\?",
    ),
    "cdip time": (write_cdip, "202610031200 ", "sp ", "line 1: expected File Name: sp and a time"),
    "spotter": (write_spotter, "b2_0", "b3_0", "line 1: expected a column b2_0"),
    "swan key": (write_swan, "NDIR", "MDIR", "line 41: expected one of TIME, .* got 'MDIR"),
    "swan end": (write_swan, "NODATA\n", "", "line [0-9]+: expected FACTOR, ZERO or NODATA, got 'the end'"),
    "swan 1-D": (write_swan, " 1 number", " 3 numbers", "expected 1, of a 2-D spectrum, got '3 numbers'"),
    "swan unit": (write_swan, "m2/Hz/degr", "J/m2/Hz/degr", "line 70: expected m2/Hz/degr or m2/Hz/rad, got 'J/m2"),
    "swan quantity": (write_swan, "VaDens", "AcDens", "expected VaDens or EnDens, got 'AcDens"),
    "ww3 size": (write_ww3, "     30    24", "     30    25", "expected 25 directions"),
    "ww3 date": (write_ww3, "20261003 120000", "2026 120000", "line [0-9]+: expected a time like 20261003 120000"),
    "steps": (write_ww3, "1.309E-01", "1.909E-01", "deg off equal steps"),
    "unknown": (write_swan, "SWAN", "SWIM", "line 1 is 'SWIM   1'"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_is_refused_in_one_sentence(case, tmp_path, capsys):
    write, there, instead, sentence = BAD[case]
    path = write(tmp_path, one_sea())
    text = path.read_text()
    assert there in text
    path.write_text(text.replace(there, instead, 1))
    assert run_command_line(["sea", str(path), "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    with pytest.raises(Unreadable, match=sentence):
        read_spectra(path)


@pytest.mark.parametrize(
    ("write", "source", "name", "sentence"),
    [
        (write_ndbc, ".data_spec", ".swdir", r"b\.swdir: expected values in degrees"),
        (write_ndbc, ".swr1", ".data_spec", r"b\.data_spec: expected values in m2/Hz, after Sep_Freq"),
        (write_ndbc, ".swr1", ".swdir", r"b\.swdir: expected values in degrees"),
        (write_ndbc_year, "d2026.txt", "j2026.txt", r"bj2026\.txt: expected values in hundredths"),
    ],
)
def test_a_file_of_a_buoy_that_is_another_of_the_five_is_refused(write, source, name, sentence, tmp_path):
    path = write(tmp_path, one_sea())
    (tmp_path / f"b{name}").write_text((tmp_path / f"b{source}").read_text())
    with pytest.raises(Unreadable, match=sentence):
        read_spectra(path)


def test_r1_and_r2_of_a_year_as_fractions_are_refused(tmp_path):
    path = write_ndbc_year(tmp_path, one_sea())
    head, row = (tmp_path / "bj2026.txt").read_text().splitlines()
    words = row.split()
    row = " ".join([*words[:5], *(f"{0.01 * float(word):.3f}" for word in words[5:])])
    (tmp_path / "bj2026.txt").write_text(f"{head}\n{row}\n")
    with pytest.raises(Unreadable, match=r"bj2026\.txt: expected values in hundredths, got values up to 0\."):
        read_spectra(path)


@pytest.mark.parametrize("write", [write_spotter, write_ww3, write_swan])
def test_waves_steeper_than_any_are_listed_and_refused(write, tmp_path):
    sea = one_sea()
    path = write(tmp_path, replace(sea, density=100.0 * sea.density))
    assert read_spectra(path)
    with pytest.raises(Unreadable, match=r"its Hm0, 20\.1 m, is 0\.25 .*mind the unit of the densities"):
        read_spectrum(path, None, 1)


@pytest.mark.parametrize("word", ["ZERO", "NODATA"])
def test_a_file_of_gaps_alone_says_so(word, tmp_path):
    path = write_swan(tmp_path, one_sea())
    path.write_text(f"{path.read_text().partition('FACTOR')[0]}{word}\n{word}\n")
    with pytest.raises(Unreadable, match=f"no spectrum with energy and directions, all are {word}"):
        read_spectra(path)


def test_a_file_of_era5_says_what_is_wrong_with_it(tmp_path):
    path = write_era5(tmp_path, one_sea())
    whole = path.read_bytes()
    for data, sentence in {
        whole[:2000]: "cut short or damaged",
        whole.replace(
            b"hours since 1900-01-01", b"weeks before 1900-1-01"
        ): "'hours since 1900-01-01', not 'weeks before",
        whole.replace(b"d2fd", b"efth"): "a variable d2fd over time",
    }.items():
        path.write_bytes(data)
        with pytest.raises(Unreadable, match=sentence):
            read_spectra(path)


def test_a_time_may_have_an_offset_from_utc():
    there = read_spectrum(BUOY, "2020-06-02T06:50+02:00", 1)
    assert there[0] == read_spectrum(BUOY, "2020-06-02T04:50", 1)[0] == datetime(2020, 6, 2, 4, 50)


def test_a_missing_companion_an_unknown_name_and_another_time_are_refused(tmp_path):
    path = write_ndbc(tmp_path, one_sea())
    with pytest.raises(Unreadable, match=r"name its only time, 2026-10-03T12:00, not '2026-10-03T13:00'"):
        read_spectrum(path, "2026-10-03T13:00", 1)
    with pytest.raises(Unreadable, match="it has no spectrum of point 2, but of 1"):
        read_spectrum(path, None, 2)
    path.rename(tmp_path / "b.txt")
    with pytest.raises(Unreadable, match="its name does not tell those of the other four"):
        read_spectra(tmp_path / "b.txt")
    (tmp_path / "b.txt").rename(path)
    companion = tmp_path / "b.swr1"
    companion.write_text(companion.read_text().replace("(0.03453)", "(0.03454)"))
    with pytest.raises(Unreadable, match="its frequencies at 2026-10-03T12:00 are not those of the other four"):
        read_spectra(path)
    for text, sentence in {
        "": "line 1: expected #YY MM DD hh, got 'the end'",
        "#YY MM DD hh mm\n": r"none of the 1 times of b\.data_spec",
    }.items():
        companion.write_text(text)
        with pytest.raises(Unreadable, match=rf"b\.swr1: .*{sentence}"):
            read_spectra(path)
    (tmp_path / "b.swr2").unlink()
    with pytest.raises(Unreadable, match=r"b\.data_spec: there is no b\.swr2 next to it"):
        read_spectra(path)


def test_a_scene_tells_the_key_of_a_bad_file(tmp_path):
    with pytest.raises(Exception, match=r"fluid\.spectrum.* it has no|fluid\.spectrum.*name one of its 2 times"):
        load(OPEN | {"fluid": {"kind": "linear_waves", "spectrum": {"file": str(BUOY)}}})


def test_all_five_files_of_a_buoy_are_inputs_of_a_run(tmp_path):
    for path in (*library("scenes").glob("41010.*"), library("scenes") / "cape_canaveral.yaml"):
        shutil.copy(path, tmp_path)
    config = load(tmp_path / "cape_canaveral.yaml")
    assert {Path(name).suffix for name in config.inputs()} >= {".data_spec", ".swdir", ".swdir2", ".swr1", ".swr2"}
    changed = tmp_path / "41010.swr2"
    changed.write_text(changed.read_text() + "\n")
    with pytest.raises(Refused, match="swr2: this file has changed since"):
        config.inputs()
