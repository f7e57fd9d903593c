"""Items of representations, also of those that name what is no item."""

from stepbot.step.exchange.selection import items


class Representation:
    """As the kernel gives one whose first item is something else."""

    def NbItems(self) -> int:  # noqa: N802 - the kernel's name
        """How many there should be."""
        return 2

    def ItemsValue(self, index: int) -> str | None:  # noqa: N802 - the kernel's name
        """One of them, from 1."""
        return (None, "a point")[index - 1]


def test_items_that_are_none() -> None:
    """Entities of other types are left out; another type of representation has no items."""
    assert list(items(Representation())) == ["a point"]
    assert list(items(None)) == []
