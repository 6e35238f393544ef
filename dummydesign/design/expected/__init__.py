"""What is expected of a pad over its castings and over what is not known of resin and tissue."""
