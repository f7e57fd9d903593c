"""OpenUSD with UsdPhysics, as Isaac Sim and Newton read it."""

from ..format import Format

FORMAT = Format(
    __name__,
    "usd",
    "OpenUSD",
    suffix=".usda",
    root="",
    order=40,
    scene=".scene.usda",
    aliases=("usda", "openusd"),
    programs=("isaac", "newton", "omniverse", "unreal"),
    default=False,
    signatures=(b"#usda ", b"PXR-USDC"),
    mesh_files=False,
)
