"""Why claims fail: a study's `FAILS` has words of their sentences, and for each the reason, or that nobody knows it."""


def why(study, claim):
    """Why a claim fails, as the study has it; empty if it does not fail, or the study does not say."""
    reasons = getattr(study, "FAILS", {}).items() if claim.failed else ()
    return next((reason for words, reason in reasons if words in claim.sentence), "")


def unexplained(study, claims):
    """Sentences of claims that fail without a reason, and words of reasons that no failed claim has."""
    failed = [claim for claim in claims if claim.failed]
    idle = [words for words in getattr(study, "FAILS", {}) if not any(words in claim.sentence for claim in failed)]
    return [claim.sentence for claim in failed if not why(study, claim)] + idle


def told(study, claims):
    """A line in Markdown for each claim that fails and has a reason."""
    return [f"- FAIL, {claim.sentence}: {why(study, claim)}." for claim in claims if why(study, claim)]
