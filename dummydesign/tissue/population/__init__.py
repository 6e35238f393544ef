"""From subjects to a tissue: traces, digitised points, posterior, the next measurement."""
