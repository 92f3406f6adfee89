"""A client that asks for as much as it is given: greedy.py ADDRESS CONNECTIONS WIDTH HEIGHT. Each connection always
has eight unanswered interactive frames. The program prints "begun" when every connection has asked, runs until its
standard input ends, and then prints how many frames it received and how many were replaced."""
import selectors
import sys

import wire
from daemon import CUBE
from load import LoadClient
from wire import INTERACTIVE

IN_FLIGHT = 8


class GreedyClient(LoadClient):
    def __init__(self, address, width, height):
        super().__init__(address, None, None, INTERACTIVE, width, height, wire.ZSTD)
        self.socket.setblocking(True)
        self.model = self.client.upload(CUBE + b"# greedy\n", "cube.obj")
        self.socket.setblocking(False)

    def start(self):
        while len(self.asked) < IN_FLIGHT:
            self.ask()

    def go_on(self):
        self.start()

    def take(self, kind, flags, seq, body):
        super().take(kind, flags, seq, body)
        if kind == wire.SUPERSEDED:
            self.start()


def main():
    address, n, width, height = sys.argv[1], *map(int, sys.argv[2:])
    clients = [GreedyClient(address, width, height) for _ in range(n)]
    selector = selectors.DefaultSelector()
    selector.register(sys.stdin, selectors.EVENT_READ, None)
    for client in clients:
        selector.register(client.socket, selectors.EVENT_READ, client)
        client.start()
        client.write()
    print("begun", flush=True)
    while True:
        for key, _ in selector.select():
            if key.data is None:
                assert not any(client.errors for client in clients)
                print(sum(client.frames for client in clients),
                      sum(client.superseded for client in clients), flush=True)
                return
            key.data.read()
            key.data.write()


if __name__ == "__main__":
    main()
