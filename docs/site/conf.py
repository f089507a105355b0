"""How Sphinx builds the site; `build.py` gathers what it reads."""

from importlib.metadata import version as installed_version

project = "spheremesh"
copyright = "the spheremesh authors, MIT licence"  # noqa: A001
release = version = installed_version("spheremesh")

extensions = ["myst_parser", "sphinx.ext.mathjax"]
source_suffix = {".md": "markdown"}
root_doc = "index"
highlight_language = "text"
nitpicky = True
smartquotes = False

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

html_theme = "furo"
html_title = f"spheremesh {release}"
html_show_sourcelink = False
html_copy_source = False
