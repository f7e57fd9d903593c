"""Volume and moments of B-rep solids by numerical integration over their faces, split at knots."""
