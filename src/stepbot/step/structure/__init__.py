"""What a STEP file says about structure: products, occurrences, the component tree, names, colours, materials."""
