"""One body at a time: healed, sewn, meshed, stitched, mirrored, its exact mass properties integrated."""
