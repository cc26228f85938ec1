"""Flow fields of other programs: files in, sight line out; and our own flow as a file that others read."""
