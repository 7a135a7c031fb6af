"""Templates of G-code: Klipper's language, and its bounds."""

from __future__ import annotations

import pytest
from jinja2.defaults import DEFAULT_NAMESPACE
from jinja2.filters import FILTERS

from passo.gcode.template import Budget, Template, TemplateFault
from passo.gcode.template_filters import REFUSED


def rendered(text, **values):
    return Template(text).render(values, Budget())


@pytest.mark.parametrize(
    ("text", "becomes"),
    [
        ("G1 X{x + 1}", "G1 X3"),
        ("{% if y is defined %}a{% else %}b{% endif %}", "b"),
        ("{ y|default(4)|float }", "4.0"),
        ("{% set z = G10|string %}<{z}>{ 3|string }", "<>3"),
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
        ("{ o|map(attribute='p')|sum(start=[])|map('first')|max }", "3"),
        ("{ [(1, 2), (3,)]|sum(start=()) } { [1, 2.5]|sum } { o|sum('n') }", "(1, 2, 3) 3.5 3"),
        ("{ o|groupby('n')|map(attribute='grouper')|join('-') } { o|join(n, 'n') }", "1-2 102"),
        (
            "{ o|selectattr('n', 'gt', 1)|list|length } { o|rejectattr('n', 'odd')|list|length }",
            "1 1",
        ),
        (
            "{ range(5)|slice(2)|list } { range(5)|batch(3)|list }",
            "[[0, 1, 2], [3, 4]] [[0, 1, 2], [3, 4]]",
        ),
        ("{% set c = cycler(1, 2) %}{ c.next() }{ c.next() }{ c.next() }", "121"),
        ("{% set s = joiner('/') %}{ s() }{ 1 }{ s() }{ 2 }", "1/2"),
        (
            "{ 'a\nb'|indent(2) }{ 'x'|center(3) }{ 'a b'|wordwrap(1, wrapstring='_') }",
            "a\n  b x a_b",
        ),
        (
            "{ 3 is divisibleby 3 } { 'abs' is filter } { [] is sequence } { 2 is odd }",
            "True True True False",
        ),
        (
            "{ [] | random | default('empty') } { None is none } { dict(a=1)|tojson }",
            'empty True {"a": 1}',
        ),
    ],
)
def test_templates_become_lines(text, becomes):
    objects = [{"n": 1, "p": [[0, 1], [3, 1]]}, {"n": 2, "p": [[2, 2]]}]
    assert rendered(text, x=2, l=[1], o=objects, n=0) == becomes


@pytest.mark.parametrize("name", sorted({*FILTERS, *DEFAULT_NAMESPACE} - {*REFUSED}))
def test_each_documented_jinja_filter_works(name):
    kind = "filter" if name in FILTERS else "defined"
    subject = repr(name) if kind == "filter" else name
    assert rendered("{ " + f"{subject} is {kind}" + " }") == "True"


@pytest.mark.parametrize("text", ["{ lipsum() }", "{ x|striptags }", "{ x|urlize }"])
def test_forbidden_template_parts_are_named(text):
    with pytest.raises(
        TemplateFault, match=r"is not allowed in a macro: it (is for|writes)"
    ) as caught:
        Template("\n" + text)
    assert caught.value.line == 2


