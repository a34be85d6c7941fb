"""A patch of open sea: the relaxation zone around it, and the sea that feeds it."""
