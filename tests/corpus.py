"""Where the corpus of real motions is: QMD_CORPUS, or beside the checkout. Tests on it skip with the reason."""

import os
from pathlib import Path

import pytest

CORPUS = Path(os.environ.get("QMD_CORPUS") or Path(__file__).parents[2] / "shared" / "corpus")


def corpus_files(pattern):
    """Return parameters for a test, one a file; where the corpus is absent, one that skips."""
    files = sorted(CORPUS.glob(pattern))
    if not files:
        reason = f"no {pattern} in {CORPUS}; set QMD_CORPUS to the corpus of real motions"
        return [pytest.param(None, marks=[pytest.mark.corpus, pytest.mark.skip(reason=reason)], id=pattern)]
    return [pytest.param(path, marks=pytest.mark.corpus, id=path.name) for path in files]


def corpus_file(name):
    """Return the path of one corpus file, or skip the running test."""
    path = CORPUS / name
    if not path.exists():
        pytest.skip(f"{path} is absent; set QMD_CORPUS to the corpus of real motions")
    return path
