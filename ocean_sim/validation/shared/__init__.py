"""What the modules of `validation` share; none of it is a kind that a scene may name."""
