"""The labelled set of oscillations: runs, labels measured on the true position, pictures, the metric's confusions."""
