"""Motion of rigid bodies: what truth and flight software share."""
