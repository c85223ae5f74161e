"""Sessions in a Jupyter kernel, whose standard output is a stream of its own."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.helpers.faulty import faulty_fmu

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")

pytestmark = [pytest.mark.builds, pytest.mark.skipif(sys.platform == "win32", reason="compiles with gcc")]

CELLS = [
    "import asyncio, sys, os, threading; from pathlib import Path; from cosim import System\n"
    "system = System(); system.add('cab', PRINTS); before = sys.stdout, os.getcwd()",
    "result = system.simulate(0.3, 0.01, progress=lambda t: None); print([w for w in result.warnings if 'hello' in w])",
    "with system.open() as session:\n    print('inside'); session.run(0.3, 0.01); print('after a run')",
    "seat = System.load(SSP); alone = seat.simulate(0.1)\n"
    "found = await asyncio.gather(*(asyncio.to_thread(seat.simulate, 0.1) for _ in range(4)))\n"
    "print(all((f[n] == alone[n]).all() for f in found for n in alone.values))",
    "print((sys.stdout, os.getcwd()) == before, sys.stdout.closed)",
]


def printed(cell: Any) -> str:
    return "".join(output.get("text", "") for output in cell.outputs if output.output_type == "stream")


def test_sessions_run_in_a_notebook(native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    from seat_cosim.scenarios import seat_suspension

    seat_suspension(native / "fmi3").save(tmp_path / "seat.ssp")
    names = f"PRINTS = {str(faulty_fmu(tmp_path, 'prints', 'load'))!r}; SSP = {str(tmp_path / 'seat.ssp')!r}\n"
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, sys.path)))
    monkeypatch.setenv("JUPYTER_PLATFORM_DIRS", "1")
    cells = [nbformat.v4.new_code_cell(source) for source in [names + CELLS[0], *CELLS[1:]]]
    notebook = nbformat.v4.new_notebook(cells=cells)
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    texts = [printed(cell) for cell in notebook.cells]
    assert texts == [
        "",
        "['cab: printed to stdout in load at t = 0 s: hello from C']\n",
        "inside\nafter a run\n",
        "True\n",
        "True False\n",
    ]
