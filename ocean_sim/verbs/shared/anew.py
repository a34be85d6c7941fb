"""A process that begins anew: with the library that a scene asks for, where it computes with another."""

import os
import sys

from ocean_sim.conventions import Lacking
from ocean_sim.machine import installed_version


class Anew(BaseException):
    """Passes through all that handles errors: nothing has been done yet, and the process begins anew."""

    def __init__(self, library: str) -> None:
        super().__init__(library)
        self.library = library

    def begin(self, arguments: list[str]) -> None:
        """Run the command line again in this process, with the other library; does not return."""
        from ocean_sim import kernel_library

        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        environment = os.environ | {kernel_library.LIBRARY_VARIABLE: self.library}
        os.execve(sys.executable, [sys.executable, "-m", "ocean_sim", *arguments], environment)


def must_compute_with(
    library: str | None, asked: str = "runtime.library", cure: str = ", or leave the key out"
) -> None:
    """Raises Anew where this process computes with another library and nobody has chosen that one for it, Lacking where
    the one that is `asked` for there is not installed. For the command line, before anything is written."""
    from ocean_sim import kernel_library

    if library in (None, kernel_library.LIBRARY_NAME) or kernel_library.LIBRARY_VARIABLE in os.environ:
        return
    if installed_version(library) is None:
        raise Lacking(f"{asked}: {library} is not installed here; pip install {library}{cure}")
    raise Anew(library)
