"""Claims judged, tables written."""

import pandas as pd
import pytest

from studies.harness import table


def test_a_failed_claim_gives_a_failing_status(tiny, capsys):
    tiny.write(limit=">= 5")
    tiny.made()
    assert tiny.run() == 1
    assert "FAIL: squares are small" in capsys.readouterr().err
    assert "| FAIL | squares are small" in (tiny.out / f"{tiny.name}.md").read_text()


@pytest.mark.parametrize("broken", ["df['square'].max()", "df['nothing']"])
def test_what_cannot_be_judged_or_drawn_fails(tiny, broken, capsys):
    if broken == "df['nothing']":
        tiny.write(**{'df["square"].max()': broken})
    else:
        tiny.write(**{'axes.plot(df["x"]': 'axes.plot(df["nothing"]'})
    tiny.made()
    assert tiny.run() == 1
    assert "KeyError" in capsys.readouterr().err


def test_a_table_that_cannot_be_made_is_a_claim_that_fails(tiny, capsys):
    """As of a run that was killed before the rows that a table is made of."""
    tiny.write(**{"def plot(df)": 'def table(df):\n    return df[["nothing"]]\n\ndef plot(df)'})
    tiny.made()
    assert tiny.run() == 1
    page = (tiny.out / f"{tiny.name}.md").read_text()
    assert "| FAIL | the table can be made (KeyError" in page and "| ok   | squares are small" in page
    assert "plain,x=1.5" in page
    assert "FAIL: the table can be made" in capsys.readouterr().err


def test_markdown():
    df = pd.DataFrame({"method": ["a|b", "c"], "error": [0.123456, float("nan")], "unknowns": [123456.0, 7.0]})
    assert table.markdown(df).split("\n") == [
        "| method | error | unknowns |",
        "|--------|------:|---------:|",
        "| a\\|b   | 0.123 |   123456 |",
        "| c      |       |        7 |",
    ]
