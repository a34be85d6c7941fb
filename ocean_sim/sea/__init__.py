"""The sea around a patch of particles: every module of this folder is a kind that a scene may name."""
