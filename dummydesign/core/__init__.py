"""What every room uses: errors, files, data files, numbers, the cache of solves; nothing of the field."""
