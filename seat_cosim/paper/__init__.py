"""The paper's evaluation, figure by figure: what it says, and what the FMUs give under the same conditions.

``contents`` lists the paper's figures and tables; each module of experiments makes the findings for some of them, of
FMUs that run in a :class:`~seat_cosim.paper.runner.Lab`; ``experiments`` knows them all.
"""
