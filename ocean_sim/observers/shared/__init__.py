"""What the modules of `observers` share; none of it is a kind that a scene may name."""
