"""The exceptions of the package. A message is one sentence that names the value at fault and what would be right."""


class Error(Exception):
    """Base of all of them."""


class InvalidInput(Error, ValueError):
    """An image, mesh or option that cannot be used."""


class InvalidOption(InvalidInput):
    """An option outside its range."""


class MeshingFailed(Error, RuntimeError):
    """The input is fine but no mesh could be made of it."""


class Cancelled(Error):
    """The progress callback returned False."""
