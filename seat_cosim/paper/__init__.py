"""Reproduction of the paper: its figures and tables, from FMUs under the paper's conditions.

``contents`` lists the figures and tables. Each module of experiments makes the findings of some of them, with an
:class:`~seat_cosim.paper.runner.ExperimentRunner`; ``experiments`` lists the experiments, ``report`` writes the page.
"""
