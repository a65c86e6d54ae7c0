"""Drawing of the figures of the book's experiments."""

from qtab.book.drawing.colors import METHOD_COLORS, line_colors
from qtab.book.drawing.figures import figure_of_several, save_plot
from qtab.book.drawing.grids import CellMap, draw_grids, greedy_actions
from qtab.book.drawing.lines import BROAD, draw_band, draw_in_range, draw_lines, pale
from qtab.book.drawing.panels import Panel, draw_panels

__all__ = [
    "BROAD",
    "METHOD_COLORS",
    "CellMap",
    "Panel",
    "draw_band",
    "draw_grids",
    "draw_in_range",
    "draw_lines",
    "draw_panels",
    "figure_of_several",
    "greedy_actions",
    "line_colors",
    "pale",
    "save_plot",
]
