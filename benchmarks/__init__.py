"""What the product takes, measured beside its targets and its peers."""
