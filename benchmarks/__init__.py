"""Speed and size: each script prints what it measured; medians of at least five."""
