"""Frames are written as NumPy would write them, only sooner."""

import zipfile

import numpy as np
import pytest

from ocean_sim.files import npz_file

RNG = np.random.default_rng(3)
ARRAYS = {
    "plain": RNG.random((5, 7), dtype=np.float32),
    "by_columns": np.asfortranarray(RNG.random((5, 7))),
    "neither": RNG.random((5, 7, 3))[..., [0, 2]],
    "every_other": np.arange(6, dtype=np.int32)[::2],
    "word": np.array("yacht"),
    "flag": np.array(True),
    "number": np.array(2.5),
    "Höhe": np.zeros(2),
    "none": np.zeros(0),
    "no_rows": np.zeros((0, 2, 3)),
}


def test_a_file_has_the_bytes_of_numpys_own(tmp_path):
    npz_file.write(tmp_path / "ours.npz", ARRAYS)
    np.savez(tmp_path / "theirs.npz", **ARRAYS)
    assert (tmp_path / "ours.npz").read_bytes() == (tmp_path / "theirs.npz").read_bytes()
    assert zipfile.ZipFile(tmp_path / "ours.npz").testzip() is None
    with np.load(tmp_path / "ours.npz", allow_pickle=False) as found:
        for name, array in ARRAYS.items():
            np.testing.assert_array_equal(found[name], array, strict=True)


def test_a_file_without_arrays_and_one_too_large_for_short_sizes_are_numpys_too(tmp_path, monkeypatch):
    for most, arrays in ((npz_file.MOST, {}), (10, ARRAYS)):
        monkeypatch.setattr(npz_file, "MOST", most)
        npz_file.write(tmp_path / "ours.npz", arrays)
        np.savez(tmp_path / "theirs.npz", **arrays)
        assert (tmp_path / "ours.npz").read_bytes() == (tmp_path / "theirs.npz").read_bytes()


def test_python_objects_are_refused(tmp_path):
    with pytest.raises((TypeError, ValueError)):
        npz_file.write(tmp_path / "ours.npz", {"what": np.array([object()])})
