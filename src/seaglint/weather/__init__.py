"""How often which conditions come, and how often they bring glint."""
