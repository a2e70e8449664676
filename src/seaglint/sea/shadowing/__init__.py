"""Which waves are hidden from a viewer or from the Sun by others."""
