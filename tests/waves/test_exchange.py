"""Seas in the files of other programs: byte by byte, there and back, and what is none is refused."""

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.__main__ import run_command_line
from ocean_sim.files.input_file import Unreadable
from ocean_sim.waves import exchange

SEA = waves.Components(
    np.array([0.5, 0.2]), np.array([[0.0, 0.05], [0.08, 0.0]]), np.array([0.3, -1.2]), 40.0, waves.GRAVITY
)
AT = np.random.default_rng(1).uniform(-50.0, 50.0, (20, 2))


def test_a_swd_file_is_what_the_format_says():
    """magic, fmt, shp, amp, prog, date, nid, cid, grav, lscale, nstrip, nsteps, dt, order, n, d, then four a wave; the
    elevation is A cos(omega t - kx x - ky y + delta) with x along heading 0 and y along heading 90."""
    data = exchange.to_swd(SEA, "two waves")
    head = struct.unpack_from("<fiii30s20si9s", data)
    assert head[:4] == (np.float32(37.0221), 100, 6, 1) and head[6:] == (9, b"two waves")
    at = struct.calcsize("<fiii30s20si9s")
    gravity, scale, strip, steps, _, order = struct.unpack_from("<ffiifi", data, at)
    assert (scale, strip, steps, order) == (1.0, 0, 0, 1) and gravity == np.float32(9.81)
    n, depth = struct.unpack_from("<if", data, at + 24)
    assert (n, depth) == (2, 40.0) and len(data) == at + 32 + 2 * 16
    eta = np.zeros(len(AT))
    for a, k, gamma, delta in struct.iter_unpack("<ffff", data[at + 32 :]):
        omega = np.sqrt(9.81 * k * np.tanh(k * 40.0))
        eta += a * np.cos(omega * 7.0 - k * np.cos(gamma) * AT[:, 1] - k * np.sin(gamma) * AT[:, 0] + delta)
    np.testing.assert_allclose(eta, waves.elevation(SEA, AT, 7.0), atol=2e-6)


def test_a_swd_file_comes_back_and_others_are_refused(tmp_path):
    path = tmp_path / "sea.swd"
    path.write_bytes(exchange.to_swd(SEA))
    np.testing.assert_allclose(
        waves.elevation(exchange.of_swd(path), AT, 7.0), waves.elevation(SEA, AT, 7.0), atol=2e-6
    )
    data = exchange.to_swd(SEA)
    for wrong, sentence in (
        (b"hello\n", "it begins otherwise; a .swd file"),
        (data[:-1], "ends too early"),
        (b"\0" + data[1:], "it begins otherwise"),
        (data[:8] + b"\x05" + data[9:], "of shape 5"),
    ):
        path.write_bytes(wrong)
        with pytest.raises(Unreadable, match=sentence):
            exchange.of_swd(path)


def test_elevations_for_openfast_come_back(tmp_path):
    time = np.arange(50) * 0.1
    path = tmp_path / "sea.Elev"
    path.write_text(exchange.to_openfast(time, np.sin(time)))
    back, eta = exchange.of_openfast(path)
    np.testing.assert_allclose(back, time, atol=1e-6)
    np.testing.assert_allclose(eta, np.sin(time), atol=1e-8)
    path.write_text("Time Elev\n0.0 1.0\n0.1 1.0\n0.5 1.0\n")
    with pytest.raises(Unreadable, match=r"row 2 has 0\.1 s after 0 s; .* evenly spaced"):
        exchange.of_openfast(path)


