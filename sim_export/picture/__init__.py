"""Pictures of packages, and the view in the browser."""
