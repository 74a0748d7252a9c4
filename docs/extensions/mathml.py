"""Equations of the manual as MathML, made while it is built."""

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.util.math import get_node_equation_number


def setup(app):
    """Offer the renderer `mathml` to `html_math_renderer`.

    Parameters
    ----------
    app : sphinx.application.Sphinx
    """
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def _inline(page, node):
    page.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _block(page, node):
    page.body.append(page.starttag(node, "div", CLASS="math"))
    if node["number"]:
        page.body.append(f'<span class="eqno">({get_node_equation_number(page, node)})')
        page.add_permalink_ref(node, "Link to this equation")
        page.body.append("</span>")
    page.body.append(convert(node.astext(), display="block"))
    page.body.append("</div>\n")
    raise nodes.SkipNode
