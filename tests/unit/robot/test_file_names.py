"""Names reserved by file systems."""

import pytest

from stepbot.robot.mesh_names import is_device


@pytest.mark.parametrize("name", ["CON", "nul", "Aux.urdf", "COM1", "lpt9.tar.gz", "com¹", "prn .txt", "CONIN$"])
def test_devices_of_windows(name: str) -> None:
    """Windows' device names are detected in any case and with any extension."""
    assert is_device(name)


@pytest.mark.parametrize("name", ["console", "null", "aux_part", "COM", "COM10", "my.con", "lpt", "arm"])
def test_files(name: str) -> None:
    """A name that only starts or ends like a device is valid."""
    assert not is_device(name)
