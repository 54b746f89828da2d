"""Published studies as scripts, with a verdict on each of their claims."""
