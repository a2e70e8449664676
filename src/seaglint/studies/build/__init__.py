"""From a scenario to the records of physics."""
