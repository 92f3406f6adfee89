"""Values follow protocol/README.md: of pixels that show nothing, of curvature, of enums."""
import math
import struct

import wire
from daemon import CUBE, DaemonCase
from wire import Client, field

ALL_PLANES = 255
LAYOUT = ("4B", "3f", "3f", "Iff", "2f", "2f", "4f", "f")
WIDTH, HEIGHT = 64, 48


class Values(DaemonCase):
    def test_blank(self):
        """A frame after a change of the light draws no surface again, and still tells the surface's values."""
        def vec3(x, y, z):
            return field(1, float(x)) + field(2, float(y)) + field(3, float(z))

        away = field(4, field(1, vec3(0, 0, 5)) + field(2, vec3(0, 0, 9)) + field(3, vec3(0, 1, 0)))
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            for camera, want in ((b"", [0]), (away, [1])):
                for family in (0, 1):
                    seq = client.ask(model, extra=camera + field(6, field(1, family)))
                    fields = client.expect(wire.FRAME, seq)
                    client.read_rest(seq, fields)
                    self.assertEqual(fields.get(16, [0]), want)

    def test_where_nothing_is_hit(self):
        with Client(self.daemon.unix) as client:
            data = client.render(client.upload(CUBE, "cube.obj"), WIDTH, HEIGHT,
                                 planes=ALL_PLANES).data
        planes = []
        for layout in LAYOUT:
            size = struct.calcsize("<" + layout) * WIDTH * HEIGHT
            planes.append(list(struct.iter_unpack("<" + layout, data[:size])))
            data = data[size:]
        n_hit = 0
        for k in range(WIDTH * HEIGHT):
            _, position, normal, ptex, light, curvature, change, coverage = (
                plane[k] for plane in planes)
            if ptex[0] != 0xffffffff:
                n_hit += 1
                # The cube's normals point outwards, so it curves away from them everywhere.
                self.assertLess(curvature[1], 0)
                self.assertLessEqual(curvature[0], curvature[1])
                self.assertGreater(coverage[0], 0)
                continue
            self.assertEqual(ptex[1:], (0, 0))
            self.assertTrue(all(math.isnan(x) for values in
                                (position, normal, light, curvature, change) for x in values))
        self.assertGreater(n_hit, 500)
        self.assertEqual((planes[7][0], planes[0][0]), ((0,), (128, 128, 128, 255)))  # a corner

    def test_unknown_numbers(self):
        """An unknown enum or plane is answered ERROR_REQUEST, and the connection goes on. A count above its bound
        closes the connection."""
        with Client(self.daemon.unix, minor=1) as client:
            model = client.upload(CUBE, "cube.obj")
            for seq, (name, request) in enumerate((
                    ("kind", wire.upload_begin(50, bytes(32), 8, "a.obj", kind=9)),
                    ("encoding", wire.render(51, model, encoding=9)),
                    ("planes", wire.render(52, model, planes=512)),
                    ("show.kind", wire.render(53, model, extra=field(13, field(1, 9)))),
                    ("lines.family", wire.render(54, model, extra=field(6, field(1, 9)))),
                    ("request_class", wire.render(55, model, kind=9))), 50):
                client.send(request)
                self.assert_refused(client, wire.ERROR_REQUEST, name + " is ", seq)
            client.render(model)
            client.send(wire.render(60, model, extra=field(5, b"") * 9))
            self.assert_refused(client, wire.ERROR_PROTOCOL, "lights has 9", 60)
            self.assertTrue(client.at_end())
