"""The layers that a stage is composed of."""

from collections.abc import Iterator
from pathlib import Path

from stepbot.runtime.file import is_file, resolved

_MOST_LAYERS = 1000


def layer_references(main: Path) -> Iterator[tuple[Path, str, Path]]:
    """References to other files, in the main file and in those that it refers to below its folder; no other is opened.

    Each is the file that has it, the name as it is there, and the absolute path of the sublayer, reference or payload.
    A file that USD cannot parse has none; without USD's library there are none, as no engine can read the file.
    """
    try:
        from pxr import Sdf, Tf
    except ImportError:
        return
    pending, seen = [main], {main}
    while pending and len(seen) <= _MOST_LAYERS:
        path = pending.pop()
        try:
            layer = Sdf.Layer.FindOrOpen(str(path))
        except Tf.ErrorException:
            continue
        names = [] if layer is None else layer.GetCompositionAssetDependencies()
        for name in filter(None, names):  # a reference without a file is to a prim of the same one
            target = Path(layer.ComputeAbsolutePath(name.partition("[")[0]))
            yield path, name, target
            inside = resolved(target).is_relative_to(main.parent)
            if inside and is_file(target) and resolved(target) not in seen:
                seen.add(resolved(target))
                pending.append(target)
