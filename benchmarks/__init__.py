"""Programs of others beside this one, on the same tasks: what `ocean-sim bench --peers` runs in a checkout."""
