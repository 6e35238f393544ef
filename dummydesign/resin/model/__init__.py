"""A resin: modulus over ratio, liquid properties, distributions and resin files."""
