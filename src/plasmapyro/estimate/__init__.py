"""Surface temperature inferred jointly from everything both instruments give. Method: docs/temperature.md."""
