"""`passo.lab`: experiments of the course in programs and notebooks."""

import json
from pathlib import Path

import numpy as np
import pytest

import passo

NOTEBOOK = Path(__file__).parents[2] / "examples" / "course.ipynb"


def test_an_experiment_returns_numbers_with_units_and_arrays():
    result = passo.lab.experiment("trapezoid-and-triangle")(length_mm=4, speed_mm_s=100)
    top = result["top_mm_s"]
    assert (top, top.unit) == (pytest.approx(63.2456, abs=1e-3), "mm/s")
    assert top / 2 == pytest.approx(31.6228, abs=1e-3)
    curve = result.curves["Speed over time"]["planned"]
    assert np.asarray(curve.y).max() == top
    assert (curve.x_label, curve.y_label) == ("time, s", "mm/s")
    with pytest.raises(passo.CommandError):
        passo.lab.experiment("steps-per-mm")(teeth=1000)
    with pytest.raises(KeyError):
        passo.lab.experiment("perpetual-motion")


def test_the_cells_of_the_notebook_run(capsys):
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    names = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), str(NOTEBOOK), "exec"), names)
    out = capsys.readouterr().out
    assert "'steps-per-mm'" in out
    assert "'31.6 mm/s', '44.7 mm/s', '63.2 mm/s', '89.4 mm/s', '100.0 mm/s'" in out
    assert "[43 °C, 97 °C, 187 °C]" in out
