"""What the modules of `wind` share; none of it is a kind that a scene may name."""
