import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ocean_sim.files.csv_file import read_columns
from ocean_sim.observers.shared.csv_rows import CsvFile, Multiples, Sampled


@given(st.lists(st.floats(1e-4, 0.2), min_size=1, max_size=60), st.sampled_from([0.05, 0.033, 0.1, 0.01]))
def test_samples_lie_on_multiples_and_a_line_is_reproduced(steps, every):
    sampled, rows, time = Sampled(every), [], 0.0
    for dt in [0.0, *steps]:
        time += dt
        rows += sampled.rows(time, np.array([3.0 - 2.0 * time, 5.0 * time]))
    times = np.array([row.time for row in rows])
    assert (times == np.arange(len(rows)) * every).all()
    assert len(rows) == np.floor(time / every + 1e-9) + 1
    np.testing.assert_allclose([row.values for row in rows], np.c_[3.0 - 2.0 * times, 5.0 * times], atol=1e-9)


def test_what_has_no_in_between_is_held_from_the_state_before():
    sampled = Sampled(0.1)
    rows = [row for k in range(5) for row in sampled.rows(0.06 * k, np.zeros(1), (k,))]
    assert [(round(row.time, 9), row.held) for row in rows] == [(0.0, (0,)), (0.1, (1,)), (0.2, (3,))]


def test_a_run_that_starts_late_tells_no_times_before_its_start():
    assert list(Multiples(0.1).reached(0.35)) == []
    late = Sampled(0.1)
    assert late.rows(0.35, np.zeros(1)) == []
    assert [round(row.time, 9) for row in late.rows(0.52, np.zeros(1))] == [0.4, 0.5]


def test_a_multiple_missed_by_rounding_counts():
    time = sum([0.1] * 3)  # 0.30000000000000004
    assert list(Multiples(0.1).reached(0.0)) == [0]
    seen = Multiples(0.1)
    seen.reached(0.0)
    assert list(seen.reached(0.3 - 1e-13)) == [1, 2, 3]
    assert list(seen.reached(time)) == []


def test_a_csv_is_readable_while_it_is_written(tmp_path):
    path = tmp_path / "a.csv"
    csv = CsvFile(path, {"frame": "world", "note": "two\nlines"}, ["time_s", "a_m", "word"])
    csv.row([0.1 + 0.2, np.float32(1.0) / 3, "acoustic"])
    assert path.read_text() == "# frame: world\n# note: two lines\ntime_s,a_m,word\n0.3,0.333333343,acoustic\n"
    csv.file.write("0.4,0.1")  # killed within a line
    csv.close()
    table = read_columns(path)
    assert table["time_s"] == pytest.approx([0.3]) and table["word"].tolist() == ["acoustic"]
