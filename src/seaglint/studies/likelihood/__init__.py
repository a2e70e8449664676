"""How often glint matters, over weather, Sun and geometry."""
