"""The only place that knows a scenario and calls the stages."""
