"""Modules shared by the cases of `validation`; none is a case."""
