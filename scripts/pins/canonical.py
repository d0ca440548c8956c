"""Bytes of a file without what may differ from run to run: times, versions, and places of folders."""
import re

TEXTS = (".json", ".txt")

# Members of JSON that hold times, or follow from them: "seconds", "synthesize ratio", "waves_pixels_per_second". Their values are
# replaced; all other bytes stay.
TIMES = re.compile(r'("(?:[^"\n]* )?(?:\w*seconds\w*|\w*_per_second|ratio)": ?)[-+.\deE]+')
# Objects of `estimate --json` that hold times only, and the bands that a stopped job has finished.
GROUPS = re.compile(r'("(?:stages|real_time)": )\{[^{}]*\}|("finished":)\[.*\]')
VERSIONS = re.compile(r'("(?:holotrace|version|job)": ?)"[^"]*"|^(holotrace |version +)\d+\.\d+\.\d+', re.M)
# Times in messages: "   0.18 s", "1.2e-05 s", "3 ms"; a column is as wide as its number.
PRINTED_TIMES = re.compile(r" +\d[\d.]*(?:e[-+]\d+)? (?:s|ms|us|µs|min)(?![\w/])")
PRINTED_SECONDS = re.compile(r"^(seconds +)[\d.]+", re.M)
PREDICTIONS = re.compile(r"(?: +\d+\.\d{3}){2} +\d+\.\d\d$", re.M)  # of run --estimate: predicted, taken, ratio


def canonical(name, data, places=()):
    """
    The bytes of a file as they are compared.

    name    of the file; its ending tells whether it is a text
    data    bytes of the file
    places  (path, word): paths of this machine, and the word that stands for each
    """
    if not name.endswith(TEXTS):
        return data
    text = data.decode("utf-8", errors="surrogateescape")
    for path, word in places:
        text = text.replace(str(path), word)
    for pattern in (GROUPS, TIMES, VERSIONS):
        text = pattern.sub(lambda found: next(filter(None, found.groups())) + "0", text)
    if name.endswith(".txt"):
        text = PREDICTIONS.sub(" 0", PRINTED_SECONDS.sub(r"\g<1>0", PRINTED_TIMES.sub(" 0 s", text)))
    return text.encode("utf-8", errors="surrogateescape")
