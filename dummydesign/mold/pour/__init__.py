"""The pour: amounts, levels, cautions."""
