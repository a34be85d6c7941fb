"""What the laws have in common that push particles: solid bodies are pushed back by them."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

from ocean_sim.columns import Columns
from ocean_sim.fluid.shared.law import NONE
from ocean_sim.fluid.shared.sph import Sph
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import in_kernels

if TYPE_CHECKING:  # it is imported only where there are bodies
    from ocean_sim.fluid.shared.boundary import Boundary, Reaction, SampleSum


@in_kernels
class Force(ABC):
    """A law that pushes particles and, as strongly, the samples of solid bodies: it has `sample` and `acceleration`."""

    padded: ClassVar[bool] = True
    tension: ClassVar[int] = NONE
    row: Columns
    reads: tuple[ti.Field, ...]
    told: tuple[ti.Field, ...]
    terms: Columns
    boundary: "Boundary"
    solid: "SampleSum"
    reaction: "Reaction"

    def __init__(self, fluid: Sph) -> None:
        """To be called once `terms` are known."""
        self.fluid = fluid
        self.apart = fluid.accounts.impulses  # what images add is summed apart
        self.told = self.reads
        if fluid.boundary is not None:
            self.boundary = fluid.boundary
            self.solid, self.reaction = fluid.boundary.summed(self), fluid.boundary.reaction(self)

    @ti.func
    def begin(self, group):
        self.fluid.accounts.begin_motion(group)

    @ti.func
    def react(self, dt):
        """Push the bodies for dt [s]; call it at the top of a kernel."""
        if ti.static(self.fluid.bodies):
            self.boundary.react(self.reaction, dt)

    @abstractmethod
    def sample(self, own: Any, s: Any, d: Any, mirror: Any) -> Any:
        """As `SampledLaw` has it."""

    @abstractmethod
    def pair(self, own: Any, other: Any) -> Any:
        """As `SampledLaw` has it."""

    @abstractmethod
    def acceleration(self, own: Any, total: Any) -> Any:
        """As `PushingLaw` has it."""

    @abstractmethod
    def worked(self, own: Any, total: Any) -> Any:
        """As `PushingLaw` has it."""
