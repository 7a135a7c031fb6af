"""Templates of G-code: Klipper's language, and its bounds."""

from __future__ import annotations

import pytest

from passo.gcode.template import Budget, Template, TemplateFault


def rendered(text, **values):
    return Template(text).render(values, Budget())


@pytest.mark.parametrize(
    ("text", "becomes"),
    [
        ("G1 X{x + 1}", "G1 X3"),
        ("{% if y is defined %}a{% else %}b{% endif %}", "b"),
        ("{ y|default(4)|float }", "4.0"),
        ("{% for i in range(3) %}{i}{loop.last} {% endfor %}", "0False 1False 2True "),
        ("{% set p = {'a': [1, 2]} %}{ p.a[1] } { p['a']|sum } {p.a|length}", "2 3 2"),
        ("{% do l.append(3) %}{ l|join(',') }", "1,3"),
        ("{% do l.extend([3, 2]) %}{% do l.sort() %}{ l.pop() }{ l|join(',') }", "31,2"),
        ("{% set d = {'a': 1} %}{% do d.update({'a': 2}, b=3) %}{ d.a + d.b }", "5"),
        ("{% set d = {} %}{% do d.__setitem__('a', 4) %}{ d.pop('a') }{ d|length }", "40"),
        ("{ 'PLA'|lower } { '%.2f'|format(3) } { '{:04d}'.format(7) } {# no #}", "pla 3.00 0007 "),
        ("{ 'a' ~ 1 ~ none } { (1, 2)|max } { 'PLA' in ['PLA'] }", "a1None 2 True"),
        ("{% macro m(n) %}<{n}>{% endmacro %}{ m(1) }{ m(2) }", "<1><2>"),
        ("{% set ns = namespace(n=0) %}{% set ns.n = 5 %}{ ns.n }", "5"),
    ],
)
def test_what_a_template_becomes(text, becomes):
    assert rendered(text, x=2, l=[1]) == becomes


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ("\n{ y }", 2, "'y' is undefined"),
        ("\n\n{ 1 / 0 }", 3, "division by zero"),
        ("{ ''.__class__ }", 1, "unsafe"),
        ("{ x.fromkeys('ab') }", 1, "unsafe"),
        ("{% set l = [1] %}{% for i in range(20) %}{% do l.extend(l) %}{% endfor %}", 1, "10,000"),
        (
            "{% set d = {} %}{% for i in range(11000) %}{% do d.update({i: i}) %}{% endfor %}",
            1,
            "more than 10,000 items",
        ),
        ("{ 10 ** 10 ** 10 ** 10 ** 10 }", 1, "bits in a number"),
        ("{ 'a' * 10 ** 9 }", 1, "65,536"),
        ("{ [1] * 10 ** 9 }", 1, "10,000"),
        ("{ range(10 ** 9)|list }", 1, "10,000 items"),
        ("{ range(10 ** 300)|list }", 1, "bound of a range"),
        ("{ 'a'.ljust(10 ** 9) }", 1, "columns"),
        ("{ '{:1000000000}'.format(1) }", 1, "columns"),
        ("{ '{:{}}'.format(1, 10 ** 9) }", 1, "columns"),
        ("{ '%1000000000d' % 1 }", 1, "columns"),
        ("{ '%1000000000d'|format(1) }", 1, "columns"),
        ("{ ('a' * 60000).replace('a', 'b' * 60000) }", 1, "65,536"),
        ("{ ('a' * 60000)|replace('a', 'b' * 60000) }", 1, "65,536"),
        ("{ (['a' * 60000] * 9)|join }", 1, "65,536"),
        ("{ ''.join(['a' * 60000] * 9) }", 1, "65,536"),
        ("{ 1|round(-1000000000) }", 1, "30 decimals"),
        ("{ [1]|batch(10 ** 9, 0)|list }", 1, "10,000 items"),
        ("{ ['a', 'b']|sum(start='') }", 1, "sum takes numbers"),
        ("{% for i in range(9999) %}{% for j in range(99) %}{% endfor %}{% endfor %}", 1, "steps"),
        ("{% for i in range(9999) %}{% if i in l %}{% endif %}{% endfor %}", 1, "steps"),
        ("{% for i in range(9999) %}{ l|length }{% endfor %}", 1, "steps"),
        (
            "{% set n = namespace(s='ab') %}{% for i in range(99) %}{% set n.s = n.s ~ n.s %}"
            "{% endfor %}",
            1,
            "65,536",
        ),
        (
            "{% set n = namespace(s=[]) %}{% for i in range(99) %}{% set n.s = [n.s, n.s] %}"
            "{% endfor %}",
            1,
            "10,000 items",
        ),
        ("{% set t %}{% for i in range(9999) %}{ 'a' * 9999 }{% endfor %}{% endset %}", 1, "text"),
        (
            "{% set t %}{% for i in range(9999) %}" + "a" * 9999 + "{% endfor %}{% endset %}",
            1,
            "text",
        ),
        ("{% macro m() %}{ m() }{% endmacro %}{ m() }", 1, "nested too deeply"),
        ("{% for i in range(99) %}" + "\n" * 101 + "{% endfor %}" + "a" * 10, None, ""),
        ("{% for i in range(99) %}" + "\n" * 102 + "{% endfor %}", None, "10,000 lines"),
        ("{% for i in range(17) %}{ 'a' * 60000 }{% endfor %}", None, "1,000,000 bytes"),
    ],
)
def test_what_a_template_may_not_do(text, line, reason):
    if not reason:
        assert rendered(text).count("\n") == 9999
        return
    with pytest.raises(TemplateFault) as caught:
        rendered(text, x={}, l=list(range(5000)))
    assert reason in caught.value.reason
    assert line is None or caught.value.line == line


@pytest.mark.parametrize(
    ("text", "line"), [("a\n{% if %}", 2), ("{ 1 + }", 1), ("\n{% for %}", 2), ("{ a", 1)]
)
def test_what_is_not_a_template(text, line):
    with pytest.raises(TemplateFault) as caught:
        Template(text)
    assert caught.value.line == line


def test_what_is_nested_without_end_is_not_a_template():
    with pytest.raises(TemplateFault, match="nested too deeply"):
        Template("{" + "(" * 5000 + ")" * 5000 + "}")


def test_calls_share_a_budget():
    template, budget = Template("{% for i in range(9000) %}{% endfor %}"), Budget()
    for _ in range(11):
        template.render({}, budget)
    with pytest.raises(TemplateFault, match="100,000 steps"):
        template.render({}, budget)
