"""Figure 4-2: a ball that floats among particles: which of them meet it, the impulses that part them, and what these
cost: CSV and PNG.

The thesis says that the impulse is found by solving the collision equation (4.2) and prints none; this is Newton's law
with restitution and Coulomb's friction, with the numbers of its listing (5.1.1). One by one, from the velocities
before, n particles push a body n times; solved together, without friction, once. Either way the coefficient by which
the listing halves what the body feels makes momentum, and energy.

python figures/fig4_2.py [--fast] [--out DIR]
"""

from pathlib import Path

import numpy as np
from _options import options
from _paper import BLUE, GREEN, GREY, INK, ORANGE, PALE, RED, SKY, paper, save_figure, save_table

from ocean_sim.ship.body.rigid_body import cross

SPACING, RADIUS = 1.25, 4.0  # [m]
CENTRE = np.array([0.0, -0.9, 0.0])  # of the ball [m]
REACH = 0.2  # of the support, within which a particle touches: `collisionDistanceMultiplier`
SUPPORT = 2.5  # [m]
MASS, DENSITY = 1000.0 * SPACING**3, 500.0  # of a particle [kg]; of the ball [kg/m3]
RESTITUTION, FRICTION = 0.5, 0.5  # for dynamic shapes
FALLS = np.array([0.4, -2.0, 0.0])  # velocity of the ball [m/s]
RESPONSES = np.linspace(0.0, 1.0, 21)


def impulse(
    arm: np.ndarray, normal: np.ndarray, approach: np.ndarray, mass: float, body: float, inertia: np.ndarray
) -> np.ndarray:
    """Impulse (3,) [N s] on a particle of `mass` [kg] that hits a body at `arm` (3,) [m] from its centre: restitution
    along the outward `normal`, friction across; zero if they separate. `approach`: velocity relative to the body's
    surface [m/s]; `body`: its mass [kg]; `inertia` (3, 3) [kg m2]."""
    towards = float(approach @ normal)
    if towards >= 0.0:
        return np.zeros(3)
    push = -(1.0 + RESTITUTION) * towards / softness(arm, normal, mass, body, inertia)
    sliding = approach - towards * normal
    speed = float(np.linalg.norm(sliding))
    if speed == 0.0:
        return push * normal
    along = sliding / speed
    stop = speed / softness(arm, along, mass, body, inertia)
    return push * normal - min(FRICTION * push, stop) * along


def softness(arm: np.ndarray, way: np.ndarray, mass: float, body: float, inertia: np.ndarray) -> float:
    """Change of relative velocity along a unit vector `way`, at the point of contact, for a unit impulse [1/kg]."""
    turned = np.linalg.solve(inertia, cross(arm, way))
    return 1.0 / mass + 1.0 / body + float(way @ cross(turned, arm))


def lattice() -> tuple[np.ndarray, np.ndarray]:
    """Particles (n, 3) in horizontal layers, and (n,) true for those in contact with the ball; those inside it lie on
    its skin."""
    along, down = np.arange(-8.0, 8.1) * SPACING, -np.arange(0.5, 7.0) * SPACING
    places = np.stack([grid.ravel() for grid in np.meshgrid(along, down, along)], axis=1)
    distance = np.linalg.norm(places - CENTRE, axis=1)
    places, distance = (values[distance > RADIUS - REACH * SUPPORT] for values in (places, distance))
    out = np.maximum(RADIUS / distance, 1.0)[:, None]
    return CENTRE + (places - CENTRE) * out, distance < RADIUS + REACH * SUPPORT


