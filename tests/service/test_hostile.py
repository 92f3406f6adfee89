"""Clients that break the protocol on purpose or by dying. After every test the daemon must serve others
(DaemonCase.tearDown)."""
import hashlib
import os
import random
import socket
import struct
import time

import wire
from daemon import CUBE, Daemon, DaemonCase, grid, resident_kb
from wire import Client, field, message

ALONE = True  # tests/run.sh runs nothing else at the same time as these tests


class Hostile(DaemonCase):
    def each(self, greet=True):
        for address in self.addresses():
            with self.subTest(address=address), Client(address, greet=greet) as client:
                yield client

    def assert_closed(self, client, code, words="", seq=None):
        self.assert_refused(client, code, words, seq)
        self.assertTrue(client.at_end())

    def test_wrong_magic(self):
        for client in self.each(greet=False):
            client.send(b"GET / HTTP/1.1\r\nHost: sheen\r\n\r\n")
            self.assert_closed(client, wire.ERROR_PROTOCOL, "SHEN", 0)

    def test_wrong_magic_later(self):
        for client in self.each():
            client.send(message(wire.STATS_QUERY, 2, magic=b"NEHS"))
            self.assert_closed(client, wire.ERROR_PROTOCOL, "SHEN", 0)

    def test_wrong_magic_behind_a_request(self):
        """Both arrive in one read. The error about the garbage must not have the number of the request before it."""
        for client in self.each():
            client.send(message(wire.STATS_QUERY, 2) + b"garbage-garbage-")
            client.expect(wire.STATS, 2)
            self.assert_closed(client, wire.ERROR_PROTOCOL, "SHEN", 0)

    def test_names_that_look_like_others(self):
        """Characters that change the direction of text, and other invisible ones, reach neither log nor terminal. The
        test has a daemon of its own, because a log with hundreds of lines in a second would leave lines out."""
        daemon = Daemon()
        with Client(daemon.unix) as client:
            name = "a\u202egnp\u2028x\U000e0041.obj"
            model = client.upload(b"f 1 2 3\n# " + os.urandom(8).hex().encode(), name)
            client.send(wire.render(9, model))
            self.assert_refused(client, wire.ERROR_MODEL, "a?gnp?x?.obj:", 9)
            daemon.wait_for("a?gnp?x?.obj:")
            for mark in "\u202e\u2028\U000e0041":
                self.assertNotIn(mark, daemon.errors())
        self.assertEqual(daemon.stop(), 0)

    def test_wrong_version(self):
        for client in self.each(greet=False):
            client.send(message(wire.HELLO, 1, bytes(40), major=2))
            self.assert_closed(client, wire.ERROR_VERSION, "version")

    def test_unknown_type(self):
        for kind in (0, max(wire.Type) + 1, 77, 255):
            for client in self.each():
                client.send(message(kind, 2))
                self.assert_closed(client, wire.ERROR_PROTOCOL, "type")

    def test_type_of_servers(self):
        for kind in (wire.HELLO_OK, wire.FRAME, wire.DATA, wire.ERROR, wire.BREAKS):
            for client in self.each():
                client.send(message(kind, 2, b"\x08\x01"))
                self.assert_closed(client, wire.ERROR_PROTOCOL, "servers", 2)

    def test_data_longer_than_the_buffer(self):
        for client in self.each():
            client.send(message(wire.DATA, 2, length=1 << 20))
            self.assert_closed(client, wire.ERROR_PROTOCOL, "DATA", 2)

    def test_two_gigabytes(self):
        for kind in (wire.RENDER, wire.UPLOAD_CHUNK, wire.HELLO):
            for length in (1 << 31, 0xffffffff, 262145):
                for client in self.each():
                    client.send(message(kind, 2, length=length))
                    self.assert_closed(client, wire.ERROR_PROTOCOL, "longer", 2)

    def test_first_message_is_not_hello(self):
        for client in self.each(greet=False):
            client.send(message(wire.STATS_QUERY, 1))
            self.assert_closed(client, wire.ERROR_PROTOCOL, "HELLO", 1)

    def test_second_hello(self):
        for client in self.each():
            client.send(wire.hello(2))
            self.assert_closed(client, wire.ERROR_PROTOCOL, "HELLO", 2)

    def test_number_zero(self):
        for client in self.each():
            client.send(message(wire.STATS_QUERY, 0))
            self.assert_closed(client, wire.ERROR_PROTOCOL, "number", 0)

    def test_short_hello(self):
        for body in (b"", bytes(31), bytes(32), bytes(32) + b"\xff"):
            for client in self.each(greet=False):
                client.send(message(wire.HELLO, 1, body))
                self.assert_closed(client, wire.ERROR_PROTOCOL, "HELLO", 1)

    def test_hello_with_control_characters(self):
        for client in self.each(greet=False):
            client.send(message(wire.HELLO, 1, bytes(32) + field(1, 0) + field(2, "\x1b[2J")))
            self.assert_closed(client, wire.ERROR_PROTOCOL, "client", 1)

    def test_garbage_bodies(self):
        noise = random.Random(1)
        for kind in (wire.UPLOAD_BEGIN, wire.MODEL_QUERY, wire.RENDER):
            for body, words in ((b"", "missing"), (b"\xff" * 64, "well-formed"),
                                (b"\x0a\xff\xff\xff\xff\x0f", "well-formed"),
                                (noise.randbytes(500), ""),
                                (field(1, bytes(31)), "")):
                for client in self.each():
                    client.send(message(kind, 2, body))
                    self.assert_closed(client, wire.ERROR_PROTOCOL, words, 2)

    def test_over_a_bound(self):
        """limits.h: a value above a limit is answered with an ERROR that names the limit."""
        light = field(5, b"")
        places = field(5, field(6, field(1, 4) + field(12, 0.5) * 17))
        for extra, words in ((light * 9, "lights has 9 entries; it may have at most 8"),
                             (places, "lights.pattern.at has 17 entries; it may have at most 16"),
                             (field(5, field(6, field(1, 3) + field(6, bytes(33)))),
                              "lights.pattern.image_sha256 has 33 bytes; it must have 32")):
            for client in self.each():
                client.send(wire.render(2, bytes(32), extra=extra))
                self.assert_closed(client, wire.ERROR_PROTOCOL, "RENDER: " + words, 2)
        for client in self.each():
            client.send(wire.upload_begin(2, bytes(32), 1, "n" * 256))
            self.assert_closed(client, wire.ERROR_PROTOCOL,
                               "UPLOAD_BEGIN: name has 256 bytes; it may have at most 255", 2)
        for client in self.each(greet=False):
            client.send(message(wire.HELLO, 1, bytes(32) + field(1, 0) + field(2, "c" * 64)))
            self.assert_closed(client, wire.ERROR_PROTOCOL,
                               "HELLO: client has 64 bytes; it may have at most 63", 1)

    def test_noise(self):
        noise = random.Random(2)
        for _ in range(20):
            for client in self.each():
                try:
                    client.send(noise.randbytes(noise.randrange(1, 5000)))
                    client.send(wire.MAGIC + noise.randbytes(4000))
                except OSError:
                    pass

    def test_cut_messages(self):
        whole = wire.hello() + message(wire.STATS_QUERY, 2)
        for cut in range(1, len(whole)):
            with Client(self.daemon.unix, greet=False) as client:
                client.send(whole[:cut])
        with Client(self.daemon.tcp, greet=False) as client:
            client.send(whole[:20])
            client.socket.shutdown(1)
            self.assertTrue(client.at_end())

    def test_one_byte_at_a_time(self):
        model = hashlib.sha256(CUBE).digest()
        stream = (wire.hello() + wire.upload_begin(2, model, len(CUBE), "cube.obj"))
        for client in self.each(greet=False):
            for byte in stream:
                client.send(bytes([byte]))
                time.sleep(0.0005)
            client.expect(wire.HELLO_OK, 1)
            state = client.expect(wire.UPLOAD_STATE, 2)
            if not state[1][0]:
                for byte in message(wire.UPLOAD_CHUNK, 2, CUBE):
                    client.send(bytes([byte]))
                self.assertEqual(client.expect(wire.UPLOAD_STATE, 2)[1], [1])
            for byte in wire.render(3, model):
                client.send(bytes([byte]))
            client.read_frame(3)

    def test_no_hello_in_time(self):
        with Client(self.daemon.unix, greet=False) as silent, \
                Client(self.daemon.tcp, greet=False) as slow:
            slow.send(wire.MAGIC)
            start = time.monotonic()
            self.assert_closed(silent, wire.ERROR_PROTOCOL, "HELLO")
            self.assertLess(2.5, time.monotonic() - start)
            self.assertLess(time.monotonic() - start, 6)
            self.assert_closed(slow, wire.ERROR_PROTOCOL, "HELLO")

    def test_many_connections_that_only_open(self):
        clients = [Client(self.daemon.unix, greet=False) for _ in range(200)]
        self.assert_serves()
        for client in clients:
            client.socket.close()


