"""A case as a workbook: read, completed, written."""
