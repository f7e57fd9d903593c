"""Items of representations, including entities that are not items."""

from stepbot.step.exchange.selection import items


class Representation:
    """A representation whose first item is an entity of another type."""

    def NbItems(self) -> int:  # noqa: N802 - the kernel's name
        """Number of items."""
        return 2

    def ItemsValue(self, index: int) -> str | None:  # noqa: N802 - the kernel's name
        """An item, counted from 1."""
        return (None, "a point")[index - 1]


def test_items_that_are_none() -> None:
    """Entities of other types are omitted; another type of representation has no items."""
    assert list(items(Representation())) == ["a point"]
    assert list(items(None)) == []
