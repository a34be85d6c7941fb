"""Records of waves against closed forms, a published sea-state and seas whose spectrum is known; and the command."""

import json
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.__main__ import run_command_line
from ocean_sim.verbs.waves import sampling_facts
from ocean_sim.waves.orbits import breaking_cover, surface_fall
from ocean_sim.waves.record import (
    Treatment,
    Unmeasurable,
    linear_trend,
    measure_record,
    record_spectra,
    sampling_error,
    segment_count,
    up_crossings,
    welch_density,
    zero_crossing_waves,
)

# A known-answer record: a [m], f [Hz], phase [rad] of six cosines over 2000 s. Its moments are closed forms; the
# numbers of its zero up-crossings come from a script of its own, at 200 Hz.
SIX = np.array(
    [
        (0.5, 0.1, 0.3),
        (0.8, 0.125, 1.9),
        (0.6, 0.15, 4.1),
        (0.35, 0.19, 2.2),
        (0.2, 0.25, 5.5),
        (0.1, 0.33, 0.9),
    ]
)
KNOWN = {
    "hs_m": 3.3809,
    "hm0_m": 3.37343,
    "tz_s": 6.4496,
    "tm01_s": 7.27342,
    "tm02_s": 7.05111,
    "waves": 309,
    "hmax_m": 3.8332,
}


def six_cosines(interval: float) -> tuple[np.ndarray, np.ndarray]:
    time = np.arange(0.0, 2000.0 + interval / 2, interval)
    return time, sum(a * np.cos(2.0 * np.pi * f * time + phase) for a, f, phase in SIX)


@pytest.mark.parametrize("interval", [0.02, 0.1, 0.25])
def test_the_known_record_of_six_cosines(interval):
    found = measure_record(*six_cosines(interval)).numbers()
    for key, value in KNOWN.items():
        assert found[key] == pytest.approx(value, rel=1e-4 if interval < 0.2 else 3e-4), key
    assert found["tp_s"] == pytest.approx(8.0, rel=1e-3)  # the greatest of the six


@pytest.mark.parametrize("mean", [0.0, -3.0])
def test_a_single_cosine(mean):
    time = np.arange(0.0, 60.0, 0.05)
    found = measure_record(time, mean + 0.3 * np.cos(2.0 * np.pi * time / 3.1 + 0.2))
    assert found.hs_m == pytest.approx(0.6, rel=1e-6) and found.hmax_m == pytest.approx(0.6, rel=1e-6)
    assert found.hm0_m == pytest.approx(0.3 * 8.0**0.5, rel=5e-3)
    assert found.waves == 18 and found.tz_s == pytest.approx(3.1, rel=1e-6)
    for period in (found.tp_s, found.tm01_s, found.tm02_s):
        assert period == pytest.approx(3.1, rel=5e-3)


def sea(seed: int) -> waves.Components:
    spectrum = waves.Spectrum(significant_wave_height=2.0, peak_period=8.0, seed=seed)
    return spectrum.components(np.array([1.0, 0.0]), 100.0)


def test_a_jonswap_sea_has_the_moments_of_its_components():
    time = np.arange(0.0, 4000.0, 0.5)
    for seed in range(2):
        its = sea(seed)
        angle = its.phase[:, None] - its.omega[:, None] * time
        found = measure_record(time, its.amplitude @ np.cos(angle))
        variance, f = 0.5 * its.amplitude**2, its.omega / (2.0 * np.pi)
        assert found.hm0_m == pytest.approx(2.0, rel=0.005)
        assert found.tm01_s == pytest.approx(variance.sum() / (variance * f).sum(), rel=1e-3)
        assert found.tm02_s == pytest.approx((variance.sum() / (variance * f**2).sum()) ** 0.5, rel=1e-3)
        assert found.tp_s == pytest.approx(8.0, rel=0.05)
        assert found.tz_s == pytest.approx(found.tm02_s, rel=0.03)  # Rice: of a Gaussian sea
        assert 0.94 < found.hs_m / found.hm0_m < 1.0


