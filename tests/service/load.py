"""Many clients at once in one thread. Each keeps asking; every answer is counted and timed."""
import random
import selectors
import struct
import time

import wire
from wire import BATCH, INTERACTIVE, Client


class LoadClient:
    """A client that never blocks, and remembers its requests until each has been answered exactly once."""

    def __init__(self, address, model, noise, kind, width, height, encoding=wire.RAW):
        self.client = Client(address, minor=1)
        self.socket = self.client.socket
        self.socket.setblocking(False)
        self.model, self.noise, self.kind = model, noise, kind
        self.shape = {"width": width, "height": height, "encoding": encoding, "kind": kind}
        self.asked = {}  # number of the request: time when it was sent
        self.input, self.output = bytearray(), bytearray()
        self.expected = 0  # bytes of DATA still to come
        self.latencies, self.frames, self.superseded, self.errors = [], 0, 0, []
        self.is_ending = False

    def ask(self):
        if self.is_ending or len(self.asked) >= self.client.credits:
            return
        seq = self.client.next_seq()
        self.asked[seq] = time.monotonic()
        self.output += wire.render(seq, self.model, **self.shape)

    def start(self):
        for _ in range(2 if self.kind == BATCH else 1):
            self.ask()

    def go_on(self):
        """Asks again after an answer. An interactive client sometimes sends more requests than are drawn."""
        if self.kind == BATCH:
            self.ask()
            return
        if not self.asked:
            self.ask()
            if self.noise.random() < 0.3:
                self.ask()

    def answered(self, seq):
        return time.monotonic() - self.asked.pop(seq)  # KeyError: a second answer, or one without a request

    def take(self, kind, flags, seq, body):
        if kind == wire.FRAME:
            self.expected = wire.decode(body)[5][0]
            assert seq in self.asked
        elif kind == wire.DATA:
            self.expected -= len(body)
            if flags & 1:
                assert self.expected == 0
                self.latencies.append(self.answered(seq))
                self.frames += 1
                self.go_on()
        elif kind == wire.SUPERSEDED:
            by = wire.decode(body)[1][0]
            assert by > seq
            self.answered(seq)
            self.superseded += 1
        elif kind == wire.ERROR:
            fields = wire.decode(body)
            self.errors.append((fields[1][0], fields[2][0]))
            self.answered(seq)
            self.go_on()
        else:
            assert kind == wire.PROGRESS, kind

    def read(self):
        try:
            part = self.socket.recv(1 << 20)
        except BlockingIOError:
            return
        if not part:
            raise EOFError("the daemon closed")
        self.input += part
        at = 0
        while len(self.input) - at >= 16:
            kind, flags, length, seq = struct.unpack_from("<BHII", self.input, at + 5)
            if len(self.input) - at < 16 + length:
                break
            self.take(kind, flags, seq, bytes(self.input[at + 16:at + 16 + length]))
            at += 16 + length
        del self.input[:at]

    def write(self):
        while self.output:
            try:
                del self.output[:self.socket.send(self.output)]
            except BlockingIOError:
                return


def run_load(clients, seconds):
    """Lets the clients ask for so many seconds, then waits until every request is answered."""
    selector = selectors.DefaultSelector()
    end = time.monotonic() + seconds
    for client in clients:
        client.is_ending = False
        selector.register(client.socket, selectors.EVENT_READ, client)
        client.start()
        client.write()
    while any(client.asked for client in clients):
        now = time.monotonic()
        if now > end + 60:
            raise AssertionError("requests are left unanswered")
        if now > end:
            for client in clients:
                client.is_ending = True
        for key, _ in selector.select(0.1):
            key.data.read()
            key.data.write()
    selector.close()


def make_clients(addresses, model, n_interactive, n_batch, seed=1):
    noise = random.Random(seed)
    interactive = [LoadClient(addresses[i % len(addresses)], model, noise, INTERACTIVE, 64, 48)
                   for i in range(n_interactive)]
    batch = [LoadClient(addresses[i % len(addresses)], model, noise, BATCH, 800, 600,
                        wire.ZSTD if i % 2 else wire.RAW) for i in range(n_batch)]
    return interactive, batch


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(len(values) * share))]