def test_the_sea_of_a_scene_is_written_and_read_by_another_scene(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    more = ["--set", r'title="two\nlines"']  # of which the second would stand where names of columns do
    files = ["--swd", "a.swd", "--openfast", "a.Elev"]
    code = run_command_line(["sea", "linear_sea", *files, "--until", "5", "--json", *more])
    answer = json.loads(capsys.readouterr().out)
    assert code == 0 and answer["files"] == ["a.swd", "a.Elev"] and len(exchange.of_openfast("a.Elev")[0]) == 51
    scene = "basin: {length: 100, width: 100, depth: 50, walls: none}\nfluid: {kind: spectral_sea, components: a.swd}\n"
    (tmp_path / "b.yaml").write_text(scene)
    code = run_command_line(["sea", "b.yaml", "--swd", "b.swd", "--json"])
    again = json.loads(capsys.readouterr().out)
    assert code == 0 and again["waves"] == answer["waves"]
    assert again["significant_height_m"] == pytest.approx(answer["significant_height_m"], rel=1e-3)
    assert run_command_line(["sea", "linear_sea"]) == 2 and "name a file to write" in capsys.readouterr().err


@pytest.mark.parametrize("words", [("--at", "nan,0"), ("--at", "1e30,0"), ("--until", "1e12")])
def test_numbers_that_no_sea_has_are_refused(words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run_command_line(["sea", "linear_sea", "--openfast", "a.Elev", "--until", "1", *words]) == 2
    assert capsys.readouterr().err.startswith(words[0]) and not Path("a.Elev").exists()


def test_the_library_of_the_format_reads_what_is_written(tmp_path):
    """spectral_wave_data by DNV, which wrote the format: elevations, and the sea that it was told of."""
    library = pytest.importorskip("spectral_wave_data", reason="spectral_wave_data, the format's own reader, is absent")
    path = tmp_path / "sea.swd"
    path.write_bytes(exchange.to_swd(SEA, "two waves"))
    sea = library.SpectralWaveData(str(path), 0.0, 0.0, 0.0, 0.0)
    sea.update_time(7.0)
    np.testing.assert_allclose([sea.elev(z, x) for x, z in AT], waves.elevation(SEA, AT, 7.0), atol=2e-6)
    assert sea.get("n") == 2 and sea.get("d") == 40.0
    sea.close()


def test_it_sees_the_velocities_of_linear_theory(tmp_path):
    """In low waves: in higher ones ours are stretched to the surface (Wheeler), which it leaves to its caller."""
    library = pytest.importorskip("spectral_wave_data", reason="spectral_wave_data, the format's own reader, is absent")
    low = replace(SEA, amplitude=1e-4 * SEA.amplitude)
    path = tmp_path / "low.swd"
    path.write_bytes(exchange.to_swd(low))
    sea = library.SpectralWaveData(str(path), 0.0, 0.0, 0.0, 0.0)
    sea.update_time(7.0)
    moved = waves.velocity(low, np.insert(AT, 1, -3.0, axis=1), 7.0)
    found = [(v.y, v.z, v.x) for v in (sea.grad_phi(z, x, -3.0) for x, z in AT)]
    np.testing.assert_allclose(found, moved, atol=2e-5 * np.abs(moved).max())
    sea.close()


def test_pandas_reads_elevations_as_the_table_that_they_are(tmp_path):
    pandas = pytest.importorskip("pandas", reason="pandas, a reader of tables that is not ours, is absent")
    time = np.arange(50) * 0.1
    path = tmp_path / "sea.Elev"
    path.write_text(exchange.to_openfast(time, np.sin(time)))
    table = pandas.read_csv(path, sep=r"\s+", skiprows=[0, 2])
    assert list(table.columns) == ["Time", "WaveElev"]
    np.testing.assert_allclose(table["Time"], time, atol=1e-6)
    np.testing.assert_allclose(table["WaveElev"], np.sin(time), atol=1e-8)


def test_openfasts_own_reader_of_tables_finds_names_units_and_rows(tmp_path):
    reader = pytest.importorskip("openfast_io.FAST_output_reader", reason="openfast_io is absent")
    path = tmp_path / "sea.Elev"
    path.write_text(exchange.to_openfast(np.arange(9) * 0.1, np.arange(9) * 0.01, "nine rows"))
    data, info = reader.load_ascii_output(str(path), 3, 0, 1, 2)
    assert info["attribute_names"] == ["Time", "WaveElev"] and info["attribute_units"] == ["s", "m"]
    np.testing.assert_allclose(data, np.stack([np.arange(9) * 0.1, np.arange(9) * 0.01], axis=1), atol=1e-9)
