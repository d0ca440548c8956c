"""Formulas as MathML, which browsers show by themselves: no script, no fonts, no network."""

from docutils.utils.math.latex2mathml import parse_latex_math
from docutils import nodes


def mathml(node, inline):
    tree = parse_latex_math(node.astext(), inline=inline)
    text = "".join(tree.xml())
    return text if inline else f'<div class="formula" role="math">{text}</div>'


def visit_inline(self, node):
    self.body.append(mathml(node, True))
    raise nodes.SkipNode


def visit_block(self, node):
    self.body.append(mathml(node, False))
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", inline_renderers=(visit_inline, None), block_renderers=(visit_block, None))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True}
