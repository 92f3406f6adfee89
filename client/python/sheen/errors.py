"""What can fail. Every failure is a sheen.Error with the exit code with which the `sheen` command would end."""


class Error(Exception):
    """A failure: its text is one line that says what failed and what to do."""
    status = "error"
    exit_code = 4
    is_fatal = False  # True: the session can only be closed


class BadArgument(Error, ValueError):
    """Refused by this package; nothing was sent."""
    status, exit_code = "bad-argument", 2


class BadRequest(Error, ValueError):
    """Refused by the daemon: a value is out of its limits."""
    status, exit_code = "bad-request", 2


class BadModel(Error):
    """The cage is bad or not supported, or there is no such file."""
    status, exit_code = "bad-model", 3


class BadImage(Error):
    """An image is bad, or a file cannot be written."""
    status, exit_code = "bad-image", 3


class TooBig(Error):
    """The file exceeds the daemon's limit."""
    status, exit_code = "too-big", 3


class UnknownModel(Error):
    """The daemon does not have the file: upload it."""
    status = "unknown-model"


class Overloaded(Error):
    """The daemon is full: try later."""
    status = "overloaded"


class Superseded(Error):
    """A newer request of the same view has replaced this one."""
    status = "superseded"


class Cancelled(Error):
    """The request was cancelled."""
    status = "cancelled"


class Late(Error, TimeoutError):
    """Not drawn within its deadline."""
    status = "late"


class GpuLost(Error):
    """The daemon's GPU was lost repeatedly."""
    status = "gpu-lost"


class DeviceFailed(Error):
    """EGL or the GPU failed, or there is none."""
    status, exit_code = "device-failed", 5


class NoServer(Error, ConnectionError):
    """Cannot connect, or cannot start a private daemon."""
    status, is_fatal = "no-server", True


class Lost(Error, ConnectionError):
    """The connection broke, or the daemon ended."""
    status, is_fatal = "lost-server", True


class ShuttingDown(Lost):
    """The daemon is shutting down."""
    status = "shutting-down"


class Timeout(Error, TimeoutError):
    """No byte was transferred for `timeout` seconds."""
    status, is_fatal = "timeout", True


class BadPeer(Error, ConnectionError):
    """The daemon broke the protocol."""
    status, is_fatal = "bad-peer", True


class BadVersion(BadPeer):
    """The daemon speaks another major version."""
    status = "bad-version"
