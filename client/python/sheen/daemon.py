"""A private daemon: a child process on a socket pair, which ends with its session."""
from __future__ import annotations

import os
import socket
import subprocess
import tempfile

from sheen.errors import DeviceFailed, Error, Lost, NoServer

END_S = 10  # time to finish after the socket is closed
TERM_S = 2


def _half_of_the_memory() -> int | None:
    """Half of what this machine has; the daemon itself keeps to the limit of its control group."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    except (OSError, ValueError):
        return None


class PrivateDaemon:
    """`sheend`, by $SHEEN_DAEMON or from the PATH, if no program is given."""

    def __init__(self, program: str | None, options: dict[str, str | None], memory_budget: int | None) -> None:
        program = program or os.environ.get("SHEEN_DAEMON") or "sheend"
        budget = memory_budget or _half_of_the_memory()
        ours, theirs = socket.socketpair()
        self.socket = ours
        self._errors = tempfile.TemporaryFile()
        arguments = [program, "--session-fd", str(theirs.fileno())]
        given: list[tuple[str, str | int | None]] = [*options.items(), ("memory-budget", budget), ("peer-memory", budget)]
        for name, value in given:
            if value is not None:
                arguments += ["--" + name, str(value)]
        try:
            self._process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                             stderr=self._errors, pass_fds=[theirs.fileno()])
        except OSError as wrong:
            ours.close()
            self._errors.close()
            raise NoServer(f"cannot start a private daemon ({program}): {wrong.strerror}; install sheend, set "
                           "SHEEN_DAEMON to its path, or name a running one with server=") from None
        finally:
            theirs.close()

    @property
    def pid(self) -> int:
        return self._process.pid

    def explain(self, failure: Error) -> Error:
        """The failure of a lost connection, with the reason if the daemon has ended."""
        try:
            code = self._process.wait(TERM_S)
        except subprocess.TimeoutExpired:
            return failure
        size = os.fstat(self._errors.fileno()).st_size
        tail = os.pread(self._errors.fileno(), 2048, max(0, size - 2048)).decode(errors="replace")
        lines = [line.removeprefix("sheend: ") for line in tail.splitlines() if line.strip()]
        how = f"died of signal {-code}" if code < 0 else f"ended with exit code {code}"
        text = f"the private daemon {how}" + (f": {lines[-1]}" if lines else "")
        return DeviceFailed(text) if code == 5 else Lost(text)

    def end(self) -> None:
        """Waits for the end of the daemon, whose socket is closed."""
        for wait_s, signal in ((END_S, self._process.terminate), (TERM_S, self._process.kill)):
            try:
                self._process.wait(wait_s)
                break
            except subprocess.TimeoutExpired:
                signal()
        self._process.wait()
        self._errors.close()
