"""Campaigns that are planned, pressed and checked, or made from files one has."""
