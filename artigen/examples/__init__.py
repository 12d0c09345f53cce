"""Examples to train and measure networks on: fields, tables, pictures and conditions; shards, batches."""
