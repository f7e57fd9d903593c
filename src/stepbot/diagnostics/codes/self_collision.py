"""SB62x: links that can overlap."""

from .code import Code

CODES = (
    Code(
        "SB620",
        "warning",
        "links always overlap",
        "The collision shapes of two links without a common joint penetrate each other in every sampled pose. A "
        "simulator would push the links apart without end, and a planner would find no path, so contacts of the pair "
        "are excluded. That hides an overlap of the parts, or of collision shapes that are larger than the parts.",
        "Convex hulls fill concave regions. Choose a closer `collision` for one of the links. If the parts overlap, "
        "correct the CAD. If both links are meant to be one body, connect them with a fixed joint.",
    ),
    Code(
        "SB621",
        "note",
        "fewer poses than requested",
        "The robot has fewer poses in which self-collision can be searched: it cannot move, or its loops jam. What "
        "never happens in a few poses may happen in others.",
        "Check the limits of the joints in the loops, and that the loops can move (SB819).",
    ),
)
