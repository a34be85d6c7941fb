"""The cubic between the values of a lattice (Keys 1981, IEEE Trans. ASSP 29), for kernels."""

from ocean_sim.kernel_library import ti, tm


@ti.func
def cubic(s):
    """Weights of the four values around a share s of the way from the second to the third."""
    return tm.vec4(
        0.5 * s * (-1.0 + s * (2.0 - s)),
        0.5 * (2.0 + s * s * (3.0 * s - 5.0)),
        0.5 * s * (1.0 + s * (4.0 - 3.0 * s)),
        0.5 * s * s * (s - 1.0),
    )
