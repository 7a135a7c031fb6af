"""What has changed between two trees, as a merge patch."""

from hypothesis import given
from hypothesis import strategies as st
from tests.web.fake_bridge import STATUS

from passo.web.deltas import changes, tree

LEAVES = st.integers() | st.text(max_size=3) | st.booleans() | st.lists(st.integers(), max_size=2)
TREES = st.recursive(
    st.dictionaries(st.sampled_from("abcd"), LEAVES, max_size=3),
    lambda inner: st.dictionaries(st.sampled_from("abcd"), LEAVES | inner, max_size=3),
    max_leaves=12,
)


def merged(target, patch):
    """RFC 7386, section 2."""
    if not isinstance(patch, dict):
        return patch
    target = dict(target) if isinstance(target, dict) else {}
    for key, value in patch.items():
        if value is None:
            target.pop(key, None)
        else:
            target[key] = merged(target.get(key), value)
    return target


@given(TREES, TREES)
def test_patch_turns_one_status_into_another(before, now):
    assert merged(before, changes(before, now)) == now


@given(TREES)
def test_nothing_has_changed_between_equal_trees(value):
    assert changes(value, value) == {}


def test_a_status_becomes_plain_values():
    plain = tree(STATUS)
    assert plain["state"] == "I"
    assert plain["homed"] == ["x", "y", "z"]
    assert plain["heaters"]["bed"] == {
        "celsius": 60.0,
        "target_c": 60.0,
        "power": 0.4,
        "fault": "",
        "min_extrude_c": 0.0,
        "age_s": 0.0,
    }
