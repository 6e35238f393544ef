"""What is measured next: a plan from an answer of the loop, and what a plan can show."""
