"""Read files that a user names or a run wrote, with rules that error messages cite.

A name in a scene is relative to the scene's file, and may climb out of its folder or be absolute: it is the user's own
machine. Anything but a regular file (a folder, a pipe, a device) is refused before it is opened: reading it might never
end.
"""

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import suppress
from difflib import get_close_matches
from io import BytesIO
from math import prod
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import Annotated, Any, NamedTuple
from zipfile import ZipFile

import numpy as np
from pydantic import AfterValidator, ValidationInfo

from ocean_sim.conventions import Refused

MAX_FILE_BYTES = 500_000_000  # of a file, and of what it unpacks to: far beyond any table or hull
NUMBER_KINDS, WORD_KINDS = "iuf", "SO"  # kinds of NumPy types in HDF5 files
MAX_WORDS = 1000  # of a data set
BYTE_ORDER_MARK = "\ufeff"  # of the order of bytes, at the beginning of text
# The mark of UTF-32 begins as that of UTF-16.
MARKED_CODECS = ("utf-8", "utf-32-le", "utf-32-be", "utf-16-le", "utf-16-be")
FIRST_BYTES = {  # of files that are no text, and what to do with them
    b"PK\3\4": "a zip archive or an Excel workbook: unpack it, or save its table as CSV",
    b"\xd0\xcf\x11\xe0": "an Excel workbook: save its table as CSV",
    b"MATLAB 5": "a MATLAB file: save its table as CSV",
    b"\x1f\x8b": "a gzip archive: unpack it",
}
SCENE_FOLDER_KEY = "folder"  # the key of the scene's folder in pydantic's context


class Unreadable(Refused, ValueError):
    """Error of a file that cannot be read or breaks a rule; the message gives its path and the reason."""

    def __init__(self, path: str | Path, reason: str) -> None:
        self.reason = reason
        super().__init__(f"{display_path(path)}: {reason}")


class Rule(str):
    """Sentence, without its full stop, that states a rule for input files; error messages on a breach end with it."""

    @property
    def sentence(self) -> str:
        return self[0].upper() + self[1:]

    def broken(self, path: str | Path, found: str) -> Unreadable:
        """Error to raise for a file that breaks this rule; `found`: text on the content that breaks it."""
        return Unreadable(path, f"{found} {self.sentence}." if found.endswith("?") else f"{found}; {self}")


class Checked(NamedTuple):
    """Entry of the documentation on input files: title of a group of files, and the rules that are checked for them."""

    title: str
    rules: tuple[Rule, ...]


REGULAR_FILE_RULE = Rule(
    f"a file is a regular one, not a folder, a pipe or a device, of at most {MAX_FILE_BYTES / 1e6:g} MB, unpacked"
)
DATA_SET_RULE = Rule(
    f"a data set lies in the file itself, holds what its name says and unpacks to at most {MAX_FILE_BYTES / 1e6:g} MB"
)
TEXT_RULE = Rule("text is in UTF-8, or in UTF-16 or UTF-32 with a byte order mark")

CHECKS = (Checked("Every file", (REGULAR_FILE_RULE, TEXT_RULE)),)


def display_path(path: str | Path) -> str:
    """A path for messages: relative if inside the working directory, printable, at most 120 characters."""
    relative = os.path.relpath(path) if str(path) else "''"
    name = str(path) if relative.startswith(os.pardir) else relative
    name = "".join(c if c.isprintable() else "?" for c in name)
    return name if len(name) <= 120 else f"{name[:57]}...{name[-60:]}"


def size_of(path: str | Path, most: int = MAX_FILE_BYTES) -> int:
    """Size of a regular file [bytes]. Raises Unreadable for a folder or more than `most` bytes, OSError if missing."""
    found = os.stat(path)
    if S_ISDIR(found.st_mode):
        raise Unreadable(path, "this is a folder, not a file")
    if not S_ISREG(found.st_mode):
        raise Unreadable(path, "this is not a regular file (but a pipe or a device)")
    if found.st_size > most:
        raise Unreadable(path, f"this file has {found.st_size / 1e6:.1f} MB; at most {most / 1e6:g} MB are read")
    return found.st_size


def read_bytes(path: str | Path, most: int = MAX_FILE_BYTES) -> bytes:
    """Content of a regular file; raises Unreadable if the file is missing or has more than `most` bytes."""
    try:
        size = size_of(path, most)
        with Path(path).open("rb") as file:
            return file.read(size)
    except FileNotFoundError:
        raise Unreadable(path, f"there is no such file{near_name(path)}") from None
    except (OSError, ValueError) as error:
        if isinstance(error, Unreadable):
            raise
        raise Unreadable(path, f"cannot be read: {getattr(error, 'strerror', None) or error}") from None


def near_name(path: str | Path) -> str:
    """Ending of a message on a missing file that suggests the most similar name in its folder; empty if none is."""
    with suppress(OSError):
        near = get_close_matches(Path(path).name, os.listdir(Path(path).parent), n=1, cutoff=0.8)
        return f"; did you mean {near[0]!r}?" if near else ""
    return ""


