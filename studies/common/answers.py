"""What a method answers, with what it says besides: a refusal is an answer too."""

import warnings

REFUSALS = (ValueError, NotImplementedError, RuntimeError)


def answer(call):
    """What a call returns, what it warns of and what it refuses: (answer, warnings, refusal), or the last one alone."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            found, refusal = call(), None
        except REFUSALS as error:
            found, refusal = None, error
    # Of the numbers, not of caches, nor of overflows on the way.
    said = [str(each.message) for each in caught if each.category is UserWarning and "cache" not in str(each.message)]
    return found, list(dict.fromkeys(said)), refusal
