"""What pictures share: their data, figures and axes, colors, labels, lines at known returns, and panels of tables."""
