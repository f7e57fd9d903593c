"""Disjoint sets, some pairs of which must stay apart."""

from collections import defaultdict
from collections.abc import Iterable


class Clusters:
    """Parts that move as one, and pairs of them with an accepted joint between them."""

    def __init__(self, members: Iterable[int]) -> None:
        self._root = {member: member for member in members}
        self._members: dict[int, list[int]] = {member: [member] for member in self._root}
        self._apart: dict[int, set[int]] = defaultdict(set)

    def __contains__(self, member: int) -> bool:
        return member in self._root

    def add(self, member: int) -> None:
        """Add a member in a set of its own."""
        self._root[member] = member
        self._members[member] = [member]

    def find(self, member: int) -> int:
        """The representative of a member's set."""
        while self._root[member] != member:
            self._root[member] = self._root[self._root[member]]
            member = self._root[member]
        return member

    def members(self, member: int) -> list[int]:
        """All members of a member's set, ascending."""
        return sorted(self._members[self.find(member)])

    def join(self, a: int, b: int) -> bool:
        """Unite two sets; False if they must stay apart."""
        a, b = self.find(a), self.find(b)
        if a == b:
            return True
        if b in self._apart[a]:
            return False
        if (len(self._members[a]), -a) < (len(self._members[b]), -b):
            a, b = b, a
        self._root[b] = a
        self._members[a] += self._members.pop(b)
        for other in self._apart.pop(b, set()):
            self._apart[other].discard(b)
            self._apart[other].add(a)
            self._apart[a].add(other)
        return True

    def forbid(self, a: int, b: int) -> bool:
        """Keep two sets apart; False if they are already united."""
        a, b = self.find(a), self.find(b)
        if a == b:
            return False
        self._apart[a].add(b)
        self._apart[b].add(a)
        return True

    def apart_from_both(self, a: int, b: int) -> set[int]:
        """The representatives of the sets that must stay apart from both of two others."""
        return self._apart[self.find(a)] & self._apart[self.find(b)]

    def allow(self, a: int, b: int) -> None:
        """Revoke that two sets must stay apart."""
        a, b = self.find(a), self.find(b)
        self._apart[a].discard(b)
        self._apart[b].discard(a)

    def are_apart(self, a: int, b: int) -> bool:
        """Whether two sets must stay apart."""
        return self.find(b) in self._apart[self.find(a)]

    def groups(self) -> dict[int, list[int]]:
        """All sets by their representatives, in the order of their first members."""
        groups = {root: sorted(members) for root, members in self._members.items()}
        return dict(sorted(groups.items(), key=lambda item: item[1][0]))