def worst_error(periods: float, sample: float) -> float:
    """Worst relative error of T_p over phases of a sine of 1 s about a mean, in a record of so many of its periods."""
    time = np.arange(0.0, periods, sample)
    found = [
        measure_record(time, 3.0 + 0.2 * np.sin(2.0 * np.pi * time + phase)).tp_s
        for phase in np.arange(0.0, 6.28, 1.05)
    ]
    return max(np.inf if period is None else abs(period - 1.0) for period in found)


@pytest.mark.parametrize("sample", [0.4, 0.13, 0.05, 0.011])
def test_the_peak_period_of_a_sine_of_any_number_of_periods(sample):
    for periods in (*np.arange(5.0, 12.0, 0.5), *np.arange(12.3, 41.0, 3.1), 25.0, 27.0, 40.0):
        if periods >= 16 * sample:
            assert worst_error(periods + 1e-9, sample) < (0.02 if periods < 25.0 else 0.005), periods


@pytest.mark.parametrize("periods", [1.7, 2.0, 2.4, 2.8, 3.2, 3.7, 4.0, 4.6])
def test_the_peak_period_of_a_few_waves_is_right_or_none(periods):
    time = np.linspace(0.0, periods, 200)
    for phase in np.arange(0.0, 6.28, 0.7):
        found = measure_record(time, 0.5 + np.sin(2.0 * np.pi * time + phase))
        assert found.tp_s is None if periods < 2.9 else found.tp_s == pytest.approx(1.0, rel=0.02)
        assert (found.tm01_s is None) == (found.tm02_s is None) == (found.tp_s is None)


def test_sines_of_a_short_record_have_each_their_own_period():
    time = np.arange(0.0, 20.0, 0.05)
    for period in (3.0, 3.5, 4.0, 5.0, 6.0):
        assert measure_record(time, np.sin(2.0 * np.pi * time / period + 1.0)).tp_s == pytest.approx(period, rel=0.01)
    assert measure_record(time, np.sin(2.0 * np.pi * time / 9.0)).tp_s is None


def test_noise_and_a_slow_rise_of_the_level_leave_the_peak_period():
    noise = 0.1 * np.random.default_rng(3).normal(size=4000)
    for periods in (5, 8, 15, 30, 100):
        time = np.linspace(0.0, periods, 4000)
        record = np.sin(2.0 * np.pi * time + 0.3) + noise
        assert measure_record(time, record).tp_s == pytest.approx(1.0, rel=0.02)
        assert measure_record(time, record + 0.2 * time / periods).tp_s == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize("gamma, bias, scatter", [(3.3, 0.03, 0.05), (1.0, 0.07, 0.10)])
def test_the_peak_period_of_a_sea_scatters_no_more_than_averaged_spectra_do(gamma, bias, scatter):
    """Over records of 30 peak periods; a single periodogram scatters by half as much again."""
    time, found = np.arange(0.0, 240.0, 0.5), []
    for seed in range(60):
        spectrum = waves.Spectrum(significant_wave_height=2.0, peak_period=8.0, gamma=gamma, seed=seed)
        its = spectrum.components(np.array([1.0, 0.0]), 100.0)
        found.append(measure_record(time, its.amplitude @ np.cos(its.phase[:, None] - its.omega[:, None] * time)).tp_s)
    ratio = np.array(found) / 8.0
    assert abs(ratio.mean() - 1.0) < bias and ratio.std() < scatter


def test_a_long_record_is_averaged_over_eight_segments():
    assert segment_count(0.25, six_cosines(0.25)[1]) == 8
    for periods, count in ((4, 1), (8, 1), (10, 2), (20, 5), (28, 8)):
        sine = np.sin(2.0 * np.pi * np.linspace(0.0, periods, 2001))
        assert segment_count(periods / 2000, sine) == count


