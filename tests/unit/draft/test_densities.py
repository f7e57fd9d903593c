"""Typical densities by the names of materials in CAD libraries."""

import pytest

from stepbot.draft.text.densities import typical_density


@pytest.mark.parametrize(
    ("name", "density"),
    [
        ("Steel, Mild", 7850), ("zinc plated steel", 7850), ("copper-plated steel", 7850), ("Steel, Galvanized", 7850),
        ("Plain Carbon Steel", 7850), ("AISI 1020 Steel, Cold Rolled", 7850), ("Alloy Steel (SS)", 7850),
        ("S235JR", 7850), ("42CrMo4", 7850), ("1.0037", 7850), ("Werkzeugstahl", 7850), ("Rubber coated steel", 7850),
        ("Stainless Steel AISI 304", 7900), ("Edelstahl 1.4301", 7900), ("Stainless steel, 440C", 7900), ("304", 7900),
        ("X5CrNi18-10", 7900), ("Cast Iron, Grey", 7200), ("Nickel plated brass", 8500), ("Messing CuZn39Pb3", 8500),
        ("Bronze, Soft Tin", 8800), ("Aluminum Bronze", 7700), ("Copper", 8940), ("Aluminum 6061-T6", 2700),
        ("EN AW-7075", 2700), ("6061-T6", 2700), ("AlMg3", 2700), ("alumina", 3900), ("Titanium Ti-6Al-4V", 4430),
        ("Ti-6Al-4V", 4430), ("Magnesium AZ91D", 1800), ("NdFeB N52", 7500), ("ABS 2024", 1050), ("ABS_Plastic", 1050),
        ("PC-ABS", 1150), ("PLA", 1240), ("PLA+", 1240), ("PA12 (SLS)", 1130), ("Nylon 6/6", 1130), ("PA6 GF30", 1360),
        ("glass filled nylon", 1360), ("POM-C", 1410), ("Acrylic (PMMA)", 1190), ("UHMW-PE", 950), ("FR4", 1850),
        ("Silicone Rubber", 1150), ("Carbon Fiber", 1600), ("Wood (Oak)", 700),
        ("S45C", 7850), ("SS400", 7850), ("SCM435", 7850), ("SKD11", 7850), ("SUS304", 7900), ("A5052P-H34", 2700),
        ("A6061-T6", 2700), ("C3604BD", 8500), ("Tungsten Carbide", 14900), ("Tungsten", 19250),
        ("Generic", None), ("Unplated", None), ("", None), ("Material1", None), ("Spaceship", None),
    ],
)  # fmt: skip
def test_typical_densities(name: str, density: float | None) -> None:
    """Names in several languages are recognized by whole words, the longest first, and coatings do not count."""
    typical = typical_density(name)
    assert (typical.density if typical else None) == density
