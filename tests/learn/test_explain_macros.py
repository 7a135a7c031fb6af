"""What `passo explain` shows of macros."""

from __future__ import annotations

from tests.support.macro_machine import macro, with_macros

from passo.job.batch.policy import Policy
from passo.learn.explain import explain
from passo.learn.explanation import explanation_text


def test_what_a_macro_became_is_shown(tmp_path):
    path = tmp_path / "a.g"
    path.write_text("G28\nSTART BED=50 ; begin\nG1 X20 F6000\n")
    text = macro("START", "\nM140 S{params.BED}\nPURGE\n", description='"heats"')
    text += macro("PURGE", "{% for i in range(2) %}\nG1 X{i + 1} F6000\n{% endfor %}")
    told = explanation_text(explain(with_macros(text), path, 2, Policy()))
    assert "START: A macro of the machine file: heats.\n  BED=50" in told
    assert (
        "START BED=50 became:\n  M140 S50\n  PURGE\nPURGE became:\n  G1 X1 F6000\n  G1 X2 F6000"
        in told
    )
    assert told.count("Planned: a travel move of 1.000 mm") == 2
