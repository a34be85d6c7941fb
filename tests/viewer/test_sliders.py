"""Sliders of the page: numbers that change while a simulation runs."""

import numpy as np
import pytest

from ocean_sim import runtime
from ocean_sim.viewer.sliders import Slider, sliders_of


def kernels():
    """Number of kernels compiled so far."""
    return sum(len(kernel.compiled_kernels) for kernel in runtime.impl.get_runtime().kernels)


def test_a_slider_applies_a_move_once_and_holds_it_within_its_ends():
    taken = []
    slider = Slider("k", 0.1, 0.0, 2.0, taken.append)
    assert not slider.move(float(np.float32(0.1)))  # a window knows single precision only
    assert slider.move(1.5) and slider.move(9.0) and not slider.move(2.0)
    assert taken == [1.5, 2.0] and slider.value == 2.0


def test_moving_any_slider_changes_the_next_step_and_compiles_nothing(coarse):
    """From one state: the same step twice gives the same bytes; after a slider has moved it does not."""
    fluid = coarse.fluid
    kept = [field.to_numpy().copy() for field in (fluid.particles.position, fluid.particles.velocity)]

    def stepped():
        fluid.particles.position.from_numpy(kept[0])
        fluid.particles.velocity.from_numpy(kept[1])
        fluid.begin()
        fluid.advance(0.002)
        order = np.argsort(fluid.particles.id.to_numpy())
        return fluid.particles.velocity.to_numpy()[order]

    names = fluid.particles.id.to_numpy().copy()

    def from_start():
        fluid.particles.id.from_numpy(names)
        return stepped()

    coarse.wind.strengthen(1.0)  # its clock begins anew, as when its slider moves: that rounds where its volumes are
    first, compiled = from_start(), None
    np.testing.assert_array_equal(from_start(), first)
    compiled, changed = kernels(), {}
    for slider in sliders_of(coarse):
        given, before_dt = slider.value, coarse.next_dt
        assert slider.move(1.5 * given)
        changed[slider.label] = not np.array_equal(from_start(), first) or coarse.next_dt != before_dt
        slider.move(given)
    assert changed == dict.fromkeys(changed, True) and len(changed) == 4
    assert kernels() == compiled
    np.testing.assert_array_equal(from_start(), first)


def test_a_moved_stiffness_is_that_of_the_equation_of_state(coarse):
    fluid, stiffness = coarse.fluid, coarse.fluid.stiffness
    fluid.adjust(stiffness=2.0 * stiffness)
    fluid.advance(1e-6)
    density, pressure = fluid.particles.density.to_numpy(), fluid.particles.pressure.to_numpy()
    fluid.adjust(stiffness=stiffness)
    np.testing.assert_allclose(pressure, np.maximum(2.0 * stiffness * (density - 1000.0), 0.0), rtol=1e-9, atol=1e-6)
    assert pressure.max() > 0.0 and fluid.sound_speed == pytest.approx(np.sqrt(stiffness))
