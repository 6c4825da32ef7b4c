"""Pages for the browser: everything about a pair in one file of HTML, without a network.

`document` writes the page, `pictures` draws, `certificate_steps` puts a certificate into words and numbers, and
`elements` makes the elements of HTML, with every string escaped. `page.css` and `page.js` are parts of every page.
docs/command-line.md is about the command `liehom show`, which writes a page.
"""

from liehom.pages.document import pair_page as pair_page

__all__ = ["pair_page"]
