"""Motion of a ship in the near future, guessed from her motion so far: held, or by a linear law fitted to it.

In waves the best linear prediction is an autoregression (Yumori 1981, Real time prediction of ship response to ocean
waves using time series analysis, OCEANS 81). Each of six channels, over its standard deviation, is fitted as a sum of
the last LAW_ORDER values of all six; before the ride all were 0. Motion that was asked for is meant throughout.
"""

import numpy as np

from ocean_sim.platform.shared.leg_programme import KNOT_INTERVAL
from ocean_sim.platform.shared.washing import rest_force

HOLD_TIME = 0.6  # [s] in which what is held dies away
LAW_STEP, LAW_ORDER = 5, 10  # knots between values of the law, and how many it takes
FITTED_TIME = 60.0  # [s] of a ride, up to now, to which the law is fitted
OWN_PENALTY, CROSS_PENALTY = 0.3, 30.0  # of squared coefficients of a channel's own last value, and of others'
LEAST_DEVIATION = 1e-3  # [m/s2], [rad], [rad/s]: less is no motion
LONGEST_DECAY = 60.0  # [s] of what is predicted


def held_motion(rows: np.ndarray, count: int) -> np.ndarray:
    """Motion (count, 6), specific force [m/s2] and rate [rad/s], at the knots after the last of `rows` (n, 10): time,
    motion and attitude. Acceleration and rate of the last row die away, and the rate turns the body meanwhile."""
    _, force, rate, attitude = np.split(rows[-1], [1, 4, 7])
    left = np.exp(-KNOT_INTERVAL / HOLD_TIME * np.arange(1, count + 1))[:, None]
    rest = rest_force(np.vstack([attitude, attitude + HOLD_TIME * (1.0 - left) * rate]))
    return np.hstack([rest[1:] + (force - rest[0]) * left, rate * left])


def predicted_motion(rows: np.ndarray, count: int) -> np.ndarray:
    """Motion as `held_motion` gives it, but by the linear law of `rows` in the time before the last."""
    from scipy.interpolate import CubicSpline

    time, end, every = rows[:, 0], rows[-1, 0], LAW_STEP * KNOT_INTERVAL
    channels = np.hstack([rows[:, 1:4] - rest_force(rows[:, 7:10]), rows[:, 7:9], rows[:, 6:7]])
    known = min(round(FITTED_TIME / every), int((end - time[0]) / every + 1e-6)) + 1
    at = end - every * np.arange(known)[::-1]
    values = np.stack([np.interp(at, time, channel) for channel in channels.T], axis=1)
    size = values.std(axis=0) + LEAST_DEVIATION
    values = np.vstack([np.zeros((LAW_ORDER, 6)), values / size])
    law, last = fitted_law(values), values[-LAW_ORDER:][::-1]
    later = [*values[-2:]]
    for _ in range(count // LAW_STEP + 2):
        later.append(last.ravel() @ law)
        last = np.vstack([later[-1], last[:-1]])
    track = CubicSpline(every * np.arange(-1, len(later) - 1), np.array(later) * size)
    ahead = KNOT_INTERVAL * np.arange(1, count + 1)
    (force, angles, turn), turns = np.split(track(ahead), [3, 5], axis=1), track(ahead, 1)[:, 3:5]
    return np.hstack([force + rest_force(np.hstack([angles, 0.0 * turn])), turns, turn])


def fitted_law(values: np.ndarray) -> np.ndarray:
    """Coefficients (6 LAW_ORDER, 6) of the linear law by least squares, from last LAW_ORDER values (the latest first)
    to the next, of a series (n, 6). Far and foreign values are punished; what would not die away is made to."""
    n = len(values) - LAW_ORDER
    past = np.stack([values[LAW_ORDER - 1 - k :][:n] for k in range(LAW_ORDER)], axis=1).reshape(n, -1)
    square, right, law = past.T @ past, past.T @ values[LAW_ORDER:], np.empty((6 * LAW_ORDER, 6))
    for channel in range(6):
        penalty = np.full((LAW_ORDER, 6), CROSS_PENALTY)
        penalty[:, channel] = OWN_PENALTY
        penalty *= np.arange(1, LAW_ORDER + 1)[:, None]
        law[:, channel] = np.linalg.solve(square + np.diag(penalty.ravel()), right[:, channel])
    companion = np.vstack([law.T, np.eye(6 * LAW_ORDER)[:-6]])
    decay = np.exp(-LAW_STEP * KNOT_INTERVAL / LONGEST_DECAY)
    slower = decay / max(decay, np.abs(np.linalg.eigvals(companion)).max())
    return law * np.repeat(slower ** np.arange(1, LAW_ORDER + 1), 6)[:, None]
