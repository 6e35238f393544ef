"""What-if sweeps: specification, rows, executors."""
