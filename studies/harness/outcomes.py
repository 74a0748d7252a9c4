"""What a paper prints, and whether it came out: the claims that judge it, with a word for their verdict."""

WORDS = {"ok": "reproduced", "FAIL": "different", "not judged": "not judged"}


def held_to(found, name, words):
    """Claims of a chapter that have any of these words, each with what came of it and why; None without the chapter.

    A text in place of words says why there is none.
    """
    chapter = next((each for each in found if each.name == name), None)
    if chapter is None or isinstance(words, str):
        return None if chapter is None else []
    why = {claim.sentence: reason for claim, reason in chapter.fails}
    asked = [claim for claim in chapter.claims if any(each in claim.sentence for each in words)]
    return [(WORDS[claim.verdict], claim, why.get(claim.sentence, "")) for claim in asked]
