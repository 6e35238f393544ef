"""What commands write: of one question only, whole or not at all, with a manifest."""
