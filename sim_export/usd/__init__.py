"""Packages as OpenUSD folders in the layout of SimReady assets; needs the optional `usd-core`."""
