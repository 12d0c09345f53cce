"""Components of cabinets and tables: layouts, carcasses, cells, frames."""
