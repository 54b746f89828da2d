"""Commands about what goes in: cases, catalogue, limits, span tables, own lines."""
