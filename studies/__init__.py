"""What builds shipped tables, data files and documents; nothing that runs imports it."""
