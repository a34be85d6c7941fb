"""What the modules of `fluid` share; none of it is a kind that a scene may name."""
