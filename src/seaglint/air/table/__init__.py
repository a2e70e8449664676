"""LOWTRAN7 tabulated: the air that ships with seaglint."""
