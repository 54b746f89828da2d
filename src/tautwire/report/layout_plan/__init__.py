"""The layout plan of a line: plan and elevation true to scale, as SVG, PDF and DXF."""
