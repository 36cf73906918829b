"""Measurements of the product, compared with its targets and its peers."""
