"""What the modules of `platform` share; none of it is a kind that a scene may name."""
