"""Parts that the kinds of `surface` share; none of them is a kind that a scene may name."""