def test_spectra_of_several_gauges_have_common_frequencies():
    time = np.arange(0.0, 60.0, 0.05)
    heights = {"still": 0.0 * time, "short": np.sin(6.0 * time), "long": np.sin(0.7 * time)}
    frequency, densities = record_spectra(time, heights)
    assert frequency[1] == pytest.approx(1.0 / 60.0)  # what the longest waves need
    assert not densities["still"].any()
    assert np.trapezoid(densities["short"], frequency) == pytest.approx(0.5, rel=0.03)
    assert len(record_spectra(time, {"still": 0.0 * time})[0]) < len(frequency)


def test_gaussian_waves_of_a_narrow_band():
    """H1/3 = 4.004 sigma, mean 2.507 sigma, root mean square 2.828 sigma (Longuet-Higgins 1952)."""
    n, interval, random = 2**20, 0.125, np.random.default_rng(5)
    frequency = np.fft.rfftfreq(n, interval)
    size = np.exp(-0.5 * ((frequency - 0.5) / 0.01) ** 2)
    record = np.fft.irfft(size * np.exp(2j * np.pi * random.uniform(size=len(size))), n)
    record /= record.std()
    heights, _ = zero_crossing_waves(interval, record)
    highest = np.sort(heights)[::-1]
    assert highest[: len(heights) // 3].mean() == pytest.approx(4.004, rel=0.03)
    assert heights.mean() == pytest.approx(2.507, rel=0.03)
    assert np.sqrt((heights**2).mean()) == pytest.approx(2.828, rel=0.03)
    assert measure_record(interval * np.arange(n), record).hs_m == pytest.approx(4.004, rel=0.03)


def test_a_trend_is_taken_off_on_request():
    """Six cosines on a level that rises by 2 m: what is known of them again; without, the standard deviation of the
    rise alone is 2 / sqrt 12 m, and waves are missed where the record is far from its mean."""
    time, record = six_cosines(0.1)
    rising = record + 1e-3 * time - 0.7
    found = measure_record(time, rising, Treatment(detrended=True))
    for key, value in KNOWN.items():
        assert found.numbers()[key] == pytest.approx(value, rel=1e-3), key
    assert linear_trend(0.1, rising) == pytest.approx(1e-3, abs=3e-5)  # what cosines cut short leave of a slope
    left = measure_record(time, rising)
    assert left.hm0_m == pytest.approx(4.0 * (record.var() + 4.0 / 12.0) ** 0.5, rel=5e-3) and left.waves < 290
    low = record_spectra(time, {"a": rising}, Treatment(detrended=True))[1]["a"][1]
    assert low < 0.01 * record_spectra(time, {"a": rising})[1]["a"][1]


def test_a_level_that_rises_evenly_is_still_water_less_its_trend():
    time = np.arange(200) * 0.1
    assert measure_record(time, 3.0 + 0.02 * time, Treatment(detrended=True)).numbers()["hm0_m"] == 0.0
    assert measure_record(time, 3.0 + 0.02 * time).hm0_m == pytest.approx(4.0 * 0.02 * 20.0 / 12.0**0.5, rel=1e-3)


def test_noise_about_zero_makes_no_waves_with_hysteresis():
    """Sines of 4 s and 0.2 m under noise of 4 mm: 74 waves between their own crossings, whatever the noise."""
    time = np.arange(0.0, 300.0, 0.01)
    sine = -0.1 * np.cos(2.0 * np.pi * time / 4.0)
    noisy = sine + 0.004 * np.random.default_rng(4).normal(size=len(time))
    clean, counted = measure_record(time, sine), measure_record(time, noisy, Treatment(hysteresis=0.03))
    assert clean.waves == counted.waves == 74 and measure_record(time, noisy).waves > 150
    assert counted.tz_s == pytest.approx(4.0, abs=2.0 * 0.026 / 74)  # noise over the slope at a crossing is 26 ms
    assert counted.hs_m == pytest.approx(0.2, abs=6.0 * 0.004)  # the greatest of noise on crest and trough
    assert measure_record(time, sine, Treatment(hysteresis=0.0999)).waves == 74
    assert measure_record(time, sine, Treatment(hysteresis=0.1001)).waves == 0


def test_hysteresis_leaves_out_what_stays_within_it():
    """Every third wave is 0.1 m high, the others 1 m: with 0.06 m two of three are counted, and the times of their
    crossings stay; a threshold below the small ones changes nothing."""
    time = np.arange(0.0, 90.0, 0.01)
    size = np.where((time // 2.0).astype(int) % 3 == 2, 0.05, 0.5)
    record = size * np.sin(np.pi * time - 1e-6)
    all_times, _ = up_crossings(0.01, record)
    some_times, before = up_crossings(0.01, record, 0.06)
    assert len(all_times) == 45 and len(some_times) == 29  # before the first the record has not been below -0.06 m
    assert set(some_times) <= set(all_times) and (record[before] < 0.0).all()
    np.testing.assert_array_equal(up_crossings(0.01, record, 0.04)[0], all_times[1:])
    heights, periods = zero_crossing_waves(0.01, record, 0.06)
    assert heights == pytest.approx(1.0, rel=1e-6) and sorted(set(periods.round(3))) == [2.0, 4.0]


def test_the_command_takes_off_a_trend_and_noise(tmp_path, capsys):
    time = np.arange(0.0, 200.0, 0.02)
    record = -0.1 * np.cos(2.0 * np.pi * time / 4.0) + 0.002 * time
    record += 0.004 * np.random.default_rng(4).normal(size=len(time))
    run = gauges_file(tmp_path / "run", {"time_s": time, "mid_m": record})
    assert run_command_line(["waves", str(run), "--json", "--detrend", "--hysteresis", "0.03"]) == 0
    found = json.loads(capsys.readouterr().out)["mid"]
    assert found["waves"] == 49 and found["hm0_m"] == pytest.approx(0.2 * 2.0**0.5, rel=0.01)
    assert found["trend_m_s"] == pytest.approx(0.002, rel=0.01) and found["hysteresis_m"] == 0.03
    notes = (run / "waves.csv").read_text().splitlines()[:2]
    assert notes == ["# detrended: less the straight line through each record", "# hysteresis: 0.03 m"]
    assert run_command_line(["waves", str(run), "--detrend", "--hysteresis", "0.5"]) == 0
    said = capsys.readouterr().out
    assert (
        "mid: less a trend of 0.002 m/s" in said
        and "the record holds no wave that goes 0.5 m below and above zero" in said
    )
    assert run_command_line(["waves", str(run), "--hysteresis", "-1"]) == 2
    assert run_command_line(["waves", str(run), "--hysteresis", "nan"]) == 2
    assert run_command_line(["waves", str(run), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["mid"]
    assert "trend_m_s" not in found and "hysteresis_m" not in found
    assert (run / "waves.csv").read_text().startswith("gauge,")


def test_the_spectrum_holds_the_variance():
    _, record = six_cosines(0.25)
    frequency, density = welch_density(0.25, record)
    assert np.trapezoid(density, frequency) == pytest.approx(0.71125, rel=0.02)


def test_uneven_samples_are_put_on_even_times():
    time, record = six_cosines(0.05)
    kept = np.random.default_rng(2).uniform(size=len(time)) > 0.1
    found = measure_record(time[kept], record[kept])
    assert found.hm0_m == pytest.approx(3.37343, rel=0.002) and abs(found.waves - 309) <= 1


def test_still_water_has_no_waves():
    found = measure_record(np.arange(100) * 0.1, np.full(100, 0.2))
    assert found.numbers() == {
        "hs_m": 0.0,
        "hm0_m": 0.0,
        "tz_s": None,
        "tp_s": None,
        "tm01_s": None,
        "tm02_s": None,
        "waves": 0,
        "hmax_m": 0.0,
    }


def test_a_record_shorter_than_a_wave_has_a_deviation_alone():
    time = np.arange(100) * 0.1
    found = measure_record(time, np.sin(2.0 * np.pi * time / 15.0)).numbers()
    assert found.pop("hm0_m") > 1.0 and found.pop("waves") == 0 and set(found.values()) == {None}


GAP = np.concatenate([np.arange(0.0, 200.05, 0.1), np.arange(300.0, 600.0, 0.1)])  # a straight line is no wave


@pytest.mark.parametrize(
    "time, height, why",
    [
        (np.arange(10) * 0.1, np.arange(10.0), "too short: 10 samples"),
        (np.arange(50) * 0.1, np.full(50, np.nan), "not numbers"),
        (np.zeros(50), np.arange(50.0), "do not increase"),
        (GAP, np.sin(2.0 * np.pi * GAP / 7.0), "a gap of 100 s after 200 s, more than half of its mean wave"),
    ],
)
def test_what_is_no_record_says_why(time, height, why):
    with pytest.raises(Unmeasurable, match=why):
        measure_record(time, height)


def test_a_record_whose_interval_changes_is_one():
    time = np.concatenate([np.arange(0.0, 100.0, 0.1), np.arange(100.0, 600.0, 0.5)])
    sea = measure_record(time, 0.5 * np.sin(2.0 * np.pi * time / 7.0))
    assert sea.tz_s == pytest.approx(7.0, rel=1e-3) and sea.hs_m == pytest.approx(1.0, rel=0.02)


def test_the_sampling_error_is_the_scatter_of_records_of_one_sea():
    """Gaussian seas of one spectrum, each cut down to 40 waves of a sixteenth of its length."""
    noise = np.random.default_rng(1).normal(size=(400, 8192))
    frequency = np.fft.rfftfreq(8192, 0.5)
    shape = np.exp(-0.5 * ((frequency - 0.15) / 0.02) ** 2)
    cut = np.fft.irfft(np.fft.rfft(noise) * shape)[:, :512]
    cut -= cut.mean(axis=1, keepdims=True)
    deviations = cut.std(axis=1)
    errors = [sampling_error(record) for record in cut]
    assert np.mean(errors) == pytest.approx(deviations.std() / deviations.mean(), rel=0.1)
    assert sampling_facts([0.35, 0.12, 0.09]) == [
        "4 sqrt m0 of irregular waves has a standard error of 9 to 12 % in a record of this length"
    ]


def gauges_file(folder, columns: dict[str, np.ndarray]):
    """A run's gauges.csv."""
    folder.mkdir(exist_ok=True)
    rows = [",".join(f"{value:.9g}" for value in row) for row in zip(*columns.values())]
    (folder / "gauges.csv").write_text("# frame: world\n" + "\n".join([",".join(columns), *rows]) + "\n")
    return folder


def test_the_command_measures_every_gauge_and_leaves_table_spectra_and_plot(tmp_path, capsys):
    time, record = six_cosines(0.1)
    run = gauges_file(tmp_path / "run", {"time_s": time, "mid_m": record, "end_m": 0 * time, "bed_Pa": time})
    assert run_command_line(["waves", str(run), "--json", "--out", str(tmp_path / "out")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert set(found) == {"mid", "end"} and set(found["mid"]) == {*KNOWN, "tp_s"}
    assert {key: found["mid"][key] for key in KNOWN} == pytest.approx(KNOWN, rel=1e-4)
    assert found["end"]["hs_m"] == 0.0 and found["end"]["tz_s"] is None
    assert {file.name for file in (tmp_path / "out").iterdir()} == {"waves.csv", "spectra.csv", "waves.png"}
    assert (tmp_path / "out" / "waves.png").stat().st_size > 10_000
    assert run_command_line(["waves", str(run / "gauges.csv"), "--begin", "1000"]) == 0
    said = capsys.readouterr().out
    assert "end: the record is constant" in said and "from 1000 to 2000 s" in said


def test_a_gauge_that_falls_dry_is_left_out(tmp_path, capsys):
    time, record = six_cosines(0.1)
    swash = np.where(record > 0.0, record, np.nan)
    run = gauges_file(tmp_path / "run", {"time_s": time, "mid_m": record, "swash_m": swash})
    assert run_command_line(["waves", str(run), "--json"]) == 0
    assert [*json.loads(capsys.readouterr().out)] == ["mid"]
    dry = gauges_file(tmp_path / "dry", {"time_s": time, "swash_m": swash})
    assert run_command_line(["waves", str(dry)]) == 2 and "swash_m is 'nan'" in capsys.readouterr().err


def test_the_command_says_what_a_short_record_cannot_say(tmp_path, capsys):
    time = np.arange(0.0, 20.0, 0.05)
    waves_of = {"swell_m": np.sin(2.0 * np.pi * time / 8.0 + 1.0), "chop_m": 0.1 * np.sin(2.0 * np.pi * time / 0.8)}
    run = gauges_file(tmp_path / "run", {"time_s": time, **waves_of})
    assert run_command_line(["waves", str(run), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["swell"]["tp_s"] is None and found["swell"]["tm01_s"] is None and found["swell"]["tm02_s"] is None
    assert found["swell"]["tz_s"] == pytest.approx(8.0, rel=0.02)
    assert found["chop"]["tp_s"] == pytest.approx(0.8, rel=0.005)
    assert run_command_line(["waves", str(run)]) == 0
    shown = capsys.readouterr().out
    assert "swell: the record holds 1 wave; statistics of irregular waves need at least 20" in shown
    assert "swell: the record is shorter than 3 periods of its spectral peak" in shown
    assert "chop: " not in shown and "standard error" not in shown
    row = (run / "waves.csv").read_text().splitlines()[1].split(",")
    assert row[0] == "swell" and row[5:8] == ["", "", ""]
    run = gauges_file(tmp_path / "followed", {"time_s": time, "swell_m": waves_of["swell_m"]})
    (run / "tracers.csv").write_text("time_s\n0\n")
    assert run_command_line(["waves", str(run)]) == 0
    assert "no orbits, as no gauge's record resolves a peak period" in capsys.readouterr().out


def test_the_command_says_what_is_missing(tmp_path, capsys):
    time = np.arange(50) * 0.1
    asked = {
        "there is no such run folder": tmp_path / "nowhere",
        "has no gauges.csv; name gauges": gauges_file(tmp_path / "other", {"time_s": time}).parent,
        "has no elevation gauge": gauges_file(tmp_path / "pressures", {"time_s": time, "bed_Pa": time}),
        "too short: 5 samples": gauges_file(tmp_path / "short", {"time_s": time[:5], "a_m": time[:5]}),
        "no column time_s": gauges_file(tmp_path / "timeless", {"a_m": time, "b_m": time}),
        "no rows under a heading": gauges_file(tmp_path / "empty", {"time_s": time[:0], "a_m": time[:0]}),
    }
    for sentence, run in asked.items():
        assert run_command_line(["waves", str(run)]) == 2
        assert sentence in capsys.readouterr().err
    run = gauges_file(tmp_path / "late", {"time_s": time, "a_m": time})
    assert run_command_line(["waves", str(run), "--begin", "9"]) == 2 and "before --begin" in capsys.readouterr().err


def test_samples_that_a_record_lacks_are_counted(tmp_path, capsys):
    """Without two samples after 39.9 s, and one after 79.9 s."""
    time, height = six_cosines(0.1)
    kept = np.delete(np.arange(len(time)), [400, 401, 800])
    run = gauges_file(tmp_path / "run", {"time_s": time[kept], "mid_m": height[kept]})
    said = "missing samples, filled by straight lines: 3, the first after 39.9 s (row 400)"
    assert run_command_line(["waves", str(run)]) == 0 and said in capsys.readouterr().out
    assert run_command_line(["waves", str(run), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["mid"]["warnings"] == [said]
    whole = gauges_file(tmp_path / "whole", {"time_s": time, "mid_m": height})
    assert run_command_line(["waves", str(whole)]) == 0 and "missing" not in capsys.readouterr().out


def frames_of(folder, turning: float, height: float):
    """Frames of water that turns as a whole [rad/s] about the vertical, under a long-crested wave of 20 m."""
    (folder / "frames").mkdir(parents=True)
    side = (np.arange(40) + 0.5) - 20.0
    x, z = np.meshgrid(side, side, indexing="ij")
    corner = np.array([20.0, 0.0, 20.0])
    place = {"x": side, "z": side, "lower": -corner, "upper": corner, "depth": 7.5, "spacing": 1.0}
    np.savez(folder / "frames" / "grid.npz", **place)
    flat = np.stack([x.ravel(), 0.0 * x.ravel(), z.ravel()], axis=1)
    for n in range(4):
        velocity = n * turning * np.stack([flat[:, 2], flat[:, 1], -flat[:, 0]], axis=1)
        elevation = 0.5 * height * np.cos(np.pi * x / 10.0 + 0.4 * n)
        content = {"time": 0.5 * n, "elevation": elevation, "position": flat, "velocity": velocity}
        np.savez(folder / "frames" / f"frame_{n:05d}.npz", **content)


def test_the_command_reports_circulation_white_caps_and_the_gain(tmp_path, capsys):
    time, record = six_cosines(0.1)
    run = gauges_file(tmp_path / "run", {"time_s": time, "mid_m": record})
    wind = {"kind": "stress", "u10": 10.0, "drag_law": "wu", "gain": 300.0, "schedule": None}
    (run / "manifest.json").write_text(json.dumps({"scene": {"wind": wind}}))
    frames_of(run, 0.2, 4.0)
    assert run_command_line(["waves", str(run), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["mid"]
    assert found["wind_gain"] == 300.0
    assert found["circulation_m2_s"] == pytest.approx(1.5 * 0.2 * 2.0 * np.pi * 10.0**2, rel=0.02)
    steepest = 0.5 * 4.0 * np.pi / 10.0 * np.tanh(np.pi / 10.0 * 7.5)  # of gravity, at the crests
    assert found["white_cap_cover"] == pytest.approx(np.arccos(0.4 / steepest) / np.pi, abs=0.03)
    rows = (run / "surface.csv").read_text().splitlines()
    assert rows[0] == "time_s,circulation_m2_s,white_cap_cover" and rows[1].startswith("0,0,") and len(rows) == 5
    assert run_command_line(["waves", str(run)]) == 0
    said = capsys.readouterr().out
    assert (
        "U10 10 m/s, law wu, times a gain of 300" in said
        and "on a circle of 10 m about the middle" in said
        and "white caps on" in said
    )
    (run / "frames" / "frame_00002.npz").write_bytes(b"PK\x03\x04")
    assert run_command_line(["waves", str(run)]) == 0 and "cannot be read" in capsys.readouterr().out
    for keys, sentence in (
        ({}, "U10 10 m/s, law wu, times"),
        ({"tau": 2.5}, "a physical stress of 2.5 Pa, times"),
        ({"pressure_gain": 2.0}, "times a gain of 300, its pressure on waves times 2"),
    ):
        left_open = wind | {"u10": None, "drag_law": None, **keys}
        (run / "manifest.json").write_text(json.dumps({"scene": {"wind": left_open}}))
        assert run_command_line(["waves", str(run)]) == 0 and sentence in capsys.readouterr().out


def test_waves_that_are_not_steep_or_too_short_to_count_are_not_white(tmp_path):
    x = 0.5 * np.arange(80)
    long, short = (np.tile(a * np.cos(k * x)[:, None], (1, 3)) for a, k in ((0.5, 0.5), (0.2, 2.0 * np.pi)))
    assert breaking_cover(surface_fall(long, 0.5, 0.5)) == 0.0  # 0.25 g
    assert breaking_cover(surface_fall(3.0 * long, 0.5, 0.5)) > 0.2
    assert (
        breaking_cover(surface_fall(3.0 * long, 0.5, 0.5, depth=0.2)) == 0.0
    )  # long waves on shallow water fall slowly
    assert breaking_cover(surface_fall(short, 0.5, 0.5)) > 0.2
    assert breaking_cover(surface_fall(short, 0.5, 0.5, shortest=2.0)) == 0.0


def measured_by_the_command(tmp_path, capsys, height, *options, time=None):
    time = 0.5 * np.arange(len(height)) if time is None else time
    path = tmp_path / "record.csv"
    path.write_text("time_s,eta_m\n" + "".join(f"{t:.3f},{h:.5g}\n" for t, h in zip(time, height)))
    code = run_command_line(["waves", str(path), "--out", str(tmp_path / "out"), *options])
    out = capsys.readouterr()
    return code, " ".join((out.out + out.err).split())


@pytest.mark.parametrize("value", [9999.0, -9999.0, -999.0, 99.99, -99.9, 9.999, 1e20])
@pytest.mark.parametrize("row", [0, 300])
def test_heights_that_no_sea_has_are_refused(tmp_path, capsys, value, row):
    height = six_cosines(0.5)[1] * 0.2
    height[row : row + 3] = value
    code, said = measured_by_the_command(tmp_path, capsys, height)
    assert code == 2 and f"eta_m is {value:g} in row {row + 1}" in said


def test_a_trend_or_a_tide_is_said(tmp_path, capsys):
    time, height = six_cosines(0.5)
    assert "--detrend" not in measured_by_the_command(tmp_path, capsys, height - 20.0)[1]
    code, said = measured_by_the_command(tmp_path, capsys, height + 0.004 * time)
    assert code == 0 and "a trend of 0.004 m/s makes the height 2.9 times that of its waves; take --detrend" in said
    assert "take --detrend" not in measured_by_the_command(tmp_path, capsys, height + 0.004 * time, "--detrend")[1]
    code, said = measured_by_the_command(tmp_path, capsys, height + 2.0 * np.cos(2.0 * np.pi * time / 1000.0), "--json")
    assert code == 0 and "as a tide, makes the height 2 times that of its waves" in said


def test_records_of_other_programs_are_read_whole_or_refused(tmp_path, capsys, monkeypatch):
    from ocean_sim.waves import exchange

    monkeypatch.chdir(tmp_path)
    time, height = (values[:400] for values in six_cosines(0.5))
    Path("sea.Elev").write_text(exchange.to_openfast(time, height))
    Path("sea.csv").write_text("time_s,WaveElev_m\n" + "".join(f"{t:.6f},{h:.9e}\n" for t, h in zip(time, height)))
    answers = []
    for name in ("sea.Elev", "sea.csv"):
        assert run_command_line(["waves", name, "--json"]) == 0
        answers.append(json.loads(capsys.readouterr().out))
    assert answers[0] == answers[1] and answers[0]["WaveElev"]["waves"] > 20
    lines = Path("sea.Elev").read_text().splitlines()
    for row, said in (
        ("word 1.0", "row 41 is"),
        ("20.0 nan", "row 41 is"),
        ("99.0 0.1", "row 41 has 99 s after 19.5 s"),
    ):
        Path("bad.Elev").write_text("\n".join([*lines[:43], row, *lines[44:]]))
        assert run_command_line(["waves", "bad.Elev"]) == 2 and said in " ".join(capsys.readouterr().err.split())