def marked_codec(data: bytes) -> str | None:
    """Name of the Unicode codec that a byte order mark at the start of `data` announces; None without one."""
    return next((codec for codec in MARKED_CODECS if data.startswith(BYTE_ORDER_MARK.encode(codec))), None)


def read_text(path: str | Path, most: int = MAX_FILE_BYTES) -> str:
    """Text of a file of at most `most` bytes, decoded by its byte order mark, else as UTF-8; raises Unreadable."""
    data = read_bytes(path, most)
    if kind := next((kind for first, kind in FIRST_BYTES.items() if data.startswith(first)), None):
        raise Unreadable(path, f"this is no text but {kind}")
    codec = marked_codec(data) or "utf-8"
    try:
        return data.decode(codec).removeprefix(BYTE_ORDER_MARK)
    except UnicodeDecodeError as error:
        found = f"this is not {codec.upper()} text (byte {error.start})"
        raise Unreadable(path, f"{found}; save it as UTF-8 (is it damaged, or in Windows-1252?)") from None


def read_json(path: str | Path) -> Any:
    """The value in a JSON file; raises Unreadable."""
    try:
        return json.loads(read_text(path))
    except (json.JSONDecodeError, RecursionError):
        raise Unreadable(path, "this is not a whole JSON file") from None


def read_json_object(path: str | Path) -> dict[str, Any]:
    """The object in a JSON file as a dict; empty if the file is missing, damaged or holds another type of value."""
    with suppress(Unreadable):
        found = read_json(path)
        return found if isinstance(found, dict) else {}
    return {}


def read_npz(path: str | Path) -> dict[str, np.ndarray]:
    """Arrays of an npz file by name; raises Unreadable, also for Python objects, since loading them could run code."""
    data = BytesIO(read_bytes(path))
    try:
        with ZipFile(data) as archive:
            size = sum(member.file_size for member in archive.infolist())
        if size <= MAX_FILE_BYTES:
            with np.load(data) as found:
                return {name: found[name] for name in found.files}
    except Exception:  # zipfile, zlib and NumPy each have errors of their own
        raise Unreadable(path, "this is not a whole npz file of numbers") from None
    raise Unreadable(path, f"it unpacks to {size / 1e6:.1f} MB; at most {MAX_FILE_BYTES / 1e6:g} MB are read")


def open_netcdf(path: str | Path) -> Any:
    """NetCDF 3 file, opened with values scaled and masked; raises Unreadable, or SciPy's errors if it is damaged."""
    from scipy.io import netcdf_file

    data = read_bytes(path)
    if data[:4] == b"\x89HDF":
        raise Unreadable(path, "this is netCDF 4; `nccopy -3 FILE OTHER.nc` writes it as netCDF 3, which is read")
    return netcdf_file(BytesIO(data), mmap=False, maskandscale=True)


def read_data_set(group: Any, name: str, kinds: str = NUMBER_KINDS, most: int = MAX_FILE_BYTES) -> np.ndarray:
    """Array of the data set `name` in an HDF5 group. Raises ValueError, before unpacking, if it is missing, larger than
    `most` bytes, or of a NumPy kind that is not in `kinds`; h5py raises its own errors for a damaged file."""
    import h5py

    own = isinstance(group.get(name, getlink=True), h5py.HardLink)  # a link leads to any file, or to itself
    found = group[name] if own else None
    if not isinstance(found, h5py.Dataset) or found.shape is None:
        raise ValueError(f"it has no data set {name}")
    if found.external or found.is_virtual:
        raise ValueError(f"the numbers of {name} lie in another file")
    word = h5py.check_string_dtype(found.dtype) is not None
    if found.dtype.kind not in kinds or (found.dtype.kind == "O" and not word):
        raise ValueError(f"{name} holds {found.dtype}")
    size = max(prod(found.shape), prod(found.chunks or ())) * found.dtype.itemsize
    if size > most or (word and found.size > MAX_WORDS):
        raise ValueError(f"{name} unpacks to {size / 1e6:g} MB")
    return np.asarray(found[()])


def file_digest(path: str | Path) -> str:
    """SHA-256 of a file's content as hexadecimal text; raises Unreadable."""
    return hashlib.sha256(read_bytes(path)).hexdigest()


class InputName(str):
    """Name of a file in a scene whose content changes the results of a run; `input_names` collects them."""


def input_names(dumped: Any) -> Iterator[str]:
    """Yield each InputName in `dumped`, nested dicts and lists as a pydantic model dumps them."""
    if isinstance(dumped, InputName):
        yield str(dumped)
    elif isinstance(dumped, dict | list | tuple):
        for inner in dumped.values() if isinstance(dumped, dict) else dumped:
            yield from input_names(inner)


def relative_to_scene(name: str, info: ValidationInfo) -> str:
    """File name in a scene, joined to the folder of the scene's file if there is one; a pydantic validator."""
    folder = (info.context or {}).get(SCENE_FOLDER_KEY)
    return name if folder is None or not name else str(Path(folder, name))


AnyFileName = Annotated[str, AfterValidator(relative_to_scene)]
FileName = Annotated[AnyFileName, AfterValidator(InputName)]
