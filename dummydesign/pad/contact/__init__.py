"""Contact: surfaces of the pad, punches, plates and the base a pad rests on."""
