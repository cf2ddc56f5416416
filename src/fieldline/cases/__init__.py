"""One file per paper: its set-ups as plain functions that return Datasets."""
