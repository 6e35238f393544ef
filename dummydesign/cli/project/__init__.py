"""Commands about the project folder: make one, say where it stands, open it in the browser."""
