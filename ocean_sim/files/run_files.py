"""Run folders: only one process may write into one, by a lock that ends with the process, and a new run replaces only
the files that the old run's manifest lists.

An entry of a manifest is a path below the folder, in which * stands for digits and dots: `frames/frame_*.npz`.
"""

import fcntl
import os
import re
import socket
from collections.abc import Iterable
from contextlib import suppress
from errno import EACCES, EAGAIN
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from ocean_sim.conventions import Lacking, Refused
from ocean_sim.files import input_file
from ocean_sim.files.atomic_file import DRAFT_PATTERN, RESERVE_FILE, write_facts

LOCK_FILE, MANIFEST_FILE = ".lock", "manifest.json"
MAX_FILES_NAMED = 3  # of those that are in the way
MAX_CLAIM_TRIES = 1000  # times that others may remove a folder just before it is claimed


def is_unfinished(name: str) -> bool:
    """True if a file of this name is a temporary one of `atomic_write`, or reserved disk space, of a killed process."""
    return re.fullmatch(DRAFT_PATTERN, name) is not None or name == RESERVE_FILE


def foreign_names(folder: Path, *ours: str) -> list[str]:
    """Names in a folder that match none of the patterns `ours`, such as `*.png`. Empty if the folder is missing, or if
    Ocean Sim has written there before: a manifest or a file named as the first pattern is in it."""
    if not folder.is_dir() or any((folder / mark).exists() for mark in (MANIFEST_FILE, *ours[:1])):
        return []
    names = sorted(path.name for path in folder.iterdir())
    own = (LOCK_FILE, *ours)
    return [each for each in names if not is_unfinished(each) and not any(fnmatch(each, one) for one in own)]


def claim_folder(out: Path, *ours: str, named: str = "") -> "Claim":
    """Claim (lock) a folder for writing. Raises Refused if `out` is a file, or holds files that match none of the name
    patterns `ours`, if any (see `foreign_names`); the message calls it `named`. Other errors as in `Claim`."""
    named = named or str(out)
    if out.exists() and not out.is_dir():
        raise Refused(f"{named}: this is a file, not a folder")
    if ours and (others := foreign_names(out, *ours)):
        shown = ", ".join(others[:MAX_FILES_NAMED] + ["..."] * (len(others) > MAX_FILES_NAMED))
        raise Refused(f"{named}: this folder holds other things ({shown}); name a new folder")
    return Claim(out)


class FolderClaimed(Refused):
    """Error: another process has claimed the folder and is writing into it."""


class Claim:
    """Lock on a folder, created if missing, in which only this process may then write; a context manager. It ends with
    the process.

    Temporary files of killed processes are deleted, and at the end the folder, if new and empty. Raises FolderClaimed
    if another process has it, Refused if it cannot be created, Lacking if its file system has no locks."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.path, self.made = folder, folder / LOCK_FILE, not folder.exists()
        self.file = self.acquire_lock()
        with suppress(OSError):  # a full disk has no room for its name
            os.ftruncate(self.file, 0)
            os.write(self.file, f"process {os.getpid()} on {socket.gethostname()}".encode())
        for left in [*folder.glob(".*"), *folder.glob("frames/.*")]:
            if is_unfinished(left.name):
                left.unlink()

    def acquire_lock(self) -> int:
        """Create and lock the lock file, again if another process deletes it meanwhile; returns its file descriptor."""
        for _ in range(MAX_CLAIM_TRIES):
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                file = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o666)
            except (FileExistsError, FileNotFoundError, NotADirectoryError):
                if self.folder.is_file() or self.folder.is_symlink() or not self.folder.parent.is_dir():
                    why = "there is a file, or a link to nowhere, where a folder should be"
                    raise Refused(f"{self.folder}: {why}") from None
                continue  # another holder has removed the folder, which was made for nothing
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.path.samestat(os.fstat(file), os.stat(self.path)):
                    return file
            except FileNotFoundError:
                pass
            except OSError as error:
                os.close(file)
                if error.errno not in (EACCES, EAGAIN):
                    raise Lacking(f"{self.folder}: its file system has no locks ({error.strerror})") from None
                raise FolderClaimed(f"{self.folder}: {self.holder()} is writing here; name another folder") from None
            os.close(file)
        raise Refused(f"{self.folder}: no folder can be made here")

    def holder(self) -> str:
        """Process and host that hold the lock, as its file names them; else `another process`."""
        try:
            return input_file.read_bytes(self.path).decode(errors="replace") or "another process"
        except input_file.Unreadable:
            return "another process"

    def close(self) -> None:
        """Release the lock, delete its file so that others can claim the folder, and the folder if new and empty."""
        self.path.unlink(missing_ok=True)
        os.close(self.file)
        if self.made:
            with suppress(OSError):  # there is something in it
                self.folder.rmdir()

    def __enter__(self) -> Path:
        return self.folder

    def __exit__(self, *exception: object) -> None:
        self.close()


def read_manifest(folder: Path) -> dict[str, Any]:
    """The manifest in a run folder as a dict; empty if it is missing or unreadable."""
    return input_file.read_json_object(folder / MANIFEST_FILE)


def listed_files(manifest: dict[str, Any]) -> list[str]:
    """Entries of a manifest (paths, in which * stands for digits and dots), with the manifest's own name first."""
    files = manifest.get("files")
    return [MANIFEST_FILE, *(name for name in (files if isinstance(files, list) else []) if isinstance(name, str))]


def matching_files(folder: Path, entries: Iterable[str]) -> set[Path]:
    """Paths of files in a folder that match `entries` of a manifest; entries that lead out of it are ignored."""
    names: dict[Path, list[str]] = {}
    for path in map(Path, entries):
        if not path.is_absolute() and ".." not in path.parts:
            names.setdefault(folder / path.parent, []).append(re.escape(path.name).replace(r"\*", r"[\d.]+"))
    return {
        path
        for parent, patterns in names.items()
        for path in (parent.iterdir() if parent.is_dir() else ())
        if re.fullmatch("|".join(patterns), path.name) and not path.is_dir()
    }


def delete_run(folder: Path, coming: Iterable[str] = ()) -> None:
    """Delete the files listed by the manifest in a folder, and subfolders left empty. Raises Refused, before any
    deletion, if an unlisted file matches an entry of `coming`, the files of the new run."""
    ours = matching_files(folder, listed_files(read_manifest(folder)))
    for other in sorted(matching_files(folder, coming) - ours):
        raise Refused(f"{other}: this file is not of the run that is there, and the new run would replace it; move it")
    for path in sorted(ours, key=lambda path: path.name == MANIFEST_FILE):  # which is last: it tells what is left
        path.unlink()
    for parent in {path.parent for path in ours} - {folder}:
        with suppress(OSError):  # there is something in it
            parent.rmdir()


def add_to_manifest(folder: Path, files: Iterable[Path]) -> None:
    """List files made after a run, such as pictures, in the manifest of its folder, if it has one."""
    if manifest := read_manifest(folder):
        new = {file.relative_to(folder).as_posix() for file in files if file.is_relative_to(folder)}
        write_facts(folder / MANIFEST_FILE, manifest | {"files": sorted({*listed_files(manifest), *new})})
