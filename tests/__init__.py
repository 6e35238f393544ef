"""Tests of dummydesign."""