class Uploads(DaemonCase):
    def begin(self, client, data, size=None, sha256=None, name="x.obj"):
        seq = client.next_seq()
        client.send(wire.upload_begin(seq, sha256 or hashlib.sha256(data).digest(),
                                      len(data) if size is None else size, name))
        return seq

    def test_wrong_hash(self):
        for address in self.addresses():
            with Client(address) as client:
                wrong = hashlib.sha256(b"another").digest()
                seq = self.begin(client, CUBE, sha256=wrong)
                self.assertEqual(client.expect(wire.UPLOAD_STATE, seq)[1], [0])
                client.send(message(wire.UPLOAD_CHUNK, seq, CUBE))
                self.assert_refused(client, wire.ERROR_REQUEST, "SHA-256", seq)
                # The connection remains, and no file is known by the wrong id.
                client.stats()
                client.send(wire.render(90, wrong))
                self.assert_refused(client, wire.ERROR_UNKNOWN_MODEL, wrong.hex(), 90)
                client.upload(CUBE, "cube.obj")

    def test_more_than_announced(self):
        data = os.urandom(1000)
        for address in self.addresses():
            with Client(address) as client:
                seq = self.begin(client, data, size=999)
                client.expect(wire.UPLOAD_STATE, seq)
                client.send(message(wire.UPLOAD_CHUNK, seq, data))
                self.assert_refused(client, wire.ERROR_PROTOCOL, "999", seq)
                self.assertTrue(client.at_end())

    def test_two_states_and_cancel_between(self):
        """An upload has an answer to its beginning and an answer to its last byte. CANCEL does nothing to an
        upload."""
        with Client(self.daemon.unix, minor=1) as client:
            data = CUBE + b"# " + os.urandom(8).hex().encode()
            seq = self.begin(client, data)
            self.assertEqual(client.expect(wire.UPLOAD_STATE, seq), {1: [0], 2: [0]})
            client.send(message(wire.UPLOAD_CHUNK, seq, data[:50]) + message(wire.CANCEL, seq) +
                        message(wire.UPLOAD_CHUNK, seq, data[50:]))
            self.assertEqual(client.expect(wire.UPLOAD_STATE, seq), {1: [1], 2: [len(data)]})
            seq = self.begin(client, data)
            self.assertEqual(client.expect(wire.UPLOAD_STATE, seq), {1: [1], 2: [len(data)]})
            client.stats()  # and no other answer

    def test_requests_before_hello_is_answered(self):
        """Also if clients have closed their sending side after the messages."""
        with Client(self.daemon.unix, greet=False) as client:
            client.send(wire.hello(minor=1) + message(wire.STATS_QUERY, 2) +
                        message(wire.STATS_QUERY, 3))
            client.socket.shutdown(socket.SHUT_WR)
            client.expect(wire.HELLO_OK, 1)
            client.expect(wire.STATS, 2)
            client.expect(wire.STATS, 3)
            self.assertTrue(client.at_end())

    def test_a_number_that_is_not_answered_yet(self):
        """From 1.4 on the number must not be used again before its answer; older peers may do so."""
        for minor in (1, 3):
            with Client(self.daemon.unix, minor=minor) as client:
                model = client.upload(CUBE, "cube.obj")
                client.send(2 * wire.render(9, model, 700, 700))
                client.read_frame(9)
                client.read_frame(9)
        with Client(self.daemon.unix, minor=4) as client:
            model = client.upload(CUBE, "cube.obj")
            for _ in range(2):  # answered in the meantime
                client.send(wire.render(9, model))
                client.read_frame(9)
            client.send(wire.render(9, model, 700, 700) + wire.render(9, model))
            client.read_frame(9)
            self.assert_refused(client, wire.ERROR_PROTOCOL, "not answered yet", 9)
            self.assertTrue(client.at_end())

    def test_chunk_of_no_upload(self):
        with Client(self.daemon.unix) as client:
            client.send(message(wire.UPLOAD_CHUNK, 5, b"abc"))
            self.assert_refused(client, wire.ERROR_PROTOCOL, "UPLOAD_CHUNK", 5)
            self.assertTrue(client.at_end())

    def test_chunk_of_another_number(self):
        with Client(self.daemon.unix) as client:
            seq = self.begin(client, os.urandom(10))
            client.expect(wire.UPLOAD_STATE, seq)
            client.send(message(wire.UPLOAD_CHUNK, seq + 1, b"abc"))
            self.assert_refused(client, wire.ERROR_PROTOCOL, "UPLOAD_CHUNK")

    def test_empty_chunk(self):
        with Client(self.daemon.unix) as client:
            seq = self.begin(client, os.urandom(10))
            client.expect(wire.UPLOAD_STATE, seq)
            client.send(message(wire.UPLOAD_CHUNK, seq))
            self.assert_refused(client, wire.ERROR_PROTOCOL, "without a byte")

    def test_request_in_the_middle(self):
        with Client(self.daemon.unix) as client:
            seq = self.begin(client, os.urandom(10))
            client.expect(wire.UPLOAD_STATE, seq)
            client.send(message(wire.STATS_QUERY, seq + 1))
            self.assert_refused(client, wire.ERROR_PROTOCOL, "upload")

    def test_sizes(self):
        for size, code in ((0, wire.ERROR_REQUEST), ((1 << 30) + 1, wire.ERROR_TOO_BIG),
                           ((1 << 64) - 1, wire.ERROR_TOO_BIG)):
            with Client(self.daemon.unix) as client:
                seq = self.begin(client, b"", size=size)
                self.assert_refused(client, code, "", seq)
                # Chunks that were already sent are dropped; then the connection goes on.
                client.send(message(wire.UPLOAD_CHUNK, seq, b"abc"))
                client.stats()

    def test_names(self):
        for name in (b"\xff\xfe.obj", b"a\nb.obj", b"\x1b[31m.obj"):
            with Client(self.daemon.unix) as client:
                self.begin(client, CUBE, name=name)
                self.assert_refused(client, wire.ERROR_REQUEST, "name")

    def test_announced_and_gone(self):
        """Many clients announce a gigabyte: that takes no memory, and nobody keeps any."""
        for _ in range(20):
            with Client(self.daemon.unix) as client:
                seq = self.begin(client, os.urandom(10), size=1 << 30)
                client.expect(wire.UPLOAD_STATE, seq)
                client.send(message(wire.UPLOAD_CHUNK, seq, bytes(262144)))
        time.sleep(0.2)
        self.assertLess(resident_kb(self.daemon.process.pid), 1 << 20)

    def test_no_model(self):
        for name, data, words in (("text.obj", b"hello world\n", "text.obj"),
                                  ("noise.glb", b"glTF" + os.urandom(200), "noise.glb"),
                                  ("noise", os.urandom(500), "noise"),
                                  ("nan.obj", CUBE.replace(b"v -1", b"v nan", 1), "nan.obj"),
                                  ("far.obj", CUBE + b"f 1 2 99\n", "far.obj")):
            with Client(self.daemon.unix) as client, self.subTest(name=name):
                model = client.upload(data, name)
                for _ in range(2):  # the second time from memory, with the same text
                    client.send(wire.render(50, model))
                    self.assert_refused(client, wire.ERROR_MODEL, words, 50)
                client.send(message(wire.MODEL_QUERY, 51, field(1, model)))
                self.assert_refused(client, wire.ERROR_MODEL, words, 51)
                client.stats()

    def test_refused_by_the_limit_surface(self):
        """The fault is found by a part of the daemon that knows no files; the text names the file all the same."""
        fan = b"v 0 0 0\n" + b"".join(b"v %d 1 %d\n" % (i, i * i % 97) for i in range(5000))
        fan += b"".join(b"f 1 %d %d\n" % (i + 2, i + 3) for i in range(4999))
        with Client(self.daemon.unix) as client:
            model = client.upload(fan, "part.obj")
            for _ in range(2):
                client.send(wire.render(50, model))
                self.assert_refused(client, wire.ERROR_MODEL, "part.obj: a vertex", 50)
            client.send(message(wire.MODEL_QUERY, 51, field(1, model)))
            self.assert_refused(client, wire.ERROR_MODEL, "part.obj: a vertex", 51)

    def test_no_image(self):
        pattern = lambda image: field(5, field(6, field(1, wire.PATTERN_IMAGE) + field(6, image)))
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            client.send(wire.render(40, model, extra=pattern(bytes(32))))
            self.assert_refused(client, wire.ERROR_UNKNOWN_MODEL, "image", 40)
            image = client.upload(b"this is no image", "light.png", wire.IMAGE)
            for seq in (41, 42):
                client.send(wire.render(seq, model, extra=pattern(image)))
                self.assert_refused(client, wire.ERROR_IMAGE, "light.png", seq)
            huge = client.upload(b"P6\n90000 90000\n255\nxyz", "huge.ppm", wire.IMAGE)
            client.send(wire.render(43, model, extra=pattern(huge)))
            self.assert_refused(client, wire.ERROR_IMAGE, "90000", 43)
            good = client.upload(b"P6\n2 1\n255\n\xff\0\0\0\0\xff", "good.ppm", wire.IMAGE)
            client.render(model, extra=pattern(good))

    def test_an_image_is_no_model(self):
        with Client(self.daemon.unix) as client:
            image = client.upload(CUBE, "cube.obj", wire.IMAGE)
            other = client.upload(CUBE + b"# image\n", "cube.obj", wire.IMAGE)
            client.upload(CUBE, "cube.obj")
            self.assertEqual(image, hashlib.sha256(CUBE).digest())
            client.send(wire.render(30, other))
            self.assert_refused(client, wire.ERROR_UNKNOWN_MODEL, "model", 30)


