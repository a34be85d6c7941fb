"""What is left for later when a library is imported is there once it is asked for."""

import subprocess
import sys

ASKED = """
import sys
from ocean_sim.machine import import_image_library
import_image_library()
assert "scipy.ndimage" in sys.modules
assert not {"scipy.special", "numpy.f2py", "numpy.testing", "dill"} & set(sys.modules), "imported after all"
import numpy as np
from scipy import ndimage, special
turned = ndimage.rotate(np.eye(4), 90.0, order=1)  # asks for special functions
np.testing.assert_allclose(turned, np.eye(4)[::-1], atol=1e-12)
assert np.f2py.__name__ == "numpy.f2py" and special.gamma(5.0) == 24.0
from ocean_sim.kernel_library import ti
assert "dill" not in sys.modules
from taichi.lang import _wrap_inspect
import dill
assert _wrap_inspect.dill.source is dill.source
print("done")
"""


def test_what_was_left_out_is_imported_when_it_is_asked_for():
    done = subprocess.run([sys.executable, "-c", ASKED], capture_output=True, text=True, check=False)
    assert done.stdout == "done\n", done.stderr
