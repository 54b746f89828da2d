"""From the blocks of a page to a file: HTML and PDF."""