class Renders(DaemonCase):
    def test_out_of_range(self):
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            for named, words in (({"width": 0}, "width"), ({"height": 0}, "height"),
                                 ({"width": 100000, "height": 100000}, "width"),
                                 ({"height": 0xffffffff}, "height"), ({"planes": 0}, "planes"),
                                 ({"planes": 1 << 20}, "planes"), ({"encoding": 6}, "encoding"),
                                 ({"planes": 3, "encoding": wire.PNG}, "planes")):
                seq = client.next_seq()
                client.send(wire.render(seq, model, **named))
                self.assert_refused(client, wire.ERROR_REQUEST, words, seq)
            vec3 = lambda x, y, z: field(1, x) + field(2, y) + field(3, z)
            for eye, words in (((float("nan"), 0.0, 0.0), "camera.eye"),
                               ((1e308, 0.0, 0.0), "camera.eye"),
                               ((0.0, 0.0, 0.0), "same point")):
                seq = client.next_seq()
                camera = (field(1, vec3(*eye)) + field(2, vec3(0.0, 0.0, 0.0)) +
                          field(3, vec3(0.0, 0.0, 1.0)) + field(4, 35.0))
                client.send(wire.render(seq, model, extra=field(4, camera)))
                self.assert_refused(client, wire.ERROR_REQUEST, words, seq)
            client.render(model)

    def test_a_column_after_a_row(self):
        """The device's planes must be as large as the largest frame so far, and not have the largest width times the
        largest height."""
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            before = resident_kb(self.daemon.process.pid)
            want = client.render(model).data
            for width, height in ((1, 16384), (16384, 1), (1, 16384)):
                frame = client.render(model, width=width, height=height)
                self.assertEqual(len(frame.data), 4 * 16384)
            self.assertEqual(client.render(model).data, want)
            self.assertLess(resident_kb(self.daemon.process.pid), before + (512 << 10))

    def test_thin_frames_each_longer_than_the_last(self):
        """The memory that planes may waste is measured by the frames that were requested, not by the planes' present
        size."""
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            held = [512, 512]
            client.render(model, width=held[0], height=held[1])
            before = resident_kb(self.daemon.process.pid)
            for turn in range(6):
                along, across = turn % 2, 1 - turn % 2
                side = 2 * held[along] - 8
                thin = -(-66500 // side)  # several tiles: smaller frames have planes of their own
                size = [0, 0]
                size[along], size[across] = side, thin
                client.render(model, width=size[0], height=size[1])
                held[along] = side
            self.assertEqual(held, [4040, 4040])
            self.assertLess(resident_kb(self.daemon.process.pid), before + (256 << 10))

    def test_answers_keep_the_order_of_requests(self):
        with Client(self.daemon.unix) as client:
            model = client.upload(grid(60), "order.obj")
            client.send(wire.render(10, model, width=900, height=700, encoding=wire.EXR) +
                        wire.render(11, model, width=8, height=8) +
                        message(wire.STATS_QUERY, 12) +
                        wire.render(13, model, width=0) +
                        message(wire.MODEL_QUERY, 14, field(1, model)) +
                        message(99, 15))
            client.read_frame(10)
            client.read_frame(11)
            client.expect(wire.STATS, 12)
            self.assert_refused(client, wire.ERROR_REQUEST, "width", 13)
            client.expect(wire.MODEL_INFO, 14)
            self.assert_refused(client, wire.ERROR_PROTOCOL, "type", 15)
            self.assertTrue(client.at_end())

    def test_every_encoding(self):
        starts = {wire.PNG: b"\x89PNG", wire.EXR: b"\x76\x2f\x31\x01", wire.JPEG: b"\xff\xd8",
                  wire.TIFF: b"II*\0"}
        with Client(self.daemon.tcp) as client:
            model = client.upload(CUBE, "cube.obj")
            for encoding, start in starts.items():
                frame = client.render(model, encoding=encoding)
                self.assertTrue(frame.data.startswith(start), frame.data[:8])
                self.assertEqual(client.render(model, encoding=encoding).data, frame.data)
                for said in (b"sheen:version", b"sheen:camera", b"eye=", b"pattern=stripes"):
                    self.assertIn(said, frame.data)
            all_planes = client.render(model, planes=63)
            self.assertEqual(len(all_planes.data), 64 * 48 * (4 + 12 + 12 + 12 + 8 + 8))
            packed = client.render(model, planes=63, encoding=wire.ZSTD)
            n_strips = 6
            lengths = struct.unpack(f"<{n_strips}I", packed.data[:4 * n_strips])
            self.assertEqual(sum(lengths) + 4 * n_strips, len(packed.data))
            self.assertEqual(packed.data[24:28], b"\x28\xb5\x2f\xfd")

    def test_jpeg_options(self):
        """Lower quality and fewer samples of colour give fewer bytes. A client of minor version 1 cannot set these
        options and gets the same bytes as ever."""
        quality, subsampling = wire.field(30, 40), wire.field(31, 2)
        with Client(self.daemon.tcp, minor=2) as client, Client(self.daemon.tcp, minor=1) as older:
            model = client.upload(CUBE, "cube.obj")

            def size(client, *options):
                return len(client.render(model, width=320, height=240, encoding=wire.JPEG,
                                         extra=b"".join(options)).data)
            usual = size(client)
            self.assertEqual(size(client, wire.field(30, 95), wire.field(31, 0)), usual)
            self.assertGreater(usual, size(client, subsampling))
            self.assertGreater(size(client, subsampling), size(client, quality, subsampling))
            self.assertEqual(size(older, quality, subsampling), usual)
            for encoding, extra, words in ((wire.JPEG, wire.field(30, 101), "jpeg_quality"),
                                           (wire.JPEG, wire.field(30, 0), "1 to 100"),
                                           (wire.JPEG, wire.field(31, 3), "jpeg_subsampling"),
                                           (wire.PNG, quality, "JPEG files")):
                seq = client.ask(model, encoding=encoding, extra=extra)
                self.assert_refused(client, wire.ERROR_REQUEST, words, seq)

    def test_many_ahead(self):
        """More requests than are read at once are all answered."""
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            client.send(b"".join(wire.render(100 + i, model) for i in range(50)))
            for i in range(50):
                client.read_frame(100 + i)

    def test_end_of_sending_is_not_the_end(self):
        for address in self.addresses():
            with Client(address) as client:
                model = client.upload(CUBE, "cube.obj")
                client.send(wire.render(7, model) + wire.render(8, model))
                client.socket.shutdown(1)
                client.read_frame(7)
                client.read_frame(8)
                self.assertTrue(client.at_end())

    def test_gone_in_the_middle(self):
        for address in self.addresses():
            for wait in (0, 0.01, 0.1, 0.3):
                with Client(address) as client:
                    model = client.upload(CUBE, "cube.obj")
                    client.send(b"".join(wire.render(7 + i, model, width=1500, height=1500,
                                                     encoding=wire.EXR) for i in range(4)))
                    time.sleep(wait)

    def test_gone_while_tables_are_built(self):
        data = grid(150)
        with Client(self.daemon.unix) as client:
            model = client.upload(data, "sheet.obj")
            client.send(wire.render(7, model))
        with Client(self.daemon.tcp) as client:
            client.render(client.upload(data, "sheet.obj"))

    def test_reads_no_more(self):
        """A client that asks and does not read costs a bounded amount of memory and delays nobody."""
        pid = self.daemon.process.pid
        for address in self.addresses():
            with Client(address, timeout=3) as client:
                model = client.upload(CUBE, "cube.obj")
                client.render(model, width=1000, height=1000)  # the first frame, not measured
                before = resident_kb(pid)
                ask = b"".join(wire.render(100 + i, model, width=1000, height=1000)
                               for i in range(1000))
                client.socket.setblocking(False)
                try:
                    for at in range(0, len(ask), 4096):
                        client.socket.send(ask[at:at + 4096])
                except BlockingIOError:
                    pass
                time.sleep(1)
                start = time.monotonic()
                self.assert_serves()
                self.assertLess(time.monotonic() - start, 5)
                self.assertLess(resident_kb(pid) - before, 64 * 1024)

    def test_two_at_once(self):
        data = grid(80)
        with Client(self.daemon.unix) as one, Client(self.daemon.tcp) as two:
            models = [client.upload(data, "same.obj", share=True) for client in (one, two)]
            for client, model in zip((one, two), models):
                client.send(b"".join(wire.render(20 + i, model, width=300, height=200)
                                     for i in range(4)))
            frames = [[client.read_frame(20 + i) for i in range(4)] for client in (one, two)]
            self.assertEqual({frame.data for row in frames for frame in row},
                             {frames[0][0].data})
            # Built once, for both clients.
            self.assertEqual(sum(frame.tables_us > 0 for row in frames for frame in row), 1)
            self.assertEqual(one.render(models[0]).tables_us, 0)
            self.assertEqual(one.stats()[5], two.stats()[5])

    def test_one_client_does_not_starve_another(self):
        with Client(self.daemon.unix) as busy, Client(self.daemon.tcp) as other:
            model = busy.upload(CUBE, "cube.obj", share=True)
            other.render(model, width=700, height=700)
            busy.send(b"".join(wire.render(50 + i, model, width=700, height=700)
                               for i in range(40)))
            before = other.stats()[3][0]
            for _ in range(5):
                other.render(model, width=32, height=32)
            # For each of these five frames, at most the two frames that the busy client may have in flight.
            self.assertLessEqual(other.stats()[3][0] - before, 5 + 5 * 2)
            for i in range(40):
                busy.read_frame(50 + i)
