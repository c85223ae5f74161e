"""Read and write system structures of SSP 1.0 as a :class:`~cosim.engine.structure.Structure`.

No existing library is used, because each drops parts of the standard silently, which would change results:
pyssp_standard 0.9.1 drops linear transformations, ``suppressUnitConversion``, the units of connectors, ``sourceBase``
and inline mappings on reading; fmpy's reader drops the default experiment and inline mappings, and searches linear
transformations in a wrong namespace. Here a file is validated against the standard's schemas, which fmpy includes, and
each element is read and written by one declaration.
"""

from cosim.ssp.read import load, read_parameters
from cosim.ssp.write import package_contents, parameter_set

__all__ = ["load", "package_contents", "parameter_set", "read_parameters"]
