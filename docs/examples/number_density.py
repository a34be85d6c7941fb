"""The smallest law of pairs: particles per volume around each particle [1/m3], the sum of W over its neighbours."""

from ocean_sim.columns import Columns
from ocean_sim.fluid.sph.law import Law
from ocean_sim.fluid.sph.sph import Sph
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import in_kernels


@in_kernels
class NumberDensity(Law):
    """Law of pairs: the sum of the poly6 kernel over neighbouring particles and mirror images."""

    terms = Columns(count=1)

    def __init__(self, fluid: Sph) -> None:
        self.fluid, self.reads = fluid, tuple(fluid.particles.position)
        self.found = ti.field(float, shape=fluid.particles.n)  # [1/m3], in storage order

    @ti.func
    def prefactor(self, own):
        return self.fluid.smoothing.poly6_constant

    @ti.func
    def pair(self, own, other):
        x_ij = own - other
        return ti.Vector([self.fluid.smoothing.shape_poly6(x_ij.dot(x_ij))])

    @ti.func
    def finish(self, i, own, total, beyond, group):
        self.found[i] = self.prefactor(own) * total[self.terms.count]

    @ti.kernel
    def find(self):
        """Compute the sum for all particles, over the candidate neighbours that the last step listed."""
        self.fluid.neighbours.walk(self, False)
