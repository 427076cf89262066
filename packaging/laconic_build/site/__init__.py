"""Makes the documentation site: pages of docs/ and references that are generated, put together by Sphinx."""
