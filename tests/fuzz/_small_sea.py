"""The smallest scene that is a run: waves in closed form on one thread, and a gauge."""

SMALL_SEA = {
    "basin": {"length": 20.0, "width": 20.0, "depth": 5.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 0.5, "period": 3.0},
    "gauges": {"elevation": {"here": [0.1, 0.2]}, "every": 0.02},
    "runtime": {"threads": 1},
    "render": None,
}
