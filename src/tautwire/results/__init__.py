"""Results: frozen data, their files and their origin."""
