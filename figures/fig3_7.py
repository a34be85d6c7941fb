"""Figure 3-7: what happens to light that meets the sea, and how much of it is reflected: exact, as printed, by the
listing and by Schlick: CSV and PNG.

python figures/fig3_7.py [--fast] [--out DIR]
"""

from pathlib import Path

import numpy as np
from _options import options
from _paper import BLUE, GREY, INK, ORANGE, PALE, RED, paper, save_figure, save_table

from ocean_sim.pictures.water.water_shading import REFRACTIVE_INDEX, fresnel

MARKED = (0.0, 45.0, 60.0, 80.0)  # [deg]


def refraction_angle(incident: np.ndarray, n: float = REFRACTIVE_INDEX) -> np.ndarray:
    """Angle of refraction [rad] in water of refractive index `n`, by (3.7)."""
    return np.arcsin(np.sin(incident) / n)


def printed_rule(incident: np.ndarray) -> np.ndarray:
    """Reflectance by (3.8) as printed: 0 / 0 at normal incidence."""
    below = refraction_angle(incident)
    less, more = below - incident, below + incident
    with np.errstate(invalid="ignore"):
        return 0.5 * ((np.sin(less) / np.sin(more)) ** 2 + (np.tan(less) / np.tan(more)) ** 2)


def listing_rule(incident: np.ndarray) -> np.ndarray:
    """Reflectance by the shader of section 5.2.3: (3.8) plus 0.02, clamped to 0 and 1."""
    return np.clip(0.02 + printed_rule(incident), 0.0, 1.0)


def schlick_rule(incident: np.ndarray, n: float = REFRACTIVE_INDEX) -> np.ndarray:
    """Reflectance by Schlick's approximation R0 + (1 - R0) (1 - cos)^5 (1994, Computer Graphics Forum 13)."""
    least = ((n - 1.0) / (n + 1.0)) ** 2
    return least + (1.0 - least) * (1.0 - np.cos(incident)) ** 5


def draw_figure(degrees: np.ndarray, path: Path) -> None:
    """Draw both angles, and reflectance on a logarithmic scale, as most of the sea is seen at a grazing angle."""
    incident = np.radians(degrees)
    below = np.degrees(refraction_angle(incident))
    figure = paper(11.0, 4.6)
    left, right = figure.subplots(1, 2)
    left.plot(degrees, below, color=BLUE, lw=2.0)
    left.axhline(below[-1], color=GREY, ls="--", lw=1.0)
    left.text(2.0, below[-1] + 1.0, f"limit {below[-1]:.2f}° (the thesis prints 48.59°)", color=GREY, fontsize=9)
    left.plot(degrees, degrees, color=GREY, ls=":", lw=1.0)
    left.text(
        33.0, 34.5, "without refraction", color=GREY, fontsize=9, rotation=52, ha="center", rotation_mode="anchor"
    )
    left.set(xlabel="angle of incidence [°]", ylabel="transmitted angle [°]", title="(3.7), n = 1.333")
    left.set(xlim=(0, 90), ylim=(0, 60), xticks=range(0, 91, 15))
    right.plot(degrees, fresnel(np.cos(incident)), color=BLUE, lw=2.5, label="exact, in cosines; (3.8) from 1° on")
    right.plot(degrees, listing_rule(incident), color=RED, lw=1.5, ls="--", label="the listing: 0.02 added")
    right.plot(degrees, schlick_rule(incident), color=ORANGE, lw=1.5, ls="-.", label="Schlick 1994")
    for angle in MARKED:
        value = float(fresnel(np.cos(np.radians(angle))))
        right.plot(angle, value, "o", color=INK, ms=4, clip_on=False, zorder=5)
        shift = (-44, 5) if angle == 45.0 else (4, -13)
        right.annotate(f"{value:.4f}", (angle, value), shift, textcoords="offset points", fontsize=9, color=INK)
    right.set(
        xlabel="angle of incidence [°]", ylabel="reflectance", title="share of unpolarised light that is mirrored"
    )
    right.set(xlim=(0, 90), ylim=(0.012, 1.1), yscale="log", xticks=range(0, 91, 15))
    right.set_yticks([0.02, 0.05, 0.1, 0.2, 0.5, 1.0], ["0.02", "0.05", "0.1", "0.2", "0.5", "1"])
    right.minorticks_off()
    right.legend(loc="upper left")
    for axes in (left, right):
        axes.grid(color=PALE, lw=0.7)
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    degrees = np.linspace(0.0, 90.0, 181)
    incident = np.radians(degrees)
    rules = printed_rule(incident), listing_rule(incident), schlick_rule(incident)
    curves = refraction_angle(incident), fresnel(np.cos(incident)), *rules
    head = [f"light from air onto water, refractive index {REFRACTIVE_INDEX:g}; unpolarised"]
    head += ["thesis_3_8: as printed, which is no number at 0; listing: 0.02 added and clamped to 0 and 1"]
    columns = ["incident_deg", "transmitted_deg", "reflectance", "thesis_3_8", "listing", "schlick"]
    rows = zip(degrees.tolist(), np.degrees(curves[0]).tolist(), *(curve.tolist() for curve in curves[1:]))
    save_table(out / "fig3_7.csv", head, columns, rows)
    draw_figure(degrees, out / "fig3_7.png")


if __name__ == "__main__":
    main()
