"""A STEP file's text as a graph of entities, parsed on access."""

from collections.abc import Iterator, Mapping

from .part21_values import DERIVED, Record, Reference, SyntaxFault, Value, Word, decode_string, records
from .statements import find_statements


class Entities:
    """The entities of a file by number; an invalid or missing one has no keyword and no parameters."""

    def __init__(self, bodies: Mapping[int, bytes], encoding: str) -> None:
        self._bodies, self._encoding = bodies, encoding or "latin-1"
        self._records: dict[int, tuple[Record, ...]] = {}

    def of(self, keyword: str) -> list[int]:
        """The entities of a type, in file order."""
        wanted = keyword.encode("ascii")
        return [number for number, body in self._bodies.items() if wanted in body and self.keyword(number, keyword)]

    def with_part(self, ending: str, suffixes: tuple[str, ...]) -> list[int]:
        """The entities of a type with this ending, or this ending and one of the suffixes, in file order."""
        endings, mark = (ending, *(ending + suffix for suffix in suffixes)), ending.encode("ascii")
        return [
            number
            for number, body in self._bodies.items()
            if mark in body and any(keyword.endswith(endings) for keyword in self.keywords(number))
        ]

    def keywords(self, number: int) -> tuple[str, ...]:
        """The types of an entity; several of a complex instance."""
        return tuple(record.keyword for record in self.records(number))

    def keyword(self, number: int, keyword: str) -> bool:
        """Whether an entity has a type."""
        return keyword in self.keywords(number)

    def references(self, number: int) -> list[int]:
        """The entities that an entity refers to, in the order of its parameters, including those in lists."""
        return [value.number for value in self._values(number) if isinstance(value, Reference)]

    def reachable(self, number: int, depth: int) -> list[int]:
        """The entities that an entity refers to in at most ``depth`` steps, each once, the nearest first."""
        numbers: dict[int, None] = {}
        level = [number]
        for _ in range(depth):
            level = [r for n in level for r in self.references(n) if r not in numbers]
            numbers.update(dict.fromkeys(level))
        return list(numbers)

    def numbers_below(self, number: int) -> list[float]:
        """The numbers among the parameters of an entity, including those in lists and typed parameters."""
        return [value for value in self._values(number) if isinstance(value, float)]

    def own_numbers(self, number: int) -> tuple[float | None, ...]:
        """The numbers after the last reference and the last flag of the most derived type; None for an unset one."""
        parsed = self.records(number)
        if not parsed:
            return ()
        own = max(parsed, key=lambda record: record.keyword.endswith("RANGE") or record.keyword == "SCREW_PAIR")
        values: list[float | None] = []
        for value in _flat(own.parameters):
            if (
                isinstance(value, Reference | bytes)
                or value == DERIVED
                or (isinstance(value, Word) and _is_flag(value))
            ):
                values.clear()
            else:
                values.append(value if isinstance(value, float) else None)
        return tuple(values)

    def flags(self, number: int) -> list[bool]:
        """The logical values among the parameters of an entity."""
        return [value.name == "T" for value in self._values(number) if isinstance(value, Word) and _is_flag(value)]

    def text(self, number: int, index: int) -> str:
        """The string at an index among the strings of an entity; empty if there is none."""
        texts = [value for value in self._values(number) if isinstance(value, bytes)]
        return decode_string(texts[index], self._encoding, "replace") if index < len(texts) else ""

    def name(self, number: int) -> str:
        """The first non-empty string of an entity."""
        texts = (value for value in self._values(number) if isinstance(value, bytes) and value.strip())
        return decode_string(next(texts, b""), self._encoding, "replace").strip()

    def product_name(self, definition: int) -> str:
        """Name of the product of a product definition, as the tree of components has it; empty where there is none."""
        reached = self.reachable(definition, depth=2)
        product = next((r for r in reached if self.keyword(r, "PRODUCT")), None)
        return "" if product is None else self.text(product, 1).strip() or self.text(product, 0).strip()

    def records(self, number: int) -> tuple[Record, ...]:
        """The types of an entity with their parameters; several of a complex instance."""
        if number not in self._records:
            try:
                self._records[number] = records(self._bodies[number]) if number in self._bodies else ()
            except SyntaxFault:  # the kernel reports invalid statements
                self._records[number] = ()
        return self._records[number]

    def _values(self, number: int) -> list[Value]:
        return [value for record in self.records(number) for value in _flat(record.parameters)]


def read_entities(data: bytes, encoding: str) -> Entities:
    """The entities of a file; for a duplicate number, the first."""
    bodies: dict[int, bytes] = {}
    for statement in find_statements(data):
        bodies.setdefault(statement.number, statement.body)
    return Entities(bodies, encoding)


def _is_flag(word: Word) -> bool:
    return word.name in ("T", "F")


def _flat(values: tuple[Value, ...]) -> Iterator[Value]:
    for value in values:
        if isinstance(value, tuple):
            yield from _flat(value)
        elif isinstance(value, Record):
            yield from _flat(value.parameters)
        else:
            yield value
