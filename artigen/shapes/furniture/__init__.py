"""What cabinets and tables are built of."""
