"""Typical densities of materials, found by words in a material's name.

A draft marks densities from this table for review. The values are from data sheets, rounded; printed plastics are taken
as solid.
"""

import re
from typing import NamedTuple


class TypicalDensity(NamedTuple):
    """A density and the material that it is typical of."""

    density: float
    """[kg/m^3]."""
    material: str


_TYPICAL: tuple[tuple[str, float, str], ...] = (
    (r"alumi\w*|\balu\b|\balmg\w*|\balsi\w*|\ben ?aw\b|\b[67]0\d\d\b|\b5052\b|\b5083\b|\b2024\b", 2700.0, "aluminium"),
    (r"cast ?iron|gusseisen|\bgjl\b|\bgjs\b", 7200.0, "cast iron"),
    (r"stainless|edelstahl|inox|\baisi ?3\d\d\b|\b1\.4\d{3}\b|\b(304|316|303)l?\b", 7900.0, "stainless steel"),
    (r"brass|messing|laiton|\bcuzn\w*", 8500.0, "brass"),
    (r"bronze|\bcusn\w*", 8800.0, "bronze"),
    (r"copper|kupfer|cuivre|\bcobre\b", 8940.0, "copper"),
    (r"titan\w*|\bti-?6al-?4v\b", 4430.0, "titanium"),
    (r"magnesi\w*|\baz91\w*", 1800.0, "magnesium"),
    (r"zinc|\bzink\b|zamak", 6700.0, "zinc"),
    (r"neodym\w*|\bndfeb\b|magnet", 7500.0, "neodymium magnet"),
    (r"steel|stahl|acier|\bacero\b|acciaio|\b1\.[0-3]\d{3}\b|\bs[23]\d\d\w*|\bc45\w*|\b42crmo4\b", 7850.0, "steel"),
    (r"carbon ?fib\w*|\bcfrp\b|\bcfk\b", 1600.0, "carbon fibre laminate"),
    (r"\bfr-?4\b|\bpcb\b|\bgrp\b|\bgfk\b|fib(er|re)glass", 1850.0, "glass fibre laminate"),
    (r"\babs\b|\basa\b", 1050.0, "ABS"),
    (r"\bpla\b|polylactic", 1240.0, "PLA"),
    (r"\bpetg?\b", 1270.0, "PETG"),
    (r"nylon|polyamid\w*|\bpa ?-?(6|11|12|66)\b|\bpa\b", 1130.0, "nylon"),
    (r"polycarbonat\w*|\bpc\b|lexan|makrolon", 1200.0, "polycarbonate"),
    (r"\bpom\b|delrin|acetal|polyoxymethyl\w*", 1410.0, "POM"),
    (r"acryl\w*|\bpmma\b|plexiglas\w*", 1190.0, "acrylic"),
    (r"\bptfe\b|teflon", 2200.0, "PTFE"),
    (r"\bpeek\b", 1310.0, "PEEK"),
    (r"\bpvc\b", 1400.0, "PVC"),
    (r"\b(hd|ld|uhmw)?-?pe\b|polyethyl\w*", 950.0, "polyethylene"),
    (r"\bpp\b|polypropyl\w*", 905.0, "polypropylene"),
    (r"\btpu\b|\btpe\b", 1200.0, "TPU"),
    (r"silicone?\b|silikon", 1150.0, "silicone rubber"),
    (r"rubber|gummi|\bnbr\b|\bepdm\b|neoprene?", 1200.0, "rubber"),
    (r"plywood|sperrholz", 650.0, "plywood"),
    (r"\bmdf\b", 750.0, "MDF"),
    (r"\bwood\b|\bholz\b|\boak\b|\bpine\b|\bbeech\b", 700.0, "wood"),
    (r"\bglass\b|\bglas\b", 2500.0, "glass"),
    (r"resin|epox\w*|\bsla\b", 1180.0, "resin"),
)  # fmt: skip
"""Patterns in the order in which they are tried: specific materials first."""
_PATTERNS = tuple((re.compile(pattern), TypicalDensity(density, name)) for pattern, density, name in _TYPICAL)


def typical_density(material: str) -> TypicalDensity | None:
    """The typical density of a material by its name; None without a known word."""
    name = re.sub(r"[_/(),;:]+", " ", material.casefold())
    return next((typical for pattern, typical in _PATTERNS if pattern.search(name)), None)
