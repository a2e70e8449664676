"""What a file holds: sequences, maps, scenarios and recordings described."""
