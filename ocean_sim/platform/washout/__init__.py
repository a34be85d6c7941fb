"""Washout filters: every module of this folder is a kind that a platform may name."""
