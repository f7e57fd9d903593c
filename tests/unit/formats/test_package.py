"""The name of the ROS package that a URDF is in."""

import pytest

from stepbot.formats.urdf.package import package_of


@pytest.mark.parametrize("given", ["arm", "arm_description"])
def test_the_ending_of_a_ros_2_package_is_written_once(given: str) -> None:
    """The name may be given with the ending that the package gets."""
    assert package_of("", given, ["urdf"]) == "arm_description"


@pytest.mark.parametrize("given", ["_description", "Arm", "arm-2"])
def test_an_invalid_name_is_rejected(given: str) -> None:
    """Nothing but the ending is no name."""
    with pytest.raises(ValueError, match="is not the name of a ROS package"):
        package_of("", given, ["urdf"])
