"""Writes packages as OpenUSD folders in the layout of SimReady assets; requires the optional `usd-core`."""
