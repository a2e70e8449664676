"""Many scenes drawn from laws, rendered, and made labelled data sets."""