def test_a_seed_decides_what_is_random():
    template = Template("{% for i in range(9) %}{ range(1000)|random } {% endfor %}")
    first, same, other = (template.render({}, Budget(), seed) for seed in ("1", "1", "2"))
    assert first == same != other
    assert len(set(first.split())) > 1


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ("\n{ y }", 2, "'y' is undefined"),
        ("\n\n{ 1 / 0 }", 3, "division by zero"),
        ("{ ''.__class__ }", 1, "unsafe"),
        ("{ x.fromkeys('ab') }", 1, "unsafe"),
        ("{% set l = [1] %}{% for i in range(20) %}{% do l.extend(l) %}{% endfor %}", 1, "100,000"),
        (
            "{% set d = {} %}{% for i in range(9) %}{% do d.update(o) %}{% do d.update({i: i}) %}"
            "{% endfor %}",
            1,
            "100,000 items",
        ),
        ("{ 10 ** 10 ** 10 ** 10 ** 10 }", 1, "bits in a number"),
        ("{ 'a' * 10 ** 9 }", 1, "65,536"),
        ("{ [1] * 10 ** 9 }", 1, "100,000"),
        ("{ range(10 ** 9)|list }", 1, "100,000 items"),
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
        ("{ [1]|batch(10 ** 9, 0)|list }", 1, "100,000 items"),
        ("{ ['a', 'b']|sum(start='') }", 1, "sum takes numbers, not a text"),
        ("{ [[1]]|sum }", 1, "sum takes numbers, not a list; for lists: start=[]"),
        ("{ [1]|sum(start=[]) }", 1, "sum of lists takes lists, not a number"),
        ("{ 'abc'|truncate(2) }", 1, "expected length >= 3"),
        ("{ [1]|slice(10 ** 9)|list }", 1, "100,000 items"),
        ("{ 'a'|center(10 ** 9) }", 1, "columns"),
        ("{ 'a'|wordwrap(1, true, 'a' * 9999) }", 1, "columns"),
        ("{ [1]|tojson(10 ** 9) }", 1, "columns"),
        ("{ ('\\n' * 30000)|indent(999, blank=true) }", 1, "65,536"),
        ("{ range(9999)|map('center', 999)|join }", 1, "65,536"),
        ("{ ['a' * 60000] * 9999 }", 1, "100,000 items"),
        ("{ '{}'.format(n) }", 1, "100,000 items"),
        ("{ '%s' % n }", 1, "100,000 items"),
        ("{ n ~ '' }", 1, "100,000 items"),
        ("{ n|pprint }", 1, "100,000 items"),
        ("{ n in [n] }", 1, "100,000 items"),
        ("{ n is in [] }", 1, "100,000 items"),
        ("{ namespace(n=n) }", 1, "100,000 items"),
        ("{ cycler(n, n) }", 1, "100,000 items"),
        ("{ {'n': n}.values() }", 1, "100,000 items"),
        ("{% do x.update(n=n) %}", 1, "100,000 items"),
        ("{% set k = [] %}{% do k.append(k) %}{ k }", 1, "100,000 items"),
        ("{% for i in range(999) %}{% do k.append(l[:]) %}{% endfor %}", 1, "steps"),
        ("{% for i in range(9999) %}{% do k.append('a' * 9999) %}{% endfor %}", 1, "steps"),
        ("{% for i in range(9999) %}{% do l.sort() %}{% endfor %}", 1, "steps"),
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
            "100,000 items",
        ),
        (
            "{% set s = 'a' * 9999 %}{% set t %}{% for i in range(9999) %}{ s }{% endfor %}"
            "{% endset %}",
            1,
            "text",
        ),
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
def test_templates_cannot_leave_the_sandbox(text, line, reason):
    if not reason:
        assert rendered(text).count("\n") == 9999
        return
    with pytest.raises(TemplateFault) as caught:
        rendered(
            text,
            x={},
            k=[],
            l=list(range(5000)),
            n=[[0] * 999] * 999,
            o=dict.fromkeys(range(-95000, 0)),
        )
    assert reason in caught.value.reason
    assert line is None or caught.value.line == line


@pytest.mark.parametrize(
    ("text", "line"), [("a\n{% if %}", 2), ("{ 1 + }", 1), ("\n{% for %}", 2), ("{ a", 1)]
)
def test_invalid_templates_are_refused(text, line):
    with pytest.raises(TemplateFault) as caught:
        Template(text)
    assert caught.value.line == line


def test_too_deeply_nested_template_is_refused():
    with pytest.raises(TemplateFault, match="nested too deeply"):
        Template("{" + "(" * 5000 + ")" * 5000 + "}")


def test_calls_share_a_budget():
    template, budget = Template("{% for i in range(9000) %}{% endfor %}"), Budget()
    for _ in range(11):
        template.render({}, budget)
    with pytest.raises(TemplateFault, match="100,000 steps"):
        template.render({}, budget)
