"""Sweeps: many runs of one system, on the cores of a machine or on a cluster, and one table of their results.

A sweep knows systems, parameters, designs of experiments, workers and the dataset. What a parameter or a metric means
is the matter of a :class:`cosim.sweep.vocabulary.Vocabulary`.
"""
