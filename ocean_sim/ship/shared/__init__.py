"""What the modules of `ship` share; none of it is a kind that a scene may name."""
