"""Figures that are drawn once to be stored."""

from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine


class Laid(Figure):
    """A figure of which the draw that `savefig` asks for to lay it out does that and draws nothing.

    The layout takes the sizes of its artists by itself; the file is drawn without an engine, and the same.
    """

    def draw(self, renderer):
        engine = self.get_layout_engine()
        if isinstance(engine, ConstrainedLayoutEngine):
            engine.execute(self)
        else:
            super().draw(renderer)
