"""What acts on bodies, one phenomenon a file: equations and kernels."""
