"""A robot as one self-contained web page: the scene as JSON, and the page that draws it. For ``pipeline`` and above.

The page needs no server and no network. A server may send it another scene.
"""
