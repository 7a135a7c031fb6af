"""Numbers by hand: area = h·(w - h) + π·h²/4; filament of 1.75 mm has 2.4053 mm²."""

import pytest

from passo.learn.lessons.extrusion_arithmetic import LESSON


def test_a_line():
    outcome = LESSON.experiment.run({})
    assert outcome["area_mm2"] == pytest.approx(0.2 * 0.25 + 0.0314159, abs=1e-6)
    assert outcome["filament_area_mm2"] == pytest.approx(2.40528, abs=1e-5)
    assert outcome["e_mm"] == pytest.approx(8.14159 / 2.40528, abs=1e-4)
    assert LESSON.experiment.run({"flow_percent": 95})["e_mm"] == pytest.approx(3.2156, abs=1e-3)


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(200 * (0.09 + 0.0706858) / 2.40528, rel=1e-5)
    assert LESSON.asked(1).answer == pytest.approx(40 * (0.0625 + 0.0490874), rel=1e-5)
