"""System structures of SSP 1.0, read into a :class:`~cosim.engine.structure.Structure` and written from one.

There are libraries for this, and none that could be used: pyssp_standard 0.9.1 drops linear transformations,
``suppressUnitConversion``, the connectors' units, ``sourceBase`` and inline mappings on reading; fmpy's own reader
drops the default experiment and inline mappings, and looks for linear transformations in a namespace where none are.
What is dropped there would change results in silence. So a file is validated here against the standard's own schemas,
which fmpy ships, and read and written by one declaration for each element.
"""

from cosim.ssp.read import load, read_parameters
from cosim.ssp.write import package_contents, parameter_set

__all__ = ["load", "package_contents", "parameter_set", "read_parameters"]
