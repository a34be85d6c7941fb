"""Naval architecture of a hull at rest: hydrostatics and stability."""
