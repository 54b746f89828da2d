"""The claims of the paper, section by section, and their evidence."""
