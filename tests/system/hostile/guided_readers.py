"""One reader under atheris: ``python -m tests.system.hostile.guided_readers NAME BUILT [options of libFuzzer]``."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path


def main() -> None:
    """Give the reader whatever atheris makes of valid files, until the time is over or something is found."""
    import atheris

    with atheris.instrument_imports(include=["cosim", "seat_controller_fmu"]):  # before anything loads them
        from tests.system.hostile import file_properties

    name, built, *options = sys.argv[1:]
    corpus = Path(options[-1])
    with tempfile.TemporaryDirectory() as own:
        folder, temporary = Path(own, "files"), Path(own, "temporary")
        folder.mkdir()
        temporary.mkdir()
        reader = file_properties.readers(Path(built), folder)[name]
        for i, valid in enumerate(reader.valid):
            (corpus / str(i)).write_bytes(valid)
        tempfile.tempdir = str(temporary)

        def check(data: bytes) -> None:
            file_properties.reads_or_refuses(reader, data, folder, with_command=False)

        atheris.Setup([sys.argv[0], *options], check)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
