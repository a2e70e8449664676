"""Air from a profile of pressure, temperature and humidity: sums of LOWTRAN7's band laws along bent rays."""
