"""What the modules of `surface` share; none of it is a kind that a scene may name."""
