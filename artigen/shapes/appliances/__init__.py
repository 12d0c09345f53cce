"""What appliances are built of."""
