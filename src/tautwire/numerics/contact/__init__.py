"""Where a pantograph meets a wire."""
