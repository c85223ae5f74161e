"""Evaluation of a seat over classes of excitation and drivers."""
