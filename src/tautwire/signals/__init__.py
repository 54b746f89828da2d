"""Pure functions of time series: filters, bands, spectra, contact loss (NumPy and SciPy only)."""
