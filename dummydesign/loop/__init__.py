"""Closing the loop: a measured campaign, its residual, the effect the model lacks, and the corrected model."""
