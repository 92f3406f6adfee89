"""To whom a model belongs, and model files in the daemon's own folder."""
import os
import re
import secrets
import subprocess
import time
import unittest

import wire
from authority import Authority, context
from daemon import CUBE, SHEEN, Daemon, budget, grid
from test_access import Case, tls_address, token_line
from test_operations import get, metrics_address, read_metrics
from wire import Client


class Owners(Case):
    def assert_unknown(self, client, model, **named):
        with self.assertRaises(wire.Refused) as caught:
            client.render(model, **named)
        self.assertEqual(caught.exception.code, wire.ERROR_UNKNOWN_MODEL)
        with self.assertRaises(wire.Refused) as caught:
            client.query(model)
        self.assertEqual(caught.exception.code, wire.ERROR_UNKNOWN_MODEL)

    def assert_unsent(self, client, data, **named):
        """Expects that the daemon asks for the whole file, as if it had never seen it."""
        seq = client.next_seq()
        client.send(wire.upload_begin(seq, wire.hashlib.sha256(data).digest(), len(data), "x.obj",
                                      **named))
        self.assertEqual(client.expect(wire.UPLOAD_STATE, seq), {1: [0], 2: [0]})
        client.send(wire.message(wire.UPLOAD_CHUNK, seq, data))
        client.expect(wire.UPLOAD_STATE, seq)

    def test_a_hash_opens_nothing(self):
        daemon = Daemon()
        with Client(daemon.unix) as owner, Client(daemon.unix) as again, Client(daemon.tcp) as other:
            model = owner.upload(CUBE, "secret-name.obj")
            want = owner.render(model).data
            self.assertEqual(again.render(model).data, want)  # another connection of the same user
            self.assert_unknown(other, model)
            self.assert_unsent(other, CUBE)
            self.assertEqual(other.render(model).data, want)
            self.assertEqual(other.query(model)[2], [b"x.obj"])
            self.assertEqual(owner.query(model)[2], [b"secret-name.obj"])
            self.assertEqual(owner.stats()[5], [2])
        self.assertEqual(daemon.stop(), 0)

    def test_light_images_too(self):
        daemon = Daemon()
        with Client(daemon.unix) as owner, Client(daemon.tcp) as other:
            png = owner.render(owner.upload(CUBE, "cube.obj"), encoding=wire.PNG).data
            image = owner.upload(png, "light.png", wire.IMAGE)
            light = wire.field(5, wire.field(6, wire.field(1, wire.PATTERN_IMAGE) +
                                             wire.field(6, image)))
            model = other.upload(CUBE, "cube.obj")
            owner.render(model, extra=light)
            with self.assertRaises(wire.Refused) as caught:
                other.render(model, extra=light)
            self.assertEqual(caught.exception.code, wire.ERROR_UNKNOWN_MODEL)
            self.assertIn("no image", caught.exception.text)
        self.assertEqual(daemon.stop(), 0)

    def test_tokens_are_owners(self):
        ca = Authority(self.path("ca"))
        cert, key = ca.issue("server")
        one, two = secrets.token_urlsafe(32), secrets.token_urlsafe(32)
        tokens = self.write("tokens", token_line("one", one) + token_line("two", two))
        anna, ben = ca.issue("anna"), ca.issue("ben")
        daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", cert, "--tls-key", key,
                        "--tokens", tokens, "--client-ca", ca.cert)
        address = tls_address(daemon)

        def client(token=None, pair=None):
            return Client(address, tls=context(ca, pair), token=token)

        with client(one) as a, client(one) as b, client(two) as c, client(pair=anna) as d, \
                client(pair=anna) as e, client(pair=ben) as f, Client(daemon.unix) as g:
            model = a.upload(CUBE, "cube.obj")
            b.render(model)
            for other in (c, d, e, f, g):
                self.assert_unknown(other, model)
            d.upload(CUBE, "cube.obj")
            e.render(model)
            self.assert_unknown(f, model)
        self.assertEqual(daemon.stop(), 0)

    def test_one_subject_of_two_authorities(self):
        """An identity of the same name from another authority is another person, even if the authorities have the
        same name."""
        ours, theirs = Authority(self.path("ours")), Authority(self.path("theirs"))
        both = self.path("both.pem")
        with open(both, "w", encoding="ascii") as bundle:
            for authority in (ours, theirs):
                with open(authority.cert, encoding="ascii") as file:
                    bundle.write(file.read())
        cert, key = ours.issue("server")
        daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", cert, "--tls-key", key,
                        "--client-ca", both)
        pairs = [authority.issue(name, "/CN=anna")
                 for authority, name in ((ours, "anna"), (ours, "renewed"), (theirs, "anna"))]
        anna, renewed, other = [Client(tls_address(daemon), tls=context(ours, pair))
                                for pair in pairs]
        with anna, renewed, other:
            model = anna.upload(CUBE, "cube.obj")
            renewed.render(model)
            self.assert_unknown(other, model)
            self.assert_unsent(other, CUBE)
        self.assertEqual(daemon.errors().count('identity="cert:CN=anna" issuer="CN=authority"'), 3)
        self.assertEqual(daemon.stop(), 0)

    def test_shared_by_its_owner(self):
        daemon = Daemon()
        with Client(daemon.unix) as owner, Client(daemon.tcp) as other:
            model = owner.upload(CUBE, "cube.obj", share=True)
            other.render(model)
            self.assertEqual(owner.stats()[5], [1])
            # Later, without another upload.
            more = CUBE + b"# more\n"
            model = owner.upload(more, "more.obj")
            self.assert_unknown(other, model)
            sent = owner.stats()[8]
            owner.upload(more, "more.obj", share=True)
            self.assertEqual(owner.stats()[8], sent)
            other.render(model)
        self.assertEqual(daemon.stop(), 0)

    def test_a_wrong_name_spoils_nothing(self):
        """The file name's extension tells the format. A client that was first with a wrong extension, perhaps on
        purpose, must not decide for others who use the right one."""
        folder = self.path("models")
        os.makedirs(folder)
        with open(os.path.join(folder, "cube.obj"), "wb") as file:
            file.write(CUBE)
        daemon = Daemon("--models", folder)
        with Client(daemon.unix) as first, Client(daemon.tcp) as other:
            def spoil(data, share):
                model = first.upload(data, "wrong.glb", share=share)
                with self.assertRaises(wire.Refused) as caught:
                    first.query(model)
                self.assertEqual(caught.exception.code, wire.ERROR_MODEL)
                self.assertIn("wrong.glb", caught.exception.text)

            spoil(CUBE, True)
            other.find("cube.obj")  # the file in the daemon's folder
            first.query(first.upload(CUBE, "cube.obj"))
            for number, share in enumerate((False, True)):
                data = CUBE + b"# %d\n" % number
                spoil(data, share)
                self.assertEqual(other.query(other.upload(data, "theirs.obj"))[2], [b"theirs.obj"])
                self.assertEqual(first.query(first.upload(data, "right.obj"))[2], [b"right.obj"])
            data = CUBE + b"# not read yet\n"
            first.upload(data, "wrong.glb", share=True)
            self.assertEqual(other.query(other.upload(data, "theirs.obj"))[2], [b"theirs.obj"])
            data = CUBE + b"# shared after all\n"
            spoil(data, False)
            model = first.upload(data, "right.obj", share=True)
            first.query(model)
            other.query(model)
        self.assertEqual(daemon.stop(), 0)

    def test_a_shared_file_keeps_its_name(self):
        """Another client's name for the same bytes has no effect for a client that has uploaded them, whoever was
        first, and none on the model that the daemon has read already."""
        for who_shares in ("clients", "daemon"):
            with self.subTest(who_shares):
                daemon = Daemon(*(["--share-models"] if who_shares == "daemon" else []))
                share = who_shares == "clients"
                with Client(daemon.unix) as good, Client(daemon.tcp) as bad:
                    for first, second in (("good.obj", "bad.glb"), ("bad.glb", "good.obj")):
                        data = CUBE + f"# {first} comes first\n".encode()
                        for name in (first, second):
                            client = good if name == "good.obj" else bad
                            model = client.upload(data, name, share=share)
                        with self.assertRaises(wire.Refused) as caught:
                            bad.query(model)
                        self.assertIn("bad.glb", caught.exception.text)
                        self.assertEqual(good.query(model)[2], [b"good.obj"])
                        # the name of this client's upload is not used
                        self.assertEqual(bad.query(model)[2], [b"good.obj"])
                        bad.upload(data, "bad.glb", share=share)
                        self.assertEqual(good.query(model)[2], [b"good.obj"])
                self.assertEqual(daemon.stop(), 0)

    def test_shared_by_the_daemon(self):
        daemon = Daemon("--share-models")
        with Client(daemon.unix) as owner, Client(daemon.tcp) as other:
            other.render(owner.upload(CUBE, "cube.obj"))
        self.assertEqual(daemon.stop(), 0)

    def test_share_of_the_command(self):
        daemon = Daemon()
        path = self.write("cube.obj", CUBE.decode())
        for arguments, there in (((), False), (("--share",), True)):
            done = subprocess.run([SHEEN, "info", path, "--server", daemon.unix, "--json",
                                   *arguments], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 0, done.stderr)
            model = bytes.fromhex(re.search('"sha256": "([0-9a-f]+)"', done.stdout).group(1))
            with Client(daemon.tcp) as other:
                if there:
                    other.render(model)
                else:
                    self.assert_unknown(other, model)
        self.assertEqual(daemon.stop(), 0)


