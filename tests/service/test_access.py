"""Who may connect. A client without credentials is refused and learns nothing."""
import contextlib
import hashlib
import os
import re
import secrets
import shutil
import signal
import socket
import ssl
import stat
import struct
import subprocess
import tempfile
import threading
import time
import unittest

import wire
from authority import Authority, context
from daemon import CUBE, MODELS, SHEEN, SHEEND, Daemon, grid, run
from wire import Client

FENDER = os.path.join(MODELS, "fender.obj")
GONE = "^0$|^ConnectionResetError|^BrokenPipeError"  # the daemon closed without an answer
LATER, EARLIER = "2099-12-31", "2020-02-29"


def token_line(name, token, day=LATER):
    done = subprocess.run([SHEEND, "--hash-token", f"{name}:{day}"], input=token + "\n",
                          capture_output=True, text=True, timeout=20)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="sheen-test-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def write(cls, name, text):
        with open(cls.path(name), "w", encoding="ascii") as file:
            file.write(text)
        return cls.path(name)


def tls_address(daemon):
    return re.search(r"tls:127\.0\.0\.1:\d+", daemon.errors()).group()


class Tls(Case):
    """One daemon that accepts certificates and tokens."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.ours, cls.other = Authority(cls.path("ours")), Authority(cls.path("other"))
        cls.server = cls.ours.issue("server")
        cls.anna = cls.ours.issue("anna", "/CN=anna")
        cls.token, cls.expired = secrets.token_urlsafe(32), secrets.token_urlsafe(32)
        cls.tokens = cls.write("tokens", "# ours\n\n" + token_line("farm", cls.token) +
                               token_line("old", cls.expired, EARLIER))
        cls.daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", cls.server[0], "--tls-key",
                            cls.server[1], "--client-ca", cls.ours.cert, "--tokens", cls.tokens)
        cls.address = tls_address(cls.daemon)

    @classmethod
    def tearDownClass(cls):
        if cls.daemon.stop() != 0:
            raise AssertionError("the daemon did not end well")

    def client(self, pair=None, token=None, **named):
        return Client(self.address, tls=context(self.ours, pair), token=token, **named)

    def raw(self):
        host, port = self.address[4:].rsplit(":", 1)
        one = socket.create_connection((host, int(port)), timeout=10)
        self.addCleanup(one.close)
        return one

    def assert_turned_away(self, words, act):
        """Expects that act() gets no answer, that the log has the reason, and that the daemon still serves."""
        self.daemon.wait_for("msg=listening")
        before = len(self.daemon.errors())
        with self.assertRaises((EOFError, OSError)):
            act()
        end = time.monotonic() + 10
        while "client turned away" not in self.daemon.errors()[before:]:
            self.assertLess(time.monotonic(), end, self.daemon.errors()[before:])
            time.sleep(0.02)
        said = self.daemon.errors()[before:]
        self.assertRegex(said, "client turned away.*" + words)
        self.assertNotIn("client admitted", said)
        with self.client(token=self.token) as client:
            client.stats()

    # --- clients that are admitted

    def test_connections_of_one_certificate(self):
        """Connections are counted for each certificate, whatever address they come from."""
        daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", self.server[0], "--tls-key",
                        self.server[1], "--client-ca", self.ours.cert, "--tokens", self.tokens,
                        "--max-peer-connections", "2")
        address = tls_address(daemon)
        anna, farm = {"tls": context(self.ours, self.anna)}, {"tls": context(self.ours),
                                                              "token": self.token}
        first = Client(address, **anna)
        with first, Client(address, **anna), Client(address, **farm):
            with self.assertRaises(wire.Refused) as caught:
                Client(address, **anna)
            self.assertEqual(caught.exception.code, wire.ERROR_OVERLOADED)
            self.assertIn("cert:CN=anna has as many connections as it may (2)", str(caught.exception))
            with Client(address, **farm) as client:
                client.stats()
            first.socket.close()
            daemon.wait_for('msg="session closed"')
            time.sleep(0.1)
            with Client(address, **anna) as client:
                client.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_certificate(self):
        with self.client(self.anna) as client:
            self.assertEqual(client.socket.version(), "TLSv1.3")
            client.render(client.upload(CUBE, "cube.obj"))
        self.daemon.wait_for('identity="cert:CN=anna"')

    def test_token(self):
        with self.client(token=self.token) as client:
            client.render(client.upload(CUBE, "cube.obj"))
        self.daemon.wait_for("identity=token:farm")

    def test_the_same_bytes_as_without(self):
        """Sends megabytes in both directions, with four requests in flight."""
        sheet = grid(150)
        with self.client(self.anna) as tls, Client(self.daemon.unix) as plain:
            model = tls.upload(sheet, "sheet.obj")
            self.assertEqual(plain.upload(sheet, "sheet.obj"), model)
            want = plain.render(model, 900, 900, planes=3).data
            tls.send(b"".join(wire.render(70 + i, model, 900, 900, planes=3) for i in range(4)))
            for i in range(4):
                self.assertEqual(tls.read_frame(70 + i).data, want)
        self.assertGreater(len(want), 10 << 20)

    def test_many_messages_in_one_record(self):
        with self.client(self.anna) as client:
            client.send(b"".join(wire.message(wire.STATS_QUERY, 100 + i) for i in range(200)))
            for i in range(200):
                client.expect(wire.STATS, 100 + i)

    def test_a_byte_at_a_time(self):
        with self.client(greet=False) as client:
            for byte in wire.hello(token=self.token):
                client.send(bytes([byte]))
            client.expect(wire.HELLO_OK, 1)

    # --- clients that are refused

    def test_nothing_shown(self):
        self.assert_turned_away("neither a certificate", self.client)

    def test_wrong_token(self):
        self.assert_turned_away("not one of the daemon's",
                                lambda: self.client(token=secrets.token_urlsafe(32)))
        self.assert_turned_away("not one of the daemon's", lambda: self.client(token=self.token[1:]))
        self.assert_turned_away("HELLO: token has a zero byte",
                                lambda: self.client(token=self.token + "\0more"))

    def test_expired_token(self):
        self.assert_turned_away("token:old has expired", lambda: self.client(token=self.expired))

    def test_certificate_of_another_authority(self):
        stranger = self.other.issue("anna", "/CN=anna")
        self.assert_turned_away("TLS: ", lambda: self.client(stranger))
        # A valid token does not help a client that presents an invalid certificate.
        self.assert_turned_away("TLS: ", lambda: self.client(stranger, token=self.token))

    def test_expired_certificate(self):
        pair = self.ours.issue("late", seconds=-3600)
        self.assert_turned_away("certificate has expired", lambda: self.client(pair))

    def test_older_tls(self):
        tls = context(self.ours, self.anna)
        tls.maximum_version = ssl.TLSVersion.TLSv1_2
        self.assert_turned_away("TLS: ", lambda: Client(self.address, tls=tls))

    def test_no_tls(self):
        for data in (wire.hello(token=self.token), b"GET / HTTP/1.1\r\n\r\n", bytes(100),
                     b"\x16\x03\x01\xff\xff" + bytes(200)):
            def act(data=data):
                with self.raw() as one:
                    one.sendall(data)
                    answer = b""
                    while part := one.recv(1000):
                        answer += part
                # At most a TLS alert is sent.
                self.assertLess(len(answer), 8)
                raise EOFError

            self.assert_turned_away("TLS: ", act)

    def test_silence(self):
        for greet in (False, True):
            def act(greet=greet):
                start = time.monotonic()
                with (self.client(greet=False).socket if greet else self.raw()) as one:
                    self.assertEqual(one.recv(100), b"")
                self.assertGreater(time.monotonic() - start, 2.5)
                raise EOFError

            self.assert_turned_away("no HELLO", act)

    def crowd(self, address, n, source):
        """Opens so many silent connections from one loopback address."""
        host, port = address[4:].rsplit(":", 1)
        made = [socket.create_connection((host, int(port)), timeout=10, source_address=(source, 0))
                for _ in range(n)]
        for one in made:
            self.addCleanup(one.close)
        return made

    def daemon_of(self, *arguments):
        daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", self.server[0], "--tls-key",
                        self.server[1], "--client-ca", self.ours.cert, "--tokens", self.tokens,
                        *arguments)
        return daemon, tls_address(daemon)

    def test_many_strangers(self):
        """However many connections without credentials there are, and wherever they come from, a client with
        credentials is served at once."""
        daemon, address = self.daemon_of()
        tls = context(self.ours, self.anna)
        for i in range(12):
            crowd = [self.crowd(address, 20, f"127.0.{i + 1}.{k + 2}") for k in range(5)]
            with Client(address, tls=tls) as client:
                client.stats()
            self.assertEqual(crowd[0][0].recv(1), b"")  # closed: the oldest connection of an address that has most
        daemon.wait_for("too many connections that do not say who they are: the oldest leaves")
        with Client(daemon.unix) as client:
            client.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_strangers_of_one_address(self):
        """Connections without credentials replace each other, silent ones first, and never replace others."""
        daemon, address = self.daemon_of("--max-peer-strangers", "3", "--max-penalty", "0",
                                         "--handshake-timeout", "60")
        begun = Client(address, tls=context(self.ours), greet=False)
        silent = self.crowd(address, 2, "127.0.0.1")
        time.sleep(0.2)
        other = self.crowd(address, 1, "127.0.0.9")
        more = self.crowd(address, 2, "127.0.0.1")
        for one in silent:
            self.assertEqual(one.recv(1), b"")
        for one in (*other, *more):
            one.settimeout(0.2)
            with self.assertRaises(TimeoutError):
                one.recv(1)
        begun.send(wire.hello(token=self.token))
        begun.expect(wire.HELLO_OK, 1)
        begun.socket.close()
        self.assertEqual(daemon.stop(), 0)

    def test_penalty(self):
        """An address that repeatedly connects without credentials is refused at once until its penalty is over. One
        connection with valid credentials makes up for a few without."""
        daemon, address = self.daemon_of("--max-penalty", "16")
        tls, port = context(self.ours, self.anna), int(address.rsplit(":", 1)[1])

        def visit(source):
            with socket.create_connection(("127.0.0.1", port), timeout=10,
                                          source_address=(source, 0)) as one:
                one.sendall(b"no TLS at all\n" * 3)
                with contextlib.suppress(OSError):
                    while one.recv(100):
                        pass

        for _ in range(3):
            for _ in range(10):
                visit("127.0.0.1")
            with Client(address, tls=tls) as client:
                client.stats()
        for _ in range(20):
            visit("127.0.0.7")
        daemon.wait_for('msg="an address is turned away for a while: no client of it has credentials" '
                        "address=127.0.0.7")
        self.assertEqual(daemon.errors().count("msg=\"an address is turned away"), 1)
        before = daemon.errors().count('msg="session opened"')
        for _ in range(5):
            visit("127.0.0.7")
        self.assertEqual(daemon.errors().count('msg="session opened"'), before)  # no session was begun
        with Client(address, tls=tls) as client:  # penalties of other addresses do not count for this one
            client.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_a_port_scan(self):
        def act():
            self.raw().close()
            raise EOFError

        self.assert_turned_away("", act)

    def test_nothing_before_hello(self):
        """Within TLS a client without credentials gets nothing either: no ERROR, no version."""
        for data in (wire.message(wire.STATS_QUERY, 1), b"\n" * 16, wire.message(99, 1),
                     wire.message(wire.HELLO, 1, b"short"), wire.hello()[:-3] + b"\xff\xff\xff",
                     wire.message(wire.HELLO, 1, wire.hello()[16:], major=2)):
            def act(data=data):
                with self.client(greet=False) as client:
                    client.send(data)
                    client.read(1)

            self.assert_turned_away("", act)

    def test_a_recorded_connection(self):
        """A replay of all bytes that a client with credentials has sent."""
        recorded = bytearray()
        with socket.create_server(("127.0.0.1", 0)) as relay:
            def pass_on():
                inner, _ = relay.accept()
                outer = self.raw()

                def back():
                    while part := outer.recv(65536):
                        inner.sendall(part)

                threading.Thread(target=back, daemon=True).start()
                while part := inner.recv(65536):
                    recorded.extend(part)
                    outer.sendall(part)
                outer.shutdown(socket.SHUT_WR)

            thread = threading.Thread(target=pass_on)
            thread.start()
            with Client(f"tls:127.0.0.1:{relay.getsockname()[1]}", tls=context(self.ours),
                        token=self.token) as client:
                client.stats()
            thread.join()

        def act():
            with self.raw() as one:
                one.sendall(recorded)
                while one.recv(65536):
                    pass
            raise EOFError

        self.assert_turned_away("TLS: ", act)


def proxy_header(source, command=0x21, family=0x11, extra=b""):
    """PROXY protocol, version 2: TCP over IPv4."""
    body = socket.inet_aton(source) + socket.inet_aton("127.0.0.1") + struct.pack(">HH", 4711, 7410)
    body = (body if family == 0x11 else b"") + extra
    return (b"\r\n\r\n\0\r\nQUIT\n" + bytes([command, family]) + struct.pack(">H", len(body)) + body)


class Balancer(Case):
    """Connections through a load balancer. Only the balancer may tell the client's address."""

    def setUp(self):
        ca = Authority(self.path(self.id()))
        cert, key = ca.issue("server")
        self.tls = context(ca, ca.issue("anna"))
        self.daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", cert, "--tls-key", key,
                             "--client-ca", ca.cert, "--handshake-timeout", "1",
                             "--proxy-from", "127.0.0.2", "--proxy-from", "127.0.1.0/24")
        self.address = tls_address(self.daemon)

    def tearDown(self):
        self.assertEqual(self.daemon.stop(), 0)

    def connect(self, address, source, header):
        host, port = address[4:].rsplit(":", 1)
        one = socket.create_connection((host, int(port)), timeout=10, source_address=(source, 0))
        self.addCleanup(one.close)
        # the daemon may close before the header's end
        with contextlib.suppress(ConnectionResetError, BrokenPipeError):
            for at in range(0, len(header), 9):  # the header arrives in pieces
                one.sendall(header[at:at + 9])
                time.sleep(0.01)
        return one

    def client(self, one, tls=True):
        """A client of wire.py that uses an existing connection."""
        client = Client.__new__(Client)
        client.socket, client.seq = one, 1
        if tls:
            client.socket = self.tls.wrap_socket(one, server_hostname="127.0.0.1")
        client.send(wire.hello(minor=1))
        client.expect(wire.HELLO_OK, 1)
        return client

    def assert_closed(self, one, words):
        with contextlib.suppress(ConnectionResetError):
            while one.recv(1000):
                pass
        self.daemon.wait_for(words)

    def test_the_address_is_the_clients(self):
        for source, header, peer in (
                ("127.0.0.2", proxy_header("192.0.2.7"), "192.0.2.7:4711"),
                ("127.0.1.200", proxy_header("192.0.2.8", extra=b"\x04\0\x01?"), "192.0.2.8:4711"),
                ("127.0.0.2", proxy_header("192.0.2.9", command=0x20), "127.0.0.2:")):
            with self.subTest(header=header):
                self.client(self.connect(self.address, source, header)).stats()
                self.daemon.wait_for(f"peer={peer}")
        # this address is no balancer, so no header is expected
        self.client(self.connect(self.address, "127.0.0.3", b"")).stats()

    def test_plain_tcp_by_address(self):
        """For clients behind a balancer that ends TLS itself, each address is an owner."""
        owners = [self.client(self.connect(self.daemon.tcp, "127.0.0.2", proxy_header(source)), False)
                  for source in ("192.0.2.7", "192.0.2.7", "192.0.2.8")]
        model = owners[0].upload(CUBE, "cube.obj")
        owners[1].render(model)
        with self.assertRaises(wire.Refused) as caught:
            owners[2].render(model)
        self.assertEqual(caught.exception.code, wire.ERROR_UNKNOWN_MODEL)
        self.daemon.wait_for("identity=tcp:192.0.2.7")

    def test_from_anybody_else_a_header_is_refused(self):
        header = proxy_header("192.0.2.7")
        one = self.connect(self.address, "127.0.0.3", header)
        self.assert_closed(one, "TLS: ")
        client = Client.__new__(Client)
        client.socket = self.connect(self.daemon.tcp, "127.0.0.3", header[:9])
        with self.assertRaises(wire.Refused) as caught:
            client.receive()
        self.assertEqual(caught.exception.code, wire.ERROR_PROTOCOL)
        self.assertNotIn("192.0.2.7", self.daemon.errors())

    def test_a_balancer_must_send_one(self):
        for header, words in ((b"SHEN" * 4, "no PROXY header of version 2"),
                              (proxy_header("1.2.3.4", command=0x11), "no PROXY header of version 2"),
                              (proxy_header("1.2.3.4")[:14] + b"\0\x04abcd", "too short"),
                              (b"", "no PROXY header came in time"),
                              (proxy_header("1.2.3.4")[:20], "no PROXY header came in time")):
            for address in (self.address, self.daemon.tcp):
                with self.subTest(header=header, address=address):
                    one = self.connect(address, "127.0.0.2", header)
                    self.assert_closed(one, words)
        self.client(self.connect(self.address, "127.0.0.2", proxy_header("192.0.2.7"))).stats()

    def test_penalties_are_of_clients(self):
        """Penalties apply to the balancer's clients and not to the balancer."""
        for _ in range(20):
            one = self.connect(self.address, "127.0.0.2", proxy_header("192.0.2.66") + b"no TLS" * 9)
            self.assert_closed(one, "")
        self.daemon.wait_for("no client of it has credentials\" address=192.0.2.66")
        self.client(self.connect(self.address, "127.0.0.2", proxy_header("192.0.2.7"))).stats()
        one = self.connect(self.address, "127.0.0.2", proxy_header("192.0.2.66"))
        self.assert_closed(one, "")
        for _ in range(20):  # the balancer's own health checks
            self.connect(self.address, "127.0.0.2", proxy_header("0.0.0.0", command=0x20)).close()
        self.client(self.connect(self.address, "127.0.0.2", proxy_header("192.0.2.7"))).stats()


