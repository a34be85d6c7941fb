"""What the modules of `studies` share; none of it is a kind that a scene may name."""
