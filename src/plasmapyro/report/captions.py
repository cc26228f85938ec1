"""What each figure shows, in words: its caption and, for who cannot see it, its alternative text."""

from plasmapyro.tables import rows

# Beginning of the figure's file name -> (chapter, caption, alternative text). The longest match counts.
FIGURES = {figure: words for figure, *words in (row.values() for row in rows("report/captions.csv"))}


def describe(name):
    """Chapter, caption and alternative text of a figure, by its file name without suffix.

    KeyError if no entry fits; the message says where to add one.
    """
    fitting = [start for start in FIGURES if name.startswith(start)]
    if not fitting:
        raise KeyError(f"figure '{name}' has no words yet; add it to report/captions.csv")
    chapter, caption, words = FIGURES[max(fitting, key=len)]
    return chapter, caption + (" Your own conditions." if name.endswith("_own") else ""), words
