"""Commands of `ocean-sim`, without physics."""