class Room(unittest.TestCase):
    """Who must make room in the store. There are two owners: the clients over TCP, and the user."""

    def setUp(self):
        self.daemon = Daemon("--memory-budget", budget(12))
        self.many, self.other = Client(self.daemon.unix), Client(self.daemon.tcp)

    def tearDown(self):
        self.many.socket.close()
        self.other.socket.close()
        self.assertEqual(self.daemon.stop(), 0)

    def stream(self, n, share=False):
        """Draws n models of one owner, each of which takes a third of the budget."""
        for i in range(n):
            self.last = self.many.upload(grid(65) + b"# %d\n" % i, "large.obj", share=share)
            self.many.render(self.last)

    def test_one_who_streams_pushes_out_his_own(self):
        for share in (False, True):
            small = self.other.upload(CUBE, "cube.obj")
            self.other.render(small)
            self.stream(8, share)
            self.assertEqual(self.other.render(small).tables_us, 0)
            self.assertEqual(self.many.render(self.last).tables_us, 0)

    def test_who_holds_most_makes_room(self):
        """Models of another owner who holds little remain, even if they were used earlier."""
        small = self.other.upload(CUBE, "cube.obj")
        self.other.render(small)
        self.stream(3)
        model = self.other.upload(grid(65), "mine.obj")
        self.other.render(model)
        for mine in (small, model):
            self.assertEqual(self.other.render(mine).tables_us, 0)
        self.assertEqual(self.many.render(self.last).tables_us, 0)

    def test_entries_too(self):
        """The table has room for 4096 owners."""
        small = self.other.upload(CUBE, "cube.obj")
        self.other.render(small)
        for i in range(4100):
            self.many.upload(b"# %d\n" % i, "tiny.obj")
        self.assertEqual(self.other.render(small).tables_us, 0)


