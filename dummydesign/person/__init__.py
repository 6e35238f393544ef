"""What a press that was measured on a pad would have been on people: drives, persons, intervals, limits."""
