"""Recognition of a measurement file by its first bytes."""

from __future__ import annotations

from pathlib import Path

from cosim.errors import SetupError
from cosim.fmi.archive import is_file
from cosim.recordings.binary_files import MatFile, MdfFile, ParquetFile
from cosim.recordings.measurement_file import MeasurementFile
from cosim.recordings.requests import TextOptions
from cosim.recordings.text_file import TextFile

_OTHERS = {
    b"PK\x03\x04": "a zip archive or an Excel workbook; unpack it, or save the sheet as CSV",
    b"\x1f\x8b": "a file packed by gzip; unpack it",
    b"\xd0\xcf\x11\xe0": "an Excel workbook; save the sheet as CSV",
    b"TDSm": "a TDMS file; export it as CSV, MDF4, MAT or Parquet",
    b"RIFF": "a WAV file, which has no scale; export it as CSV, MDF4, MAT or Parquet",
    b"DFIMAGE": "a DIAdem file; export it as CSV, MDF4, MAT or Parquet",
    b"\x89HDF": "an HDF5 file (MAT 7.3 is one); save it as MAT version 7, CSV or Parquet",
    b"    -1": "a universal file (UFF58); export it as CSV, MDF4, MAT or Parquet",
}
"""First bytes of other files to what they are, and what helps."""


def open_file(path: Path, text: TextOptions) -> MeasurementFile:
    """Open a measurement file by its first bytes, not by its suffix.

    Parameters
    ----------
    path
        The file.
    text
        What is known of the form of a text file.

    Returns
    -------
    MeasurementFile
        The file with its columns.

    Raises
    ------
    SetupError
        If there is no such file, or it is of another kind.
    """
    if not is_file(path):
        raise SetupError(f"{path}: expected a measurement file, got no such file")
    try:
        with path.open("rb") as stream:
            head = stream.read(128)
        if head.startswith((b"MDF     ", b"UnFinMF ")):
            return MdfFile(path)
        if head.startswith(b"PAR1"):
            return ParquetFile(path)
        if head.startswith(b"MATLAB 7.3"):
            raise SetupError(f'{path}: expected a MAT file up to version 7, got 7.3; save it with "-v7"')
        if head.startswith(b"MATLAB 5.0") or path.suffix.lower() == ".mat":
            return MatFile(path)
        for mark, found in _OTHERS.items():
            if head.startswith(mark):
                raise SetupError(f"{path}: expected text, MDF4, MAT or Parquet, got {found}")
        return TextFile(path, text)
    except OSError as error:
        raise SetupError(f"{path}: expected a file that can be read, got: {error.strerror or error}") from None
