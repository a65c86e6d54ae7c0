"""Drawing of the figures of the book's experiments."""

from qtab.book.drawing.colors import METHOD_COLORS, line_colors
from qtab.book.drawing.files import save_plot
from qtab.book.drawing.grids import CellMap, draw_grids, greedy_actions
from qtab.book.drawing.lines import BROAD, draw_lines
from qtab.book.drawing.panels import Panel, draw_panels
from qtab.book.drawing.surfaces import draw_surfaces
from qtab.book.drawing.titles import title_figure
from qtab.book.drawing.top_labels import label_tops

__all__ = [
    "BROAD",
    "METHOD_COLORS",
    "CellMap",
    "Panel",
    "draw_grids",
    "draw_lines",
    "draw_panels",
    "draw_surfaces",
    "greedy_actions",
    "label_tops",
    "line_colors",
    "save_plot",
    "title_figure",
]
