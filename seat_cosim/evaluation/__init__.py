"""Evaluation of seats over classes of excitation and drivers, by ISO 7096 and ISO 2631-1."""
