"""Structure of a STEP file: products, occurrences, the component tree, names, colours, materials."""
