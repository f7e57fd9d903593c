"""Observations of a file under other names than it has: for a source whose names a conversion had to change."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

from stepbot.engines.observation import Observation, ObservedJoint, Request

Value = TypeVar("Value")


@dataclass(frozen=True)
class Renaming:
    """New names by the names in the file, of those that change."""

    links: Mapping[str, str] = field(default_factory=dict)
    joints: Mapping[str, str] = field(default_factory=dict)
    frames: Mapping[str, str] = field(default_factory=dict)

    def asked(self, request: Request) -> Request:
        """A request with new names, in those of the file."""
        old = {new: name for name, new in self.joints.items()}
        if not old:
            return request
        return replace(
            request,
            configurations=tuple(_keys(q, old) for q in request.configurations),
            rates=tuple((_keys(v, old), _keys(a, old)) for v, a in request.rates),
            initial=_keys(request.initial, old),
            balls=_keys(request.balls, old),
            universals=_keys(request.universals, old),
        )

    def seen(self, observation: Observation) -> Observation:
        """An observation of the file, with new names."""
        links, joints = self.links, self.joints
        return replace(
            observation,
            links=tuple(replace(one, name=links.get(one.name, one.name)) for one in observation.links),
            joints=tuple(self._joint(one) for one in observation.joints),
            coordinates=tuple(joints.get(name, name) for name in observation.coordinates),
            poses=tuple(_keys(one, links) for one in observation.poses),
            closures=observation.closures
            and tuple(
                replace(one, link_a=links.get(one.link_a, one.link_a), link_b=links.get(one.link_b, one.link_b))
                for one in observation.closures
            ),
            frames=observation.frames
            and {
                self.frames.get(name, name): (links.get(link, link), X)
                for name, (link, X) in observation.frames.items()
            },
            actuators=observation.actuators
            and tuple(replace(one, joint=joints.get(one.joint, one.joint)) for one in observation.actuators),
            sensors=observation.sensors
            and tuple(
                replace(
                    one,
                    link=one.link and links.get(one.link, one.link),
                    joint=one.joint and joints.get(one.joint, one.joint),
                )
                for one in observation.sensors
            ),
            initial=None if observation.initial is None else _keys(observation.initial, joints),
            excluded_pairs=observation.excluded_pairs
            and tuple(
                (min(pair), max(pair))
                for pair in ((links.get(a, a), links.get(b, b)) for a, b in observation.excluded_pairs)
            ),
        )

    def _joint(self, joint: ObservedJoint) -> ObservedJoint:
        links, joints = self.links, self.joints
        mimic = joint.mimic and replace(joint.mimic, joint=joints.get(joint.mimic.joint, joint.mimic.joint))
        return replace(
            joint,
            name=joints.get(joint.name, joint.name),
            parent=links.get(joint.parent, joint.parent),
            child=links.get(joint.child, joint.child),
            mimic=mimic,
            steps=tuple(self._joint(step) for step in joint.steps),
        )


def _keys(values: Mapping[str, Value], names: Mapping[str, str]) -> dict[str, Value]:
    return {names.get(name, name): value for name, value in values.items()}
