"""Results of many inputs are as they were recorded.

After a change that is meant, `python -m tests.recorded` records them again.
"""

import pytest

from . import digest, drafts, files, recorded, verdicts

KINDS = {"drafts": drafts.RESULTS, "files": files.RESULTS, "verdicts": verdicts.RESULTS}
_QUICK = (", plain",)


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        pytest.param(kind, name, marks=() if name.endswith(_QUICK) else pytest.mark.slow)
        for kind, results in KINDS.items()
        for name in results
    ],
)
def test_result_is_as_recorded(kind: str, name: str) -> None:
    """The digest is the recorded one; `python -m tests.recorded --show 'KIND NAME'` prints what is behind it."""
    known, parts = recorded(kind)[name], KINDS[kind][name](0.0)
    assert {part: digest(parts[part]) for part in known} == known