class Lasting(Case):
    """Credentials that expire, and reloads."""

    def setUp(self):
        shutil.rmtree(self.path("ca"), ignore_errors=True)
        self.ca = Authority(self.path("ca"))
        self.server = self.ca.issue("server")
        self.token = secrets.token_urlsafe(32)
        self.tokens = self.write("tokens", token_line("farm", self.token))

    def start(self, *arguments):
        daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", self.server[0], "--tls-key",
                        self.server[1], *arguments)
        self.address = tls_address(daemon)
        return daemon

    def test_a_certificate_ends_its_session(self):
        daemon = self.start("--client-ca", self.ca.cert)
        brief = self.ca.issue("brief", seconds=4)
        with Client(self.address, tls=context(self.ca, brief)) as client:
            client.stats()
            client.socket.settimeout(10)
            self.assertTrue(client.at_end())
        daemon.wait_for('text="cert:CN=brief has expired"')
        # Without --tokens a client must present a certificate during the handshake.
        with self.assertRaises((EOFError, OSError)):
            Client(self.address, tls=context(self.ca))
        daemon.wait_for("peer did not return a certificate")
        self.assertEqual(daemon.stop(), 0)

    def test_a_revoked_certificate(self):
        """A client with a revoked certificate is refused, and a reload closes its existing connections, but no
        others."""
        anna, berta = (context(self.ca, self.ca.issue(name)) for name in ("anna", "berta"))
        daemon = self.start("--client-ca", self.ca.cert, "--tls-crl", self.ca.revoke())
        with Client(self.address, tls=anna) as first, Client(self.address, tls=berta) as other:
            first.stats()
            self.ca.revoke("anna")
            daemon.process.send_signal(signal.SIGHUP)
            self.assertTrue(first.at_end())
            self.assertRegex(daemon.errors(), 'client turned away.*text="certificate revoked"')
            other.stats()
        with self.assertRaises((EOFError, OSError)):
            Client(self.address, tls=anna)
        daemon.wait_for("TLS: certificate verify failed: certificate revoked")
        with Client(self.address, tls=berta) as client:
            client.stats()
            self.write("ca/crl.pem", "no list\n")
            daemon.process.send_signal(signal.SIGHUP)
            self.assertIn("revocation list " + self.path("ca/crl.pem"),
                          daemon.wait_for("the old one stays"))
            client.stats()
            self.ca.revoke(due=1)
            time.sleep(1.5)
            daemon.process.send_signal(signal.SIGHUP)
            self.assertTrue(client.at_end())
            daemon.wait_for('text="CRL has expired"')
        self.assertEqual(daemon.stop(), 0)

    def test_a_new_authority(self):
        """A reload closes connections that only the previous authority would admit."""
        authority = self.path("authority.pem")
        shutil.copy(self.ca.cert, authority)
        shutil.rmtree(self.path("next"), ignore_errors=True)
        daemon = self.start("--client-ca", authority)
        with Client(self.address, tls=context(self.ca, self.ca.issue("anna"))) as client:
            client.stats()
            shutil.copy(Authority(self.path("next")).cert, authority)
            daemon.process.send_signal(signal.SIGHUP)
            self.assertTrue(client.at_end())
            daemon.wait_for('client turned away" session=1')
        self.assertEqual(daemon.stop(), 0)

    def test_tokens_reload(self):
        daemon = self.start("--tokens", self.tokens)
        tls = context(self.ca)
        with Client(self.address, tls=tls, token=self.token) as client:
            self.write("tokens", "farm\n")
            daemon.process.send_signal(signal.SIGHUP)
            daemon.wait_for(f"{self.tokens}:1: a line is")
            client.stats()
            fresh = secrets.token_urlsafe(32)
            self.write("tokens", token_line("farm", fresh))  # the same name with another token
            daemon.process.send_signal(signal.SIGHUP)
            self.assertTrue(client.at_end())
            daemon.wait_for('text="token:farm has been taken back"')
        with self.assertRaises((EOFError, OSError)):
            Client(self.address, tls=tls, token=self.token)
        with Client(self.address, tls=tls, token=fresh) as client:
            client.stats()
            self.write("tokens", token_line("farm", fresh, EARLIER))
            daemon.process.send_signal(signal.SIGHUP)
            self.assertTrue(client.at_end())
            daemon.wait_for('text="token:farm has expired"')
        self.assertEqual(daemon.stop(), 0)

    def test_certificates_reload(self):
        daemon = self.start("--tokens", self.tokens)

        def served():
            with Client(self.address, tls=context(self.ca), token=self.token) as client:
                return client.socket.getpeercert()["serialNumber"]

        first = served()
        with Client(self.address, tls=context(self.ca), token=self.token) as client:
            self.ca.issue("server")
            daemon.process.send_signal(signal.SIGHUP)
            daemon.wait_for("configuration reloaded")
            self.assertNotEqual(served(), first)
            with open(self.server[0], "w", encoding="ascii") as file:
                file.write("no certificate\n")
            daemon.process.send_signal(signal.SIGHUP)
            self.assertIn(self.server[0], daemon.wait_for("the old one stays"))
            self.assertNotEqual(served(), first)
            client.stats()  # connections remain after their certificate's file was replaced
        self.assertEqual(daemon.stop(), 0)


