"""Uniform flow down a rough channel of slope S, driven by g S along it: the stress of the bed, and the speed.

In the steady state the bed bears the weight along the slope, tau = rho g S h, whatever its law: u* = sqrt(g S h). The law
tells how fast the water then is next to it, at the height z1 = spacing / 2 of the lowest particles:

    u(z1) = u* / kappa ln(z1 / z0),   z0 = k_s / 30.

The water is laminar, with a constant viscosity and no stress on its surface, so that its profile is the parabola

    u(z) = u(z1) + g S / nu (h (z - z1) - (z^2 - z1^2) / 2),

or u_b + g S / nu (h z - z^2 / 2) with u_b its value at the bed: a mean speed U = u_b + g S h^2 / (3 nu), of which u_b is
95 %. The run starts from 0.8 of it. As the bed's stress rises with the square of the speed, U(t) = U tanh(t / T +
artanh 0.8) with T = U / (g S), but for the change in shape of the profile, which is faster: h^2 / nu.

The bed's stress is not asked of the water: it is what its momentum lacks, rho g S h less its gain.
"""
