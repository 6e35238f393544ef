"""What every room stands on: errors, files, data files, numbers, the cache of solves; nothing of the field."""