class Starts(Case):
    """A daemon that would admit everybody does not start; the error text names the options to set."""

    def assert_refused(self, words, *arguments, check=("--check-config",)):
        done = run("--device", "software", *arguments, *check)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(words, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_tls(self):
        ca, other_ca = Authority(self.path("ca")), Authority(self.path("other"))
        cert, key = ca.issue("server")
        other_key = ca.issue("other")[1]
        listen = ("--listen", "tls:0.0.0.0:0")
        own = ("--tls-cert", cert, "--tls-key", key)
        self.assert_refused("use tls:0.0.0.0:0 with --tls-cert", "--listen", "tcp:0.0.0.0:0")
        self.assert_refused("needs --tls-cert and --tls-key", *listen)
        self.assert_refused("come together", *listen, "--tls-cert", cert)
        for check in (("--check-config",), ()):
            self.assert_refused("needs --client-ca", *listen, *own, check=check)
        self.assert_refused("loopback", "--metrics", "tls:127.0.0.1:0")
        for words, arguments in (("no-such", ("--tls-cert", self.path("no-such"), "--tls-key", key)),
                                 ("server.pem", ("--tls-cert", cert, "--tls-key", cert)),
                                 ("other.key", ("--tls-cert", cert, "--tls-key", other_key)),
                                 ("no-such", (*own, "--client-ca", self.path("no-such"))),
                                 ("no-such", (*own, "--client-ca", ca.cert, "--tls-crl",
                                              self.path("no-such"))),
                                 ("revocation list", (*own, "--client-ca", ca.cert, "--tls-crl", cert)),
                                 ("by another authority", (*own, "--client-ca", ca.cert, "--tls-crl",
                                                           other_ca.revoke())),
                                 ("--client-ca, which is missing", (*own, "--tls-crl", ca.revoke())),
                                 ("no-such", (*own, "--tokens", self.path("no-such"))),
                                 ("no plain file", ("--tls-cert", self.path(""), "--tls-key", key)),
                                 ("no plain file", (*own, "--client-ca", self.path(""))),
                                 ("no plain file", (*own, "--tokens", self.path("")))):
            self.assert_refused(words, *listen, *arguments)
        os.chmod(key, 0o644)
        self.assert_refused("chmod", *listen, *own, "--client-ca", ca.cert)
        os.chmod(key, 0o640)
        done = run(*listen, *own, "--client-ca", ca.cert, "--check-config")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_token_files(self):
        good = token_line("a", "x" * 32)
        for number, text in ((1, "a\n"), (1, "a " + 64 * "0" + "\n"),
                             (1, "a " + 63 * "0" + " 2030-01-01\n"),
                             (1, "a " + 64 * "G" + " 2030-01-01\n"),
                             (1, "a " + 64 * "0" + " 2030-02-30\n"),
                             (1, "a " + 64 * "0" + " tomorrow\n"),
                             (1, "a " + 64 * "0" + " 2030-01-01 more\n"),
                             (1, "a/b " + 64 * "0" + " 2030-01-01\n"), (1, 300 * "a" + "\n"),
                             (2, good + good), (3, "#\n" + good + "b " + 64 * "0" + "\n")):
            with self.subTest(text=text):
                path = self.write("tokens", text)
                self.assert_refused(f"{path}:{number}: ", "--tokens", path)
        many = "".join(f"n{i} {'0' * 64} 2030-01-01\n" for i in range(1025))
        self.assert_refused("tokens:1025: ", "--tokens", self.write("tokens", many))

    def test_hash_token(self):
        self.assertEqual(
            token_line("farm", "correct-horse-battery-staple-0123"),
            "farm " + hashlib.sha256(b"correct-horse-battery-staple-0123").hexdigest() +
            " 2099-12-31\n")
        for spec, token in (("farm", "x" * 32), ("farm:soon", "x" * 32), (":2030-01-01", "x" * 32),
                            ("a b:2030-01-01", "x" * 32), ("farm:2030-01-01", "x" * 31),
                            ("farm:2030-01-01", "x" * 256), ("farm:2030-01-01", ""),
                            ("farm:2030-01-01", "x" * 40 + " y")):
            done = subprocess.run([SHEEND, "--hash-token", spec], input=token, text=True,
                                  capture_output=True, timeout=20)
            self.assertEqual((done.returncode, done.stdout), (2, ""), (spec, token))
            self.assertNotIn("xx", done.stderr)

    def test_lists(self):
        for value in ("-1", "root", "4294967295", "1.5"):
            self.assert_refused("no number of a user", "--allow-uid", value)
        self.assert_refused("at most 64", *(65 * ("--allow-gid", "1")))


class Peers(Case):
    def turned_away(self, daemon):
        with self.assertRaises((EOFError, OSError)):
            Client(daemon.unix)
        daemon.wait_for(f"user {os.getuid()} is in neither allow-uid nor allow-gid")

    def test_lists(self):
        """With a list, the users on it are admitted and no others."""
        uid, gid = str(os.getuid()), str(os.getgid())
        for arguments, welcome in ((("--allow-uid", "4242"), False), (("--allow-gid", "4242"), False),
                                   (("--allow-uid", "4242", "--allow-uid", uid), True),
                                   (("--allow-uid", "4242", "--allow-gid", gid), True)):
            with self.subTest(arguments=arguments):
                daemon = Daemon(*arguments, tcp=False)
                self.assertEqual(stat.S_IMODE(os.stat(daemon.path).st_mode), 0o666)
                if welcome:
                    with Client(daemon.unix) as client:
                        client.render(client.upload(CUBE, "cube.obj"))
                else:
                    self.turned_away(daemon)
                self.assertEqual(daemon.stop(), 0)

    def test_reload(self):
        config = self.write("sheend.conf", "")
        daemon = Daemon("--config", config, tcp=False)
        with Client(daemon.unix) as client:
            self.write("sheend.conf", "allow-uid = 4242\n")
            daemon.process.send_signal(signal.SIGHUP)
            self.assertTrue(client.at_end())
        self.turned_away(daemon)
        self.write("sheend.conf", "")
        daemon.process.send_signal(signal.SIGHUP)
        end = time.monotonic() + 10
        while stat.S_IMODE(os.stat(daemon.path).st_mode) != 0o600:
            self.assertLess(time.monotonic(), end)
        with Client(daemon.unix) as client:
            client.stats()
        self.assertEqual(daemon.stop(), 0)

    def try_as(self, uid, group=65534):
        """Connects as this user to the socket "s" and sends HELLO. Returns the number of bytes of the answer, or the
        failure."""
        script = ("import os, socket, sys\n"
                  "os.setgroups([int(sys.argv[2])]); os.setgid(65534); os.setuid(int(sys.argv[3]))\n"
                  "s = socket.socket(socket.AF_UNIX); s.connect(sys.argv[1])\n"
                  "s.sendall(bytes.fromhex(sys.argv[4])); print(len(s.recv(4096)))\n")
        done = subprocess.run(["/usr/bin/python3", "-c", script, self.path("s"), str(group),
                               str(uid), wire.hello().hex()], capture_output=True, text=True,
                              timeout=20)
        return done.stdout.strip() or done.stderr.splitlines()[-1]

    @unittest.skipUnless(os.getuid() == 0, "only root can be somebody else")
    def test_another_user(self):
        os.chmod(self.folder, 0o755)
        daemon = Daemon(path=self.path("s"), tcp=False)
        self.assertIn("PermissionError", self.try_as(1234))
        self.assertEqual(daemon.stop(), 0)
        daemon = Daemon("--allow-uid", "1234", "--allow-gid", "777", path=self.path("s"), tcp=False)
        self.assertGreater(int(self.try_as(1234)), 16)
        self.assertGreater(int(self.try_as(1235, group=777)), 16, "a group that is not its first")
        self.assertRegex(self.try_as(1235), GONE)
        daemon.wait_for("user 1235 is in neither")
        self.assertEqual(daemon.stop(), 0)

    def in_namespace(self, *options, **named):
        """A daemon within a user namespace."""
        under = ["unshare", "--user", *options]
        done = subprocess.run([*under, "true"], capture_output=True, text=True, timeout=20)
        if done.returncode != 0:
            self.skipTest(f"no user namespace here: {done.stderr.strip()}")
        return Daemon(*named.pop("arguments", ()), tcp=False, under=under, **named)

    def assert_hidden(self, daemon):
        said = daemon.wait_for("client turned away")
        self.assertRegex(said, r"its user is \d+, as are all users that .* does not map: run sheend "
                               r"where they are mapped .*PrivateUsers=.*tokens")
        self.assertNotIn("session opened", said)

    def test_users_that_cannot_be_told_apart(self):
        """No user is mapped: all users of the machine have the same number there, also the only one of the list."""
        with open("/proc/sys/kernel/overflowuid", encoding="ascii") as file:
            overflow = file.read().strip()
        for arguments in ((), ("--allow-uid", overflow), ("--allow-gid", overflow)):
            with self.subTest(arguments=arguments):
                daemon = self.in_namespace(arguments=arguments)
                with self.assertRaises((EOFError, OSError)):
                    Client(daemon.unix)
                self.assert_hidden(daemon)
                self.assertEqual(daemon.stop(), 0)

    def test_the_mapped_user_of_a_namespace(self):
        daemon = self.in_namespace("--map-root-user")
        with Client(daemon.unix) as client:
            client.render(client.upload(CUBE, "cube.obj"))
        self.assertIn("identity=uid:0", daemon.errors())
        self.assertEqual(daemon.stop(), 0)

    @unittest.skipUnless(os.getuid() == 0, "only root can be somebody else")
    def test_another_user_of_a_namespace(self):
        os.chmod(self.folder, 0o755)
        with open("/proc/sys/kernel/overflowuid", encoding="ascii") as file:
            overflow = file.read().strip()
        # A group that is not mapped never counts as listed, whoever is in it.
        daemon = self.in_namespace("--map-root-user", path=self.path("s"),
                                   arguments=("--allow-uid", overflow, "--allow-gid", overflow))
        self.assertRegex(self.try_as(1234), GONE)
        self.assert_hidden(daemon)
        self.assertRegex(self.try_as(0, group=777), GONE)
        daemon.wait_for("user 0 is in neither allow-uid nor allow-gid")
        self.assertEqual(daemon.stop(), 0)


class ClientCommand(Case):
    """The command sheen over TLS."""

    def test_it(self):
        ca, other = Authority(self.path("ca")), Authority(self.path("other"))
        cert, key = ca.issue("server")
        anna = ca.issue("anna")
        token = secrets.token_urlsafe(32)
        token_file = self.write("token", token + "\n")
        wrong_file = self.write("wrong", secrets.token_urlsafe(32))
        tokens = self.write("tokens", token_line("farm", token))
        daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", cert, "--tls-key", key,
                        "--client-ca", ca.cert, "--tokens", tokens)
        address = tls_address(daemon)

        def sheen(*arguments, env=None):
            return subprocess.run([SHEEN, "render", FENDER, "-o", self.path("a.png"), "--size",
                                   "320x240", "-q", *arguments], capture_output=True, text=True,
                                  timeout=60, env={**os.environ, **(env or {})})

        def assert_fails(code, words, *arguments):
            done = sheen(*arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertRegex(done.stderr, words)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

        self.assertEqual(sheen("--server", daemon.unix).returncode, 0)
        with open(self.path("a.png"), "rb") as file:
            want = file.read()
        ours = ("--server", address, "--ca", ca.cert)
        for arguments, env in ((("--cert", anna[0], "--key", anna[1]), None),
                               (("--token-file", token_file), None),
                               ((), {"SHEEN_TOKEN_FILE": token_file})):
            os.unlink(self.path("a.png"))
            done = sheen(*ours, *arguments, env=env)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(self.path("a.png"), "rb") as file:
                self.assertEqual(file.read(), want)
        # The text tells on which side the cause is.
        stranger = "lost server: .*; it may not know this client: see --cert and --key, or --token-file"
        distrust = "lost server: TLS: certificate verify failed: .*{}.*; this client does not trust the server: see --ca"
        assert_fails(4, stranger, *ours)
        assert_fails(4, stranger, *ours, "--token-file", wrong_file)
        assert_fails(4, distrust.format(""), "--server", address, "--ca", other.cert,
                     "--token-file", token_file)
        assert_fails(4, distrust.format(""), "--server", address, "--token-file", token_file)
        assert_fails(4, distrust.format("mismatch"), "--server",
                     address.replace("127.0.0.1", "localhost"), "--ca", ca.cert, "--token-file",
                     token_file)
        assert_fails(4, "lost server: TLS: wrong version.*; that port may not speak TLS", "--server",
                     daemon.tcp.replace("tcp:", "tls:"), "--ca", ca.cert, "--token-file", token_file)
        assert_fails(4, "lost server: .*; if that port speaks TLS, write tls: for tcp:", "--server",
                     address.replace("tls:", "tcp:"))
        assert_fails(2, "no-such", "--server", address, "--ca", self.path("no-such"))
        assert_fails(2, "no-such", *ours, "--token-file", self.path("no-such"))
        assert_fails(2, "come together", *ours, "--cert", anna[0])
        self.assertEqual(daemon.stop(), 0)