class Files(Case):
    """--models"""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.models = cls.path("models")
        os.makedirs(cls.path("models/cars"))
        cls.write("outside.obj", CUBE.decode())
        cls.write("models/cars/hood.obj", CUBE.decode() + "# hood\n")
        cls.write("models/top.obj", CUBE.decode())
        cls.write("models/empty.obj", "")
        cls.write("models/broken.obj", "no model\n")
        cls.write("models/large.obj", CUBE.decode() + "#\n" * (1 << 19))
        os.symlink("top.obj", cls.path("models/link.obj"))
        os.symlink("../outside.obj", cls.path("models/away.obj"))
        os.symlink("cars", cls.path("models/folder"))
        os.mkfifo(cls.path("models/pipe.obj"))
        cls.daemon = Daemon("--models", cls.models, "--max-upload", "1M")

    @classmethod
    def tearDownClass(cls):
        if cls.daemon.stop() != 0:
            raise AssertionError("the daemon did not end well")

    def test_found(self):
        with Client(self.daemon.unix) as one, Client(self.daemon.tcp) as two:
            for name in ("top.obj", "cars/hood.obj", "./cars/../cars/hood.obj"):
                model = one.find(name)
                want = one.render(model).data
                two.find(name)
                self.assertEqual(two.render(model).data, want)
            self.assertEqual(one.find("top.obj"), one.upload(CUBE, "cube.obj"))
            self.assertEqual(one.query(one.find("cars/hood.obj"))[2], [b"hood.obj"])

    def test_nothing_else(self):
        """All have the same text, so that nobody learns which files exist elsewhere."""
        texts = set()
        with Client(self.daemon.unix) as client:
            for name in ("none.obj", "../outside.obj", "cars/../../outside.obj", "/etc/passwd",
                         self.path("models/top.obj"), "link.obj", "away.obj", "folder/hood.obj",
                         "pipe.obj", "cars", ".", "empty.obj", "top.obj/", "large.obj",
                         "/proc/self/exe", 255 * "a"):
                with self.subTest(name=name), self.assertRaises(wire.Refused) as caught:
                    client.find(name)
                self.assertEqual(caught.exception.code, wire.ERROR_MODEL)
                texts.add(caught.exception.text.replace(name[:200], "NAME"))
            self.assertEqual(texts, {"no model file 'NAME' at this daemon"})
            self.assertIn("file=away.obj", self.daemon.errors())
            for words, name, sha256 in (("UTF-8", "a\nb", bytes(32)), ("empty", "", bytes(32)),
                                        ("exclude", "top.obj", b"1" * 32)):
                with self.assertRaises(wire.Refused) as caught:
                    client.find(name, sha256)
                self.assertIn(words, caught.exception.text)
            with self.assertRaises(wire.Refused) as caught:
                client.find("broken.obj")
            self.assertEqual(caught.exception.code, wire.ERROR_MODEL)
            client.render(client.find("top.obj"))

    def test_the_command(self):
        def sheen(*arguments):
            return subprocess.run([SHEEN, *arguments, "--server", self.daemon.unix],
                                  capture_output=True, text=True, timeout=60)

        for name in ("a.png", "b.png"):
            done = sheen("render", "server:top.obj" if name == "a.png" else self.path("outside.obj"),
                         "-o", self.path(name), "--size", "200x100")
            self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("a.png"), "rb") as a, open(self.path("b.png"), "rb") as b:
            self.assertEqual(a.read(), b.read())
        for model in ("server:none.obj", self.path("none.obj")):  # at the daemon or here: a bad model
            for command in (("info",), ("render", "-o", self.path("c.png")), ("stream", "--frames", "2")):
                with self.subTest(model=model, command=command[0]):
                    done = sheen(*command, model)
                    self.assertEqual((done.returncode, done.stdout), (3, ""))
                    self.assertIn("none.obj", done.stderr)
                    self.assertEqual("no model file" in done.stderr, model.startswith("server:"))

    def test_a_daemon_without(self):
        daemon = Daemon()
        with Client(daemon.unix) as client, self.assertRaises(wire.Refused) as caught:
            client.find("top.obj")
        self.assertIn("--models", caught.exception.text)
        self.assertEqual(caught.exception.code, wire.ERROR_REQUEST)
        self.assertEqual(daemon.stop(), 0)

    def test_a_cancelled_query_builds_nothing(self):
        """The query is cancelled before the file has been read. A later query starts the only build."""
        daemon = Daemon("--models", self.models, "--metrics", "tcp:127.0.0.1:0")
        with Client(daemon.unix, minor=1) as client:
            client.send(wire.message(wire.MODEL_QUERY, 7, wire.field(1, bytes(32)) +
                                     wire.field(2, "large.obj")) + wire.message(wire.CANCEL, 7))
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual(caught.exception.code, wire.ERROR_CANCELLED)
            client.seq = 7
            client.find("large.obj")
            counts = read_metrics(get(metrics_address(daemon), "/metrics")[1])
            self.assertEqual(counts["sheen_model_cache_misses_total"], 1)
            self.assertEqual(counts["sheen_model_cache_hits_total"], 0)
        self.assertEqual(daemon.stop(), 0)

    def test_ends_while_it_reads(self):
        """A client that disconnects, and a daemon that shuts down, before the file has been read."""
        daemon = Daemon("--models", self.models)
        for _ in range(5):
            with Client(daemon.unix) as client:
                client.send(b"".join(wire.message(wire.MODEL_QUERY, 10 + i, wire.field(1, bytes(32)) +
                                                  wire.field(2, "large.obj")) for i in range(4)))
                time.sleep(0.005)
        daemon.terminate()
        self.assertEqual(daemon.stop(), 0)
