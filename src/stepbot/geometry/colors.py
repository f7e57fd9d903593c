"""Channels of colours: sRGB, as in CAD programs and URDF, and linear, as in USD and glTF (IEC 61966-2-1)."""


def srgb_from_linear(channel: float) -> float:
    """A channel of sRGB, 0 to 1, from a linear one."""
    return 12.92 * channel if channel <= 0.0031308 else 1.055 * float(channel) ** (1.0 / 2.4) - 0.055


def linear_from_srgb(channel: float) -> float:
    """A linear channel, 0 to 1, from one of sRGB."""
    return channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4
