"""The STEP file as text and entities: Part 21, strings, encodings, units, dangling references."""
