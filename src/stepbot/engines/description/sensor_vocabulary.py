"""What is read of a sensor in SDFormat, and in the `<gazebo>` blocks of a URDF: http://sdformat.org/spec?elem=sensor."""

_LIDAR = {
    "": "",
    "scan": "",
    "scan/horizontal": "",
    "scan/horizontal/samples": "",
    "scan/horizontal/min_angle": "",
    "scan/horizontal/max_angle": "",
    "scan/vertical": "",
    "scan/vertical/samples": "",
    "range": "",
    "range/min": "",
    "range/max": "",
}

SENSOR = {
    "": "name type",
    "pose": "relative_to degrees rotation_format",
    "update_rate": "",
    "topic": "",  # topics and frames of messages are named anew
    "gz_frame_id": "",
    "force_torque": "",
    "force_torque/frame": "",
    "force_torque/measure_direction": "",
    "camera": "name",
    "camera/pose": "relative_to degrees rotation_format",
    "camera/horizontal_fov": "",
    "camera/image": "",
    "camera/image/width": "",
    "camera/image/height": "",
    "camera/clip": "",
    "camera/clip/near": "",
    "camera/clip/far": "",
    "contact": "",
    "contact/collision": "",
    **{f"{tag}/{path}".rstrip("/"): names for tag in ("lidar", "ray") for path, names in _LIDAR.items()},
}
"""Paths below ``<sensor>`` and the attributes that are read."""
