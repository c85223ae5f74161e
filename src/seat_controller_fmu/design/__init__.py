"""Gains from matrix inequalities, their certificate, the sampled loop, sets that come with the package."""
