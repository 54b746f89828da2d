"""Parts of the pages about measured runs."""
