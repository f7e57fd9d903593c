"""Verification of one conversion: engines read its files before they are saved. Imported only if engines are used."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from stepbot.diagnostics import Diagnostics
from stepbot.engines.observation_cache import ObservationCache
from stepbot.formats import format_named
from stepbot.formats.rendering import joined
from stepbot.report.record import Report
from stepbot.robot.model import Robot
from stepbot.runtime.cache import content_digest
from stepbot.runtime.fork_server import ForkServer
from stepbot.runtime.output import write_atomically
from stepbot.runtime.temporary import run_folder
from stepbot.verification import Provers, Written, verify

from .conversion import Options
from .prestart import started_server


class Proof:
    """Engines that will check the files of a conversion; they import while the kernel works."""

    def __init__(self, formats: Sequence[str], options: Options, server: ForkServer | None) -> None:
        """Start them.

        Args:
            formats: The formats to write.
            options: Conversion options.
            server: A process started in advance to start them; None to start one.
        """
        self._options = options
        self._provers = Provers(formats, memory_limit=options.memory_limit, server=server or started_server(options))

    def report(
        self,
        robot: Robot,
        lowered: Mapping[str, Robot],
        files: Mapping[str, Mapping[str, bytes]],
        found: Diagnostics,
    ) -> Report:
        """Verify the files in a temporary folder, before anything in the output folder is changed.

        Args:
            robot: The expected robot.
            lowered: For each format, the robot as that format expresses it.
            files: For each format, the bytes of its files.
            found: Receives SB8xx and SB9xx.
        """
        options = self._options
        with TemporaryDirectory(dir=run_folder()) as folder:
            place = Path(folder) / (
                options.package or options.gazebo
            )  # where `package://` and `model://` find the meshes
            write_atomically(joined(files), place)
            written = {name: Written(place / next(iter(files[name])), one) for name, one in lowered.items()}
            contents = {name: content_digest(of_format) for name, of_format in files.items()}
            for name, one in lowered.items():
                for beside in (one for one in format_named(name).writer.companions(one) if one.format):
                    written[beside.format] = Written(place / beside.path, beside.robot)
                    contents[beside.format] = contents[name]
            observations = ObservationCache(options.cache, contents)
            provers, require, timeout = self._provers, options.require, options.timeout
            return verify(robot, written, provers, found, require=require, timeout=timeout, observations=observations)

    def close(self) -> None:
        """End all processes that still run."""
        self._provers.close()
