"""Figures drawn without a browser: what the page hands to its chart library, as SVG."""
