"""The order of service: classes, views, credits, cancelling and deadlines, through real sockets."""
import signal
import time

import wire
from daemon import CUBE, SANITIZED, DaemonCase, grid
from wire import BATCH, INTERACTIVE, STILL, Client, field, message

LARGE = {"width": 1600, "height": 1600}  # many tiles


class Schedule(DaemonCase):
    def client(self, **named):
        client = Client(self.daemon.unix, minor=1, **named)
        self.addCleanup(client.socket.close)
        self.model = client.upload(CUBE, "cube.obj")
        client.render(self.model)  # the model's tables are ready
        return client

    def stats(self):
        with Client(self.daemon.unix) as client:
            return client.stats()

    def wait_until_begun(self, client):
        """Waits until the frame that the client has requested is being drawn."""
        client.stats()  # answered after the request has been read, and before the frame
        while self.stats()[15][0] > 0:
            time.sleep(0.005)

    def assert_refused_with(self, what, code, words):
        self.assertIsInstance(what, wire.Refused)
        self.assertEqual(what.code, code, what)
        self.assertIn(words, what.text)

    def test_newest_of_a_view_wins(self):
        client = self.client()
        before = self.stats()[16][0]
        first = client.ask(self.model, **LARGE, kind=INTERACTIVE, view=3)
        self.wait_until_begun(client)
        others = [client.ask(self.model, kind=INTERACTIVE, view=3) for _ in range(4)]
        still = client.ask(self.model, kind=STILL, view=3)
        answers = [client.answer() for _ in range(6)]
        # Replaced requests are answered at once, before the frame that is being drawn; each names its successor.
        self.assertEqual(answers[:4], list(zip(others, others[1:] + [still])))
        self.assertEqual({seq for seq, what in answers[4:] if isinstance(what, wire.Frame)},
                         {first, still})
        self.assertEqual(self.stats()[16][0] - before, 4)

    def test_what_is_not_replaced(self):
        """A newer request does not replace requests of other views, stills without a view, batches, or another
        connection's requests of the same view."""
        client, other = self.client(), self.client()
        busy = client.ask(self.model, **LARGE, kind=INTERACTIVE, view=1)
        self.wait_until_begun(client)
        asked = [client.ask(self.model, **named) for named in (
            {"kind": INTERACTIVE, "view": 2}, {"kind": INTERACTIVE},
            {"kind": STILL}, {"kind": STILL}, {},
            {"kind": BATCH}, {"kind": BATCH}, {"kind": STILL, "view": 4})]
        theirs = other.ask(self.model, kind=INTERACTIVE, view=2)
        answers = dict(client.answer() for _ in range(9))
        self.assertEqual(set(answers), {busy, *asked})
        for seq, what in (*answers.items(), other.answer()):
            self.assertIsInstance(what, wire.Frame, (seq, what))
        self.assertEqual(theirs, other.seq)

    def test_replaced_while_tables_are_built(self):
        client = self.client()
        model = client.upload(grid(120), "sheet.obj")
        asked = [client.ask(model, kind=INTERACTIVE) for _ in range(5)]
        answers = [client.answer() for _ in range(5)]
        self.assertEqual(answers[:4], list(zip(asked, asked[1:])))
        self.assertIsInstance(answers[4][1], wire.Frame)

    def test_frames_of_a_class_keep_their_order(self):
        client = self.client()
        asked = {kind: [client.ask(self.model, **LARGE, kind=kind),
                        client.ask(self.model, kind=kind),
                        client.ask(self.model, 300, 200, kind=kind)] for kind in (STILL, BATCH)}
        got = [client.answer()[0] for _ in range(6)]
        for seqs in asked.values():
            self.assertEqual([seq for seq in got if seq in seqs], seqs)

    def test_interactive_does_not_wait_for_a_batch(self):
        batch, drag = self.client(), self.client()
        slow = batch.ask(self.model, 2500, 2500, kind=BATCH)
        self.wait_until_begun(batch)
        frames = self.stats()[3][0]
        for _ in range(5):
            drag.render(self.model, kind=INTERACTIVE)
        self.assertEqual(self.stats()[3][0] - frames, 5)  # and no frame of the batch
        self.assertEqual(batch.answer()[0], slow)

    def test_a_change_of_light_stays_cheap_beside_a_batch(self):
        batch, drag = self.client(), self.client()
        light = lambda x: field(5, field(1, field(1, x) + field(2, 0.0) + field(3, 4.0)) +
                                field(2, field(1, 4.0) + field(2, 0.0) + field(3, 0.0)) +
                                field(3, field(1, 0.0) + field(2, 4.0) + field(3, 0.0)))
        drag.render(self.model, 200, 150, kind=INTERACTIVE, extra=light(0.0))
        slow = batch.ask(self.model, 2000, 2000, kind=BATCH)
        self.wait_until_begun(batch)
        for i in range(5):
            frame = drag.render(self.model, 200, 150, kind=INTERACTIVE, extra=light(0.1 * i))
            self.assertEqual((frame.visibility_us, frame.evaluate_us), (0, 0))
        self.assertEqual(batch.answer()[0], slow)

    def test_cancel(self):
        client = self.client()
        begun = client.ask(self.model, **LARGE)
        self.wait_until_begun(client)
        waiting = [client.ask(self.model) for _ in range(3)]
        for seq in (waiting[1], begun):
            client.send(message(wire.CANCEL, seq))
            got, what = client.answer()
            self.assertEqual(got, seq)
            self.assert_refused_with(what, wire.ERROR_CANCELLED, "taken back")
        self.assertEqual([client.answer()[0] for _ in range(2)], [waiting[0], waiting[2]])
        for seq in (waiting[0], 12345):  # already answered, or unknown: nothing happens
            client.send(message(wire.CANCEL, seq))
        client.stats()

    def test_cancel_while_tables_are_built(self):
        client = self.client()
        model = client.upload(grid(121), "sheet.obj")
        seq = client.ask(model)
        client.send(message(wire.CANCEL, seq))
        got, what = client.answer()
        self.assertEqual(got, seq)
        self.assert_refused_with(what, wire.ERROR_CANCELLED, "taken back")
        client.render(model)

    def test_deadline(self):
        client = self.client()
        model = client.upload(grid(122), "sheet.obj")
        slow = client.ask(self.model, **LARGE, deadline=3600000)
        self.wait_until_begun(client)
        late, unbuilt = client.ask(self.model, deadline=1), client.ask(model, deadline=1)
        answers = dict(client.answer() for _ in range(3))
        for seq in (late, unbuilt):
            self.assert_refused_with(answers[seq], wire.ERROR_DEADLINE, "")
            # The text does not tell the cause, since an idle daemon may take longer, too.
            self.assertEqual(answers[seq].text, "not drawn within its deadline_ms of 1")
        self.assertIsInstance(answers[slow], wire.Frame)
        self.assertIsInstance(client.render(self.model, deadline=60000), wire.Frame)

    def test_deadline_ends_a_frame_between_its_tiles(self):
        client = self.client()
        seq = client.ask(self.model, 6000, 6000, deadline=300)
        got, what = client.answer()
        self.assertEqual(got, seq)
        self.assert_refused_with(what, wire.ERROR_DEADLINE, "deadline_ms of 300")

    def test_credits(self):
        client = self.client()
        self.assertEqual(client.credits, 16)
        for _ in range(2):  # credits return with the answers
            asked = [client.ask(self.model, 100, 100, kind=BATCH) for _ in range(16)]
            self.assertEqual([client.answer()[0] for _ in asked], asked)
        asked = range(100, 117)
        client.send(b"".join(wire.render(seq, self.model, 300, 300, kind=BATCH) for seq in asked))
        answers = dict(client.answer() for _ in asked)
        self.assertEqual(set(answers), set(asked))
        self.assert_refused_with(answers.pop(116), wire.ERROR_PROTOCOL, "credits")
        for what in answers.values():
            self.assert_refused_with(what, wire.ERROR_CANCELLED, "credits")
        self.assertTrue(client.at_end())

    def test_minor_version_0(self):
        """A client of minor version 0 has no classes, views or deadlines, gets all answers in order, and may send as
        much as it likes."""
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            asked = [client.ask(model, kind=INTERACTIVE, view=1, deadline=1) for _ in range(40)]
            for seq in asked:
                client.read_frame(seq)
            client.send(message(wire.CANCEL, asked[0]))
            self.assert_refused(client, wire.ERROR_PROTOCOL, "minor version 1")

    def test_values_out_of_range(self):
        client = self.client()
        for named, words in (({"kind": 3}, "request_class"), ({"deadline": 0}, "deadline_ms"),
                             ({"deadline": 3600001}, "deadline_ms"),
                             ({"kind": BATCH, "view": 1}, "view")):
            seq = client.ask(self.model, **named)
            self.assert_refused(client, wire.ERROR_REQUEST, words, seq)

    def test_nobody_waits_while_polygons_are_made(self):
        slow, other = self.client(), self.client()
        sheet = slow.upload(grid(38), "sheet.obj")
        slow.render(sheet)
        seq = slow.next_seq()
        slow.send(message(wire.RENDER, seq, field(1, sheet) + field(2, 64) + field(3, 48) +
                          field(9, 1) + field(10, 0) + field(40, 1) + field(41, 6)))
        before = slow.stats()[3][0]
        for _ in range(5):
            other.render(self.model)
        self.assertEqual(other.stats()[3][0] - before, 5)  # the polygons' frame is not among them
        slow.read_frame(seq)

    def begin_polygons(self, client, **named):
        """Begins a frame of 3.3 million triangles, which takes many steps. Returns its model and the arguments of the
        request."""
        sheet = client.upload(grid(20), "sheet.obj")
        client.render(self.model)  # so that no planes are kept
        asked = {"model": sheet, "extra": field(40, 1) + field(41, 6)}
        return asked, self.ask_polygons(client, asked, **named)

    def ask_polygons(self, client, asked, kind=STILL, view=None, deadline=None):
        seq = client.next_seq()  # protobuf fields in ascending order: the surface comes last
        later = b"".join(field(number, value) for number, value in
                         ((14, kind), (15, view), (16, deadline)) if value is not None)
        client.send(message(wire.RENDER, seq, field(1, asked["model"]) + field(2, 64) +
                            field(3, 48) + field(9, 1) + field(10, 0) + later + asked["extra"]))
        return seq

    def test_nobody_waits_while_polygons_are_drawn(self):
        slow, other = self.client(), self.client()
        for kind in STILL, BATCH, INTERACTIVE:
            with self.subTest(kind=kind):
                asked, first = self.begin_polygons(slow, kind=kind)
                self.wait_until_begun(slow)
                before = self.stats()[3][0]
                for _ in range(5):
                    other.render(self.model, kind=INTERACTIVE)
                # The polygons' frame is not among them: these frames were drawn between its slices.
                self.assertEqual(self.stats()[3][0] - before, 5)
                whole = slow.read_frame(first).data
                slow.render(self.model)  # so that no planes are kept
                again = self.ask_polygons(slow, asked, kind=kind)
                self.assertEqual(slow.read_frame(again).data, whole)

    def test_polygons_are_given_up_between_slices(self):
        client, other = self.client(), self.client()
        asked, first = self.begin_polygons(client)
        whole = client.read_frame(first).data
        client.render(self.model)  # so that no planes are kept
        for _ in range(30):  # more frames than may be unfinished at once
            seq = self.ask_polygons(client, asked, deadline=5)  # drawing them takes 15 ms or more
            got, what = client.answer()
            self.assertEqual(got, seq)
            self.assert_refused_with(what, wire.ERROR_DEADLINE, "deadline_ms of 5")
        seq = self.ask_polygons(client, asked, kind=INTERACTIVE, view=1)
        self.wait_until_begun(client)
        newer = [self.ask_polygons(client, asked, kind=INTERACTIVE, view=1) for _ in range(3)]
        for older, by in zip(newer, newer[1:]):  # answered at once, before the frame that is being drawn
            self.assertEqual(client.answer(), (older, by))
        client.send(message(wire.CANCEL, seq))
        got, what = client.answer()
        self.assertEqual(got, seq)
        self.assert_refused_with(what, wire.ERROR_CANCELLED, "taken back")
        got, what = client.answer()
        self.assertEqual((got, what.data), (newer[-1], whole))
        self.assertIsInstance(other.render(self.model), wire.Frame)

    def test_polygons_that_the_device_has_dropped(self):
        """The device keeps 32 meshes. A frame that needs a removed mesh again is the same as before."""
        client = self.client()
        frames = []
        for i in (0, 1, 2, 3, 4, 0):
            model = client.upload(CUBE + b"# %d\n" % i, "cube.obj")
            frames.append([client.render(model, extra=field(40, 1) + field(41, level)).data
                           for level in range(7)])
        self.assertEqual(frames[0], frames[5])

    def test_many_connections_have_one_share(self):
        """A frame of eight tiles of one user, among 48 such frames that 24 connections of another identity have
        requested. The user gets half of the tiles, so that at most eight other frames end earlier: those that had
        begun, and those that are drawn in turn with the user's."""
        size = {"width": 720, "height": 720, "kind": STILL}
        one = self.client()
        many = []
        for _ in range(24):
            client = Client(self.daemon.tcp, minor=1)
            self.addCleanup(client.socket.close)
            model = client.upload(CUBE, "cube.obj")
            many.append(client)
        many[0].render(model)
        # Encoded answers fit into the sockets: the daemon drops who does not read his answers for too long.
        asked = [(client, client.ask(model, encoding=wire.ZSTD, **size)) for client in many for _ in range(2)]
        for client in many:
            client.stats()  # the earlier requests have been read
        before = self.stats()[3][0]
        one.render(self.model, **size)
        self.assertLess(self.stats()[3][0] - before, 14)
        for client, seq in asked:
            self.assertEqual(client.answer()[0], seq)

    def test_interactive_frames_of_many_lights_are_cut(self):
        """The frames of other clients are drawn between the tiles of an expensive frame."""
        slow, other = self.client(), self.client()
        lights = b"".join(field(5, field(4, 2) + field(6, field(1, 0) + field(2, 30.0 + i)))
                          for i in range(8))
        seq = slow.ask(self.model, 1600, 1200, kind=INTERACTIVE, extra=lights)
        self.wait_until_begun(slow)
        before = self.stats()[3][0]
        for i in range(5):
            other.render(self.model, kind=INTERACTIVE)
        self.assertEqual(self.stats()[3][0] - before, 5)  # the slow frame is not among them
        whole = slow.read_frame(seq).data
        seq = slow.ask(self.model, 1600, 1200, kind=STILL, extra=lights)
        self.assertEqual(slow.read_frame(seq).data, whole)

    def test_messages_of_many_connections_are_handled_in_turns(self):
        """40 connections of one identity send 640 requests at once, then a connection of another identity sends one.
        The position of its answer is measured."""
        many = [Client(self.daemon.tcp, minor=1) for _ in range(40)]
        one = Client(self.daemon.unix, minor=1)
        for client in *many, one:
            self.addCleanup(client.socket.close)
        before = one.stats()[4][0]
        self.daemon.process.send_signal(signal.SIGSTOP)
        try:
            for client in many:
                client.send(b"".join(message(wire.MODEL_QUERY, client.next_seq(),
                                             field(1, bytes(31) + b"?")) for _ in range(16)))
            seq = one.next_seq()
            one.send(message(wire.STATS_QUERY, seq))
        finally:
            self.daemon.process.send_signal(signal.SIGCONT)
        self.assertLess(one.expect(wire.STATS, seq)[4][0] - before, 160)
        for client in many:
            for _ in range(16):
                self.assert_refused_with(client.answer()[1], wire.ERROR_UNKNOWN_MODEL, "upload")

    def test_a_party_replaces_a_limited_number_of_requests(self):
        """30 connections of one identity send 16 requests of one view each, at once. 100 replaced requests are read at
        once and then 2,000 a second. Another identity's request is answered meanwhile."""
        many = [Client(self.daemon.tcp, minor=1) for _ in range(30)]
        one = self.client()
        for client in many:
            self.addCleanup(client.socket.close)
            client.model = client.upload(CUBE, "cube.obj")
        begun = time.monotonic()
        asked = [[client.ask(client.model, kind=INTERACTIVE) for _ in range(16)] for client in many]
        one.render(self.model, kind=INTERACTIVE)
        replaced = 0
        for client, numbers in zip(many, asked):
            answers = [client.answer() for _ in numbers]
            self.assertEqual(answers[-1][0], numbers[-1])  # the newest is drawn
            replaced += sum(isinstance(what, int) for _, what in answers)
        self.assertGreater(replaced, 300)
        self.assertGreaterEqual(time.monotonic() - begun, (replaced - 100) / 2000 - 0.01)

    def test_a_client_that_has_gone_leaves_the_device(self):
        """Eight lights over 16 million pixels, or a mesh of millions of triangles: the next client does not wait
        until they are done."""
        lights = b"".join(field(5, field(6, field(1, 0) + field(2, 30.0))) for _ in range(8))
        polygons = field(40, 1) + field(41, 6)
        model, extra = None, None
        for extra in (lights, polygons):
            with self.subTest(extra=extra[:4]):
                with Client(self.daemon.unix, minor=1) as gone, \
                        Client(self.daemon.unix, minor=1) as other:
                    model = gone.upload(grid(40), "sheet.obj")
                    gone.render(model)
                    seq = gone.next_seq()
                    # protobuf fields in ascending order: the surface comes last
                    gone.send(message(wire.RENDER, seq, field(1, model) + field(2, 4096) +
                                      field(3, 4096) + (extra if extra is lights else b"") +
                                      field(9, 1) + field(10, 0) + field(14, INTERACTIVE) +
                                      (extra if extra is polygons else b"")))
                    self.wait_until_begun(gone)
                    gone.socket.close()
                    start = time.monotonic()
                    other.render(model)
                    self.assertLess(time.monotonic() - start, 20 if SANITIZED else 5)
