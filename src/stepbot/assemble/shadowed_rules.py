"""Rules of ``parts`` that set nothing, because rules above them have set it: of several rules the first holds."""

from collections.abc import Iterable

from .binder import Binder


class ShadowedRules:
    """The fields of each rule that earlier rules set on all of its components, to other values."""

    def __init__(self, binder: Binder) -> None:
        self._binder = binder
        self._rules = list(binder.document.parts.items())
        self._found: dict[int, dict[str, list[int]]] = {}

    def note(self, rule: int, field: str, earlier: Iterable[int]) -> None:
        """Take one field of a rule.

        Args:
            rule: Number of the rule in the file.
            field: What it sets.
            earlier: For each component that it covers, the number of the rule that has set the field; -1 for none.
        """
        above = [int(number) for number in earlier]
        others = [n for n in dict.fromkeys(above) if n >= 0 and self._value(n, field) != self._value(rule, field)]
        if above and min(above) >= 0 and others:
            self._found.setdefault(rule, {})[field] = others

    def report(self) -> None:
        """Report SB309, one for each rule."""
        for rule, fields in self._found.items():
            pattern = self._rules[rule][0]
            above = [self._rules[n][0] for n in sorted({n for numbers in fields.values() for n in numbers})]
            named = " and ".join(f"'{one}'" for one in above[:_NAMED])
            more = f" and {len(above) - _NAMED} more" if len(above) > _NAMED else ""
            what = ", ".join(f"'{field}'" for field in fields)
            self._binder.report(
                "SB309",
                ("parts", pattern),
                f"{what} without effect: set by {named}{more} above",
                help=(f"of several rules the first holds: move this rule above '{above[0]}', or remove it",),
            )

    def _value(self, rule: int, field: str) -> object:
        """What a rule sets; a density or a colour may come from its material."""
        given = self._rules[rule][1]
        if field in ("density", "color"):
            return (getattr(given, field), given.material)
        return getattr(given, field)


_NAMED = 2
"""Maximum number of rules that a message names."""
