"""The page of a diagnosis: one file that explains itself, from the files of the diagnosis alone."""
