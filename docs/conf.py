"""Sphinx's configuration of the site. ``python docs/build.py`` builds and checks it; ``.ci/run docs`` does all."""

import sys
from pathlib import Path

import qtab

# Lets autosummary import this module by its public name.
sys.modules["qtab.designs"] = qtab.designs

HERE = Path(__file__).parent
ICON = "_site/static/icon.svg"
sys.path.insert(0, str(HERE / "_site" / "extensions"))

project = "qtab"
author = "The qtab developers"
copyright = "2026, the qtab developers"  # noqa: A001 - Sphinx's name
version = release = qtab.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.intersphinx",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    # From docs/_site/extensions:
    "local_mathjax",
    "notebooks",
    "outside_links",
    "playground",
    "public_names",
    "search_words",
    "short_signatures",
]
exclude_patterns = ["_build", "_site", "**/_*.md"]
exclude_patterns += ["notebooks/walkthroughs"]  # downloads of pages that are in Markdown
templates_path = ["_site/templates"]
nitpicky = True
suppress_warnings = [
    "config.cache",  # functions in the configuration
]

# Markdown and notebooks
myst_enable_extensions = ["attrs_block", "attrs_inline", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
myst_links_external_new_tab = False
nb_execution_mode = "force"
nb_execution_timeout = 600
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # the default loads two scripts from a content delivery network
nb_merge_streams = True

# The reference
autosummary_generate = True
autosummary_ignore_module_all = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_mock_imports = ["stable_baselines3", "torch"]
python_use_unqualified_type_names = True
maximum_signature_line_length = 80
napoleon_google_docstring = True
napoleon_numpy_docstring = False
add_module_names = False
# The groups of settings in the docstrings of `train`, `train_many` and `sweep`.
napoleon_custom_sections = [
    (title, "params_style") for title in ("Environment", "Run", "Learning", "Exploration", "Discretizer")
]

# The inventories are kept here because the build has no network. They list only the names that our pages use.
intersphinx_mapping = {
    name: (url, str(HERE / "_site" / "inventories" / f"{name}.txt"))
    for name, url in {
        "python": "https://docs.python.org/3/",
        "numpy": "https://numpy.org/doc/stable/",
        "gymnasium": "https://gymnasium.farama.org/",
        "matplotlib": "https://matplotlib.org/stable/",
        "pandas": "https://pandas.pydata.org/docs/",
        "pyarrow": "https://arrow.apache.org/docs/",
        "stable_baselines3": "https://stable-baselines3.readthedocs.io/en/master/",
    }.items()
}

# Appearance
html_theme = "pydata_sphinx_theme"
html_title = "qtab"
html_static_path = ["_site/static"]
html_css_files = ["site.css"]
html_favicon = ICON
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_search_scorer = str(HERE / "_site" / "extensions" / "search_scorer.js")
html_context = {"default_mode": "auto"}
html_theme_options = {
    "logo": {
        "text": "qtab",
        "image_light": "_site/static/icon.svg",
        "image_dark": "_site/static/icon.svg",
        "alt_text": "",
    },
    "header_links_before_dropdown": 8,
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "navbar_persistent": ["search-button"],
    "navigation_depth": 3,
    "show_toc_level": 2,
    "secondary_sidebar_items": {"**": ["page-toc"], "index": []},
    "footer_start": ["copyright"],
    "footer_center": [],
    "footer_end": ["theme-version"],
    "pygments_light_style": "github-light",
    "pygments_dark_style": "github-dark",
}
html_sidebars = {"index": []}
copybutton_exclude = ".linenos, .gp, .go"
