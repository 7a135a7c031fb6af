"""What clients hear of objects: all once, then what has changed."""

from passo.web.klippy.subscriptions import Subscription, picked


def look(objects):
    return lambda name: objects.get(name, {})


def test_unknown_objects_are_empty_and_unknown_fields_are_null():
    objects = {"fan": {"speed": 0.5}}
    wishes = {"fan": ["speed", "rpm"], "nothing": None, "none": ["x"]}
    assert picked(wishes, look(objects)) == {
        "fan": {"speed": 0.5, "rpm": None},
        "nothing": {},
        "none": {"x": None},
    }


def test_only_what_has_changed_is_sent_again():
    subscription = Subscription({"a": None, "b": ["x"]}, {})
    before = {"a": {"x": 1, "list": [1]}, "b": {"x": 1, "y": 1}}
    assert subscription.first(look(before)) == {"a": {"x": 1, "list": [1]}, "b": {"x": 1}}
    assert subscription.changed(look(before)) == {}
    after = {"a": {"x": 1, "list": [1, 2]}, "b": {"x": 1, "y": 2}}
    assert subscription.changed(look(after)) == {"a": {"list": [1, 2]}}
    assert subscription.changed(look(after)) == {}


def test_fields_are_those_of_the_first_answer():
    subscription = Subscription({"a": None}, {})
    subscription.first(look({"a": {"x": 1}}))
    assert subscription.changed(look({"a": {"x": 1, "new": 2}})) == {}
    assert subscription.changed(look({"a": {}})) == {"a": {"x": None}}
