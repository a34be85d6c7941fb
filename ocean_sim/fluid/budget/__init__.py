"""Books of the water: momentum by term, sums over particles, and fields sampled from them."""
