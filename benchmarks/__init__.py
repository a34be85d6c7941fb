"""Programs of others beside this one, on the same tasks, as `ocean-sim bench --peers` runs them in a checkout."""
