"""Drawing of the figures of the book's experiments."""

from qtab.book.drawing.colors import METHOD_COLORS, line_colors
from qtab.book.drawing.files import save_plot
from qtab.book.drawing.grids import CellMap, draw_grids, greedy_actions
from qtab.book.drawing.lines import draw_lines
from qtab.book.drawing.surfaces import draw_surfaces

__all__ = [
    "METHOD_COLORS",
    "CellMap",
    "draw_grids",
    "draw_lines",
    "draw_surfaces",
    "greedy_actions",
    "line_colors",
    "save_plot",
]
