"""Files that strangers give us: readers, writers, limits and the report of what was read."""
