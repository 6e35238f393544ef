"""The server of the studio: start, door, addresses, files that come in and go out."""
