"""How it is computed, on arrays only: the readable NumPy reference of every kernel."""
