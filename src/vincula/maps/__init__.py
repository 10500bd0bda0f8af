"""Maps over two variables: where a mechanism reaches, and where it is singular, by type."""
