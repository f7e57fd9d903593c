"""Which names no file can have."""

import pytest

from stepbot.robot.file_names import is_device


@pytest.mark.parametrize("name", ["CON", "nul", "Aux.urdf", "COM1", "lpt9.tar.gz", "com¹", "prn .txt", "CONIN$"])
def test_devices_of_windows(name: str) -> None:
    """Windows opens a device for any case and extension."""
    assert is_device(name)


@pytest.mark.parametrize("name", ["console", "null", "aux_part", "COM", "COM10", "my.con", "lpt", "arm"])
def test_files(name: str) -> None:
    """What only begins or ends like a device is a file."""
    assert not is_device(name)
