"""Test of whether GGUI can draw here. A window that cannot be opened may end its process, so a child process tries."""

import os
import sys
from functools import cache

from ocean_sim import kernel_library
from ocean_sim.conventions import Lacking
from ocean_sim.pictures.stage.opengl import child_prints

INSTALL_COMMAND = "apt-get install --no-install-recommends libx11-6 mesa-vulkan-drivers"
PROBE_PROGRAM = """
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import RuntimeConfig, start
start(RuntimeConfig(arch="cpu"))
window = ti.ui.Window("probe", (32, 32), show_window={show})
if {show}:
    window.get_canvas().set_background_color((0.0, 0.0, 0.0))
    window.show()
else:
    window.get_image_buffer_as_numpy()
print("drawn")
"""
SCREEN_VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY")


class VulkanMissing(Lacking):
    """This machine has no Vulkan for GGUI; the message names the packages to install."""

    def __init__(self) -> None:
        super().__init__(f"this machine has no Vulkan to draw a preview with; install it with `{INSTALL_COMMAND}`")


@cache
def draws(show: bool) -> bool:
    """True if a child process survives drawing with GGUI, in a window (`show`) or off screen; takes a second."""
    if show and sys.platform == "linux" and not any(os.environ.get(name) for name in SCREEN_VARIABLES):
        return False
    return child_prints("drawn", PROBE_PROGRAM.format(show=show))


def require(show: bool) -> None:
    """Raise VulkanMissing if GGUI cannot draw here. Raise Lacking if the kernel library has no windows, or if `show` is
    True (draw in a window) and there is no screen."""
    if kernel_library.LIBRARY_NAME != kernel_library.TAICHI:
        raise Lacking(
            f"a preview is drawn in a window of Taichi's, and {kernel_library.LIBRARY_NAME} has none; unset "
            f"{kernel_library.LIBRARY_VARIABLE}, or take `ocean-sim preview --browser`"
        )
    if not draws(show=False):
        raise VulkanMissing
    if show and not draws(show=True):
        cure = "`ocean-sim preview SCENE --frames 60 --out DIR` makes the same pictures without one"
        raise Lacking(f"there is no screen to open a window on; {cure}")
