"""The quadratic programme of the legs: the motion that people feel least apart from the one that was asked for.

The unknowns are control points of cubic B-splines of the six leg lengths, KNOT_INTERVAL apart. A spline stays between
its control points, its slope between their differences and its second derivative between their second differences (de
Boor 1978, A practical guide to splines, IX and X), so bounds on those keep strokes, speeds and accelerations of the
legs at all times. The programme minimises the square of the error of specific force and angular rate as the organs of
balance sense it, over their thresholds. Motion is linear in the legs about a former solution (sequential quadratic
programming; Nocedal & Wright 2006, Numerical optimization, 18). Turns that nobody asked for stay below what people
notice. The ride begins at rest.

Otoliths sense a specific force by 0.4 (10 s + 1) / ((5 s + 1) (0.016 s + 1)), semicircular canals a rate by
5.73 80 s^2 / ((5.73 s + 1) (80 s + 1)) (Telban & Cardullo 2005, NASA/CR-2005-213747). Thresholds: 0.17, 0.17 and
0.28 m/s2, and 3.0, 3.6 and 2.6 deg/s about roll, pitch and yaw (Reid & Nahon 1985, UTIAS Report 296).
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.conventions import Failed, Lacking
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod, felt_motion

KNOT_INTERVAL = 0.04  # [s]
WINDOW_TIME, KEPT_TIME = 120.0, 100.0  # [s] solved at a time, and kept of it if the ride goes on
PASSES_PER_WINDOW = 5  # each about the solution of the one before
SOLVER_TOLERANCE = 1e-5
OTOLITH_FILTER = ([4.0, 0.4], [0.08, 5.016, 1.0])  # numerator and denominator, powers of s downwards
CANAL_FILTER = ([458.4, 0.0, 0.0], [458.4, 85.73, 1.0])
SENSED_THRESHOLDS = np.concatenate([(0.17, 0.17, 0.28), np.radians([3.0, 3.6, 2.6])])  # [m/s2], [rad/s]
NOTICED_TURN_RATE = np.radians(3.0)  # [rad/s] about roll and pitch
NEUTRAL_COST = 1e-5  # of a leg 1 m from neutral at a knot, where a sensed error at its threshold costs 1
JERK_COST = 1e-5  # of a leg's jerk of 1 m/s3 at a knot: of two rides that feel the same at knots, the smoother one
DERIVATIVE_STEP = 1e-5  # [m], [rad], [1/s] and [1/s2] of both, of central differences
SPLINE_STENCILS = np.array(  # of three control points: value [1], slope [1/s] and second derivative [1/s2] at a knot
    [
        np.array([1.0, 4.0, 1.0]) / 6.0,
        np.array([-0.5, 0.0, 0.5]) / KNOT_INTERVAL,
        np.array([1.0, -2.0, 1.0]) / KNOT_INTERVAL**2,
    ]
)
REST_POINTS = 3  # control points that fix value, slope and second derivative at a knot
STOP_SHARE = 0.125  # of a plan that ends at rest: its stop is not felt, since the next plan takes over before
SOLVED_STATES = ("Solved", "AlmostSolved", "NumericalError", "InsufficientProgress")  # NumericalError: no nearer


class LegTrack(NamedTuple):
    """Motion of a platform at the knots of splines that its leg lengths follow."""

    motion: np.ndarray  # (n, 18) pose [m, rad], its rate and its second derivative in time
    by_legs: list[np.ndarray]  # derivatives (n, 6, 6) of the pose by leg lengths, and their first and second in time


@cache
def sensed_modes(every: float) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Digital filters of the organs of balance for samples `every` [s] (linear between them), from the error of each of
    six components (specific force [m/s2], rate [rad/s]) to its sensed size over the threshold of perception: as partial
    fractions, with residues (2,), poles (2,) and direct term."""
    from scipy.signal import cont2discrete, residuez

    sampled = [cont2discrete(organ, every, method="foh") for organ in (OTOLITH_FILTER, CANAL_FILTER)]
    organs = [residuez(np.ravel(numerator), denominator) for numerator, denominator, _ in sampled]
    parts = [(*organs[k // 3], threshold) for k, threshold in enumerate(SENSED_THRESHOLDS)]
    return [(r.real / scale, poles.real, float(np.sum(direct)) / scale) for r, poles, direct, scale in parts]


def sensed_error(error: np.ndarray, every: float, state: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Sensed sizes (n, 6), over thresholds of perception, of errors (n, 6) of specific force [m/s2] and rate [rad/s] at
    samples `every` [s]; and the final state (6, 2) of the filters. `state`: that before the first one, by default 0."""
    from scipy.signal import lfilter

    sizes, last = np.zeros(error.shape), np.zeros((6, 2)) if state is None else state.copy()
    for k, (residues, poles, direct) in enumerate(sensed_modes(every)):
        sizes[:, k] = direct * error[:, k]
        for m, (r, p) in enumerate(zip(residues, poles)):
            mode = lfilter([r], [1.0, -p], error[:, k], zi=[p * last[k, m]])[0]
            sizes[:, k] += mode
            last[k, m] = mode[-1]
    return sizes, last


def motion_at(rows: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Motion (k, 6) at times (k,) [s], interpolated linearly between `rows` (n, 7) of time and motion."""
    return np.column_stack([np.interp(times, rows[:, 0], column) for column in rows[:, 1:].T])


def felt_at(motion: np.ndarray) -> np.ndarray:
    """Specific force [m/s2] and rate [rad/s] (n, 6) felt in `motion` (n, 18): pose, its rate, its second derivative."""
    return np.hstack(felt_motion(motion[:, :6], motion[:, 12:15], motion[:, 9:12]))


def derivatives(law: Callable[[np.ndarray], np.ndarray], at: np.ndarray) -> np.ndarray:
    """Derivatives (n, k, m), by central differences, of a function `law` of rows `at` (n, m) with values (n, k)."""
    steps = DERIVATIVE_STEP * np.eye(at.shape[1])
    return np.stack([(law(at + step) - law(at - step)) / (2.0 * DERIVATIVE_STEP) for step in steps], axis=2)


def spline_matrices(n: int) -> list[Any]:
    """Three sparse (n, n + 2) matrices from control points to value, slope and second derivative at n knots."""
    from scipy.sparse import diags_array

    return [diags_array(stencil, offsets=[0, 1, 2], shape=(n, n + 2), format="csr") for stencil in SPLINE_STENCILS]


def spline_values(points: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values (k, 6) of splines with control points (n + 2, 6) at `at` (k,), counted in knots from the first."""
    knot = np.clip(at.astype(int), 0, len(points) - 4)
    u = (at - knot)[:, None]
    weights = (1.0 - u) ** 3, 3.0 * u**3 - 6.0 * u**2 + 4.0, -3.0 * u**3 + 3.0 * u**2 + 3.0 * u + 1.0, u**3
    return sum(weight * points[knot + k] for k, weight in enumerate(weights)) / 6.0


def leg_track(hexapod: Hexapod, points: np.ndarray, guess: np.ndarray) -> LegTrack:
    """Motion at n knots of leg-length splines with control points (n + 2, 6) [m]; `guess` (n, 6): poses close to it."""
    lengths, speeds, accelerations = (matrix @ points for matrix in spline_matrices(len(points) - 2))
    pose = hexapod.pose(lengths, guess)
    by_length = np.linalg.inv(hexapod.pose_jacobian(pose))
    drift = np.gradient(by_length, KNOT_INTERVAL, axis=0)
    velocity = (by_length @ speeds[:, :, None])[:, :, 0]
    acceleration = (by_length @ accelerations[:, :, None] + drift @ speeds[:, :, None])[:, :, 0]
    rates = [by_length, drift, np.gradient(drift, KNOT_INTERVAL, axis=0)]
    return LegTrack(np.hstack([pose, velocity, acceleration]), rates)


def felt_by_points(track: LegTrack) -> list[Any]:
    """Derivatives of felt motion at n knots by the control points of the leg-length splines, leg after leg: for each of
    six components (specific force [m/s2], then rate [rad/s]) a sparse matrix (n, 6 (n + 2)) [per m]."""
    from scipy.sparse import csr_array

    of_pose, of_rate, of_second = np.split(derivatives(felt_at, track.motion), 3, axis=2)
    pose, drift, bend = track.by_legs
    shares = (
        of_pose @ pose + of_rate @ drift + of_second @ bend,
        of_rate @ pose + 2.0 * of_second @ drift,
        of_second @ pose,
    )  # of lengths, speeds and accelerations of the legs
    values, n = np.einsum("snkj,sp->knjp", np.stack(shares), SPLINE_STENCILS), len(pose)
    points = np.arange(n)[:, None, None] + (n + 2) * np.arange(6)[:, None] + np.arange(3)  # (n, 6, 3)
    starts = points[0].size * np.arange(n + 1)
    return [csr_array((part.ravel(), points.ravel(), starts), shape=(n, 6 * (n + 2))) for part in values]


def load_solver() -> Any:
    """Module of Clarabel, the solver of quadratic programmes; raises Lacking where it is not installed."""
    try:
        import clarabel
    except ImportError:
        raise Lacking("planned rides need Clarabel: pip install 'ocean-sim[ride]'") from None
    return clarabel


def solve_programme(
    geometry: Geometry,
    hexapod: Hexapod,
    asked: np.ndarray,
    past: np.ndarray,
    guess: np.ndarray,
    state: np.ndarray,
    stops: bool,
) -> np.ndarray:
    """Control points (n + 2, 6) [m] of six leg-length splines, best for the motion `asked` for (n, 6) at n knots.

    Motion (specific force [m/s2] and rate [rad/s]) is linearised about an earlier solution `past` (n + 2, 6), whose
    first REST_POINTS are kept. `guess` (n, 6): poses near it; `state` (6, 2): before the first knot, of the two modes
    that filter each component (`sensed_modes`); `stops`: the ride ends at rest, and STOP_SHARE of it is not felt.
    Raises Lacking, and Failed without a solution."""
    clarabel = load_solver()
    from scipy.sparse import block_array, block_diag, diags_array, eye_array, kron

    n = len(asked)
    m, one = n + 2, eye_array(n)
    track = leg_track(hexapod, past, guess)
    felt_by, neutral = felt_by_points(track), hexapod.neutral_legs
    past_error = felt_at(track.motion) - asked
    offset = past_error - np.column_stack([by @ (past - neutral).T.ravel() for by in felt_by])
    # Blocks of unknowns: 0 control points from neutral; per component its two modes and its sensed size. Errors are no
    # unknowns: with them the factors of the solver would have seven times the work.
    rows: list[tuple[dict[int, Any], np.ndarray]] = []
    for k, (residues, poles, direct) in enumerate(sensed_modes(KNOT_INTERVAL)):
        slow, fast, size = range(1 + 3 * k, 4 + 3 * k)
        for mode, r, p, begin in zip((slow, fast), residues, poles, state[k]):
            decay = diags_array([1.0, -p], offsets=[0, -1], shape=(n, n))
            rows.append(({0: -r * felt_by[k], mode: decay}, r * offset[:, k] + np.pad([p * begin], (0, n - 1))))
        rows.append(({0: -direct * felt_by[k], slow: -one, fast: -one, size: one}, direct * offset[:, k]))
    legs, unit = eye_array(6), eye_array(m, format="csr")
    rows.append(({0: kron(legs, unit[:REST_POINTS])}, (past - neutral)[:REST_POINTS].T.ravel()))
    if stops:
        rows.append(({0: kron(legs, unit[1 - REST_POINTS :] - unit[-REST_POINTS:-1])}, np.zeros(6 * REST_POINTS - 6)))
    equal = sum(len(right) for _, right in rows)
    free = kron(legs, unit[REST_POINTS:])
    room = np.column_stack([hexapod.high - neutral, neutral - hexapod.low])
    step = kron(legs, diags_array([-1.0, 1.0], offsets=[0, 1], shape=(m - 1, m)) / KNOT_INTERVAL)
    turn = kron(legs, diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(m - 2, m)) / KNOT_INTERVAL**2)
    for sign in (1.0, -1.0):
        rows.append(({0: sign * free}, np.repeat(room[:, 0 if sign > 0.0 else 1], m - REST_POINTS)))
        rows.append(({0: sign * step}, np.full(step.shape[0], geometry.leg_speed)))
        rows.append(({0: sign * turn}, np.full(turn.shape[0], geometry.leg_acceleration)))
        for k in (3, 4):  # what the past does is allowed, so that there always is a solution
            most = np.maximum(np.abs(asked[:, k]), np.abs(past_error[:, k]))
            rows.append(({0: sign * felt_by[k]}, np.maximum(NOTICED_TURN_RATE, most) - sign * offset[:, k]))
    matrix = block_array([[blocks.get(k) for k in range(19)] for blocks, _ in rows], format="csc")
    jerk = kron(legs, diags_array([-1.0, 3.0, -3.0, 1.0], offsets=[0, 1, 2, 3], shape=(m - 3, m)) / KNOT_INTERVAL**3)
    calm = NEUTRAL_COST * eye_array(6 * m) + JERK_COST * (jerk.T @ jerk)
    felt_knots = n - round(STOP_SHARE * n) if stops else n
    costs = [calm, *6 * [diags_array(np.repeat([0.0, 1.0, 0.0], [2 * n, felt_knots, n - felt_knots]))]]
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.direct_solve_method = False, "qdldl"  # which is one thread, and the faster here
    settings.iterative_refinement_enable = False  # no plan is better for it, and each takes twice the time
    settings.tol_feas = settings.tol_gap_abs = settings.tol_gap_rel = SOLVER_TOLERANCE
    right = np.concatenate([right for _, right in rows])
    cones = [clarabel.ZeroConeT(equal), clarabel.NonnegativeConeT(len(right) - equal)]
    cost = block_diag(costs, format="csc")
    answer = clarabel.DefaultSolver(cost, np.zeros(cost.shape[0]), matrix, right, cones, settings).solve()
    if str(answer.status) not in SOLVED_STATES:
        raise Failed(f"no motion of the platform was found within its limits ({answer.status})")
    return np.array(answer.x[: 6 * m]).reshape(6, m).T + neutral


class LegPlan:
    """Plan of leg lengths over the time ahead: splines with knots KNOT_INTERVAL apart, which begin in neutral."""

    def __init__(self, geometry: Geometry, hexapod: Hexapod, stops: bool = False) -> None:
        """`stops`: the plan ends at rest, and its stop is not felt (STOP_SHARE)."""
        self.geometry, self.hexapod, self.stops = geometry, hexapod, stops
        self.points = hexapod.neutral_legs[None]  # control points (n + 2, 6) [m]
        self.motion = np.zeros((1, 18))  # at n knots, as in LegTrack
        self.state = np.zeros((6, 2))  # of the organs before the first knot

    def improve(self, asked: np.ndarray, passes: int) -> None:
        """Plan `points` for the specific force and rate `asked` for at knots (n, 6): `solve_programme` once for each of
        the `passes`, about the solution before. Raises Lacking, and Failed without a plan."""
        self.points, self.motion = extended(self.points, len(asked) + 2), extended(self.motion, len(asked))
        for _ in range(passes):
            guess = self.motion[:, :6]
            self.points = solve_programme(
                self.geometry, self.hexapod, asked, self.points, guess, self.state, self.stops
            )
            self.motion = leg_track(self.hexapod, self.points, guess).motion

    def leave(self, asked: np.ndarray) -> None:
        """Drop the first k knots of the plan, which are past, and advance the filters of the senses (`state`) over
        them, by felt motion less motion `asked` for (k, 6): specific force [m/s2] and rate [rad/s]."""
        k = len(asked)
        n = len(self.motion) + k  # a plan that is too short stays at rest
        self.points, self.motion = extended(self.points, n + 2), extended(self.motion, n)
        self.state = sensed_error(felt_at(self.motion[:k]) - asked, KNOT_INTERVAL, self.state)[1]
        self.points, self.motion = self.points[k:], self.motion[k:]

    def poses(self, at: np.ndarray) -> np.ndarray:
        """Planned poses (k, 6) at positions `at` (k,), counted in knots from the first."""
        guess = self.motion[np.minimum(at.astype(int), len(self.motion) - 1), :6]
        return self.hexapod.pose(spline_values(self.points, at), guess)


def extended(rows: np.ndarray, count: int) -> np.ndarray:
    """The first `count` rows; if there are fewer, the last one is repeated."""
    return rows[np.minimum(np.arange(count), len(rows) - 1)]


def best_poses(geometry: Geometry, hexapod: Hexapod, rows: np.ndarray) -> np.ndarray:
    """Poses (n, 6) of the ride from neutral whose error is sensed least, for `rows` (n, 7): time [s], specific force
    [m/s2] and rate [rad/s] asked for, platform axes. Raises Lacking, and Failed where there is none."""
    window, kept = round(WINDOW_TIME / KNOT_INTERVAL), round(KEPT_TIME / KNOT_INTERVAL)
    at = (rows[:, 0] - rows[0, 0]) / KNOT_INTERVAL
    asked = motion_at(rows, rows[0, 0] + KNOT_INTERVAL * np.arange(int(at[-1]) + 2))
    plan, poses = LegPlan(geometry, hexapod), np.empty((len(rows), 6))
    for first in range(0, max(1, len(asked) - window + kept), kept):
        part = asked[first : first + window]
        plan.improve(part, PASSES_PER_WINDOW)
        here = (at >= first) & (at < first + len(part))  # a later window has the last word
        poses[here] = plan.poses(at[here] - first)
        plan.leave(part[:kept])
    return poses