def one_by_one(rows: list[tuple], response: float, body: float, inertia: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Ball after it takes the share `response` of every impulse, and each particle its own whole: its velocity [m/s],
    change of momentum [N s] and loss of energy [J] of ball and particles together; `body`: mass of the ball [kg]."""
    total = -response * sum(row[3] for row in rows)
    spin = -response * np.linalg.solve(inertia, sum(cross(row[1], row[3]) for row in rows))
    velocity = FALLS + total / body
    momentum = body * (velocity - FALLS) + sum(row[3] for row in rows)
    energy = 0.5 * body * float(FALLS @ FALLS - velocity @ velocity) - 0.5 * float(spin @ inertia @ spin)
    energy -= sum(0.5 * float(row[3] @ row[3]) / MASS for row in rows)
    return velocity, float(np.linalg.norm(momentum)), energy


def all_at_once(rows: list[tuple], response: float, body: float, inertia: np.ndarray) -> tuple[float, float, float]:
    """Ball after collisions solved at once, without friction: particles in contact leave the moving skin with the
    restitution. Return vertical velocity [m/s], change of momentum [N s] and loss of energy [J], as `one_by_one`."""
    normals = np.array([row[2] for row in rows])
    ways = np.hstack([normals, np.cross([row[1] for row in rows], normals)])  # (n, 6) of the ball's motions
    before, masses = np.concatenate([FALLS, np.zeros(3)]), np.zeros((6, 6))
    masses[:3, :3], masses[3:, 3:] = body * np.eye(3), inertia
    closing = -ways @ before
    pushing = closing < 0.0
    while True:
        some, speed = ways[pushing], closing[pushing]
        wanted = MASS * (1.0 + RESTITUTION) * some.T @ speed
        change = np.linalg.solve(masses + response * MASS * some.T @ some, response * wanted)
        push = MASS * (some @ change - (1.0 + RESTITUTION) * speed)
        if (push >= 0.0).all():
            break
        pushing[np.flatnonzero(pushing)[push < 0.0]] = False
    after = before + change
    made = masses[:3, :3] @ change[:3] + push @ normals[pushing]
    energy = 0.5 * float(before @ masses @ before - after @ masses @ after) - 0.5 * float(push @ push) / MASS
    return float(after[1]), float(np.linalg.norm(made)), energy


def draw_figure(places: np.ndarray, rows: list[tuple], course: list[tuple], path: Path) -> None:
    """Draw the middle layer of particles with its impulses, and the effect of the response coefficient."""
    from matplotlib.patches import Circle, Wedge

    figure = paper(12.5, 5.4)
    grid = figure.add_gridspec(3, 2, width_ratios=(1.7, 1.0))
    left = figure.add_subplot(grid[:, 0])
    (x, y, _), shell = CENTRE, RADIUS + REACH * SUPPORT
    left.add_patch(Wedge((x, y), shell, 0.0, 360.0, width=shell - RADIUS, color=PALE, lw=0))
    left.add_patch(Circle((x, y), RADIUS, facecolor="#f3ead8", edgecolor=INK, lw=1.5))
    left.axhline(0.0, color=BLUE, lw=1.0, ls=":", zorder=0)
    meeting = [row[0] for row in rows]
    middle = np.abs(places[:, 2]) < 0.25 * SPACING
    others = middle.copy()
    others[meeting] = False
    left.plot(*places[others, :2].T, "o", color=SKY, ms=6, label="other particles")
    left.plot(*places[[k for k in meeting if middle[k]], :2].T, "o", color=ORANGE, ms=7, mec=INK, mew=0.6, label="met")
    size = max(float(np.linalg.norm(row[3])) for row in rows)
    for k, _, _, push in rows:
        if middle[k] and push.any():
            end = places[k] + 2.4 * push / size
            left.annotate("", end[:2], places[k, :2], arrowprops={"arrowstyle": "-|>", "color": RED, "lw": 1.6})
    total = -sum(row[3] for row in rows)
    for way, colour, text in ((FALLS / 2.0, INK, "velocity before"), (total / np.linalg.norm(total), RED, "sum on it")):
        tip = CENTRE + 2.2 * way
        left.annotate("", tip[:2], CENTRE[:2], arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 2.2})
        left.text(tip[0] - 0.3, tip[1], text, color=colour, fontsize=9, va="center", ha="right")
    left.set(aspect="equal", xlim=(-10.0, 10.0), ylim=(-8.2, 4.6), xlabel="x [m]", ylabel="y [m]")
    left.set_title(f"impulses on {len(rows)} particles of all layers (the longest {size / 1e3:.2g} kN s)")
    left.legend(loc="upper right")
    columns = np.array(course).T
    series = (
        ("velocity upwards\n[m/s]", 1.0, BLUE),
        ("momentum made\n[kN s]", 1e3, RED),
        ("energy lost\n(< 0: made) [kJ]", 1e3, GREEN),
    )
    for k, (label, unit, colour) in enumerate(series):
        axes = figure.add_subplot(grid[k, 1])
        axes.plot(columns[0], columns[k + 1] / unit, color=colour, lw=2.0, label="one by one")
        axes.plot(columns[0], columns[k + 4] / unit, color=colour, lw=2.0, ls="--", label="solved together")
        axes.axvline(0.5, color=GREY, lw=1.0, ls=":")
        axes.set(ylabel=label, xlim=(0, 1))
        axes.axhline(0.0, color=INK, lw=0.8)
        axes.grid(color=PALE, lw=0.7)
        axes.legend(loc="best")
        if k == 0:
            axes.set_title("the ball after it, and what both have gained or lost")
            axes.text(0.51, columns[1].min(), "the listing's 0.5", color=GREY, fontsize=9, va="bottom")
    axes.set_xlabel("part of the impulses that the ball takes")
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    places, met = lattice()
    body = DENSITY * 4.0 / 3.0 * np.pi * RADIUS**3
    inertia = 0.4 * body * RADIUS**2 * np.eye(3)
    rows = []
    for k in np.flatnonzero(met):
        normal = (places[k] - CENTRE) / np.linalg.norm(places[k] - CENTRE)
        push = impulse(RADIUS * normal, normal, -FALLS, MASS, body, inertia)
        rows.append((int(k), RADIUS * normal, normal, push))
    course = []
    for response in RESPONSES:
        velocity, momentum, energy = one_by_one(rows, float(response), body, inertia)
        at_once = all_at_once(rows, float(response), body, inertia)
        course.append((float(response), float(velocity[1]), momentum, energy, *at_once))
    head = [f"a ball of {body:.6g} kg at ({FALLS[0]:g}, {FALLS[1]:g}, 0) m/s among particles of {MASS:.6g} kg at rest"]
    head += [f"restitution {RESTITUTION:g}, friction {FRICTION:g}; each pair by itself, from the velocities before"]
    columns = [
        f"{name}_{axis}{unit}" for name, unit in (("at", "_m"), ("normal", ""), ("impulse", "_Ns")) for axis in "xyz"
    ]
    save_table(out / "fig4_2.csv", head, columns, [(*places[k], *normal, *push) for k, _, normal, push in rows])
    head = ["the ball after the impulses, by the part of them that it takes, and what both have gained or lost"]
    columns = ["response", "ball_y_m_s", "momentum_made_Ns", "energy_lost_J"]
    columns += [f"together_{name}" for name in columns[1:]]
    save_table(out / "fig4_2_response.csv", head, columns, course)
    draw_figure(places, rows, course, out / "fig4_2.png")


if __name__ == "__main__":
    main()
