"""Generators that the build runs, a folder for each: none of them has an `__init__.py` of its own.

`c`        the two-file core and the packages of embedded tools from core_c; needs Python alone
`page`     build/page/laconic.html and the npm package, byte for byte the same at every run
`release`  the folder that is given to others: archives, checksums, licences, bill of materials
`site`     the documentation: pages of docs/ and references that are generated, put together by Sphinx
`wheel`    from a build tree, or from sources and a cross compiler, to wheels that need neither
`wire`     from `laconic.dbc` to C tables for the node and the page docs/wire.md
"""
