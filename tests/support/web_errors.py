"""Refusals of the web interface, as tests compare them."""


def code_of(answer):
    """The code of the first error."""
    return answer.json()["error"]["code"]
