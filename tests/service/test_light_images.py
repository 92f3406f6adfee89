"""Light images: every documented format is read, and a file of no format is refused with a clear text."""
import os
import re
import subprocess

import pictures
import wire
from daemon import CUBE, MODELS, SHEEN, DaemonCase
from test_untrusted import image_pattern
from wire import Client

NO_FORMAT = "it is not an image format that is read: "


class LightImages(DaemonCase):
    def draw(self, client, data, name):
        """A frame of the cube under this image."""
        image = client.upload(data, name, wire.IMAGE)
        return client.render(client.upload(CUBE, "cube.obj"), extra=image_pattern(image)).data

    def refusal(self, client, data, name):
        with self.assertRaises(wire.Refused) as caught:
            self.draw(client, data, name)
        refused = caught.exception
        self.assertEqual(refused.code, wire.ERROR_IMAGE)
        self.assertTrue(refused.text.startswith(name + ": "), refused.text)
        for words in ("sandbox", "crashed", "\n"):
            self.assertNotIn(words, refused.text)
        return refused.text

    def rendered(self, client):
        """Pictures that the daemon writes itself."""
        model = client.upload(CUBE, "cube.obj")
        return {name: client.render(model, encoding=encoding).data for name, encoding in
                (("a.png", wire.PNG), ("a.tif", wire.TIFF), ("a.jpg", wire.JPEG),
                 ("a.exr", wire.EXR))}

    def test_every_format(self):
        with Client(self.daemon.unix) as client:
            frames = {name: self.draw(client, data, name)
                      for name, data in {**pictures.EXACT, **pictures.LINEAR}.items()}
            for name in pictures.EXACT:
                self.assertEqual(frames[name], frames["a.ppm"], name)
            for name in pictures.LINEAR:
                self.assertEqual(frames[name], frames["a.hdr"], name)
            files = self.rendered(client)
            drawn = {name: self.draw(client, data, name) for name, data in files.items()}
            self.assertEqual(drawn["a.tif"], drawn["a.png"])
            # Neither frame may equal that without an image, which a black image would look like.
            self.assertEqual(len({frames["a.ppm"], *drawn.values()}), 4)

    def test_names_tell_nothing(self):
        with Client(self.daemon.unix) as client:
            want = self.draw(client, pictures.ppm(), "a.ppm")
            for i, name in enumerate(("a.obj", "null", "a.avi", "a")):
                # Another file each time, so that the daemon reads it again.
                self.assertEqual(self.draw(client, pictures.ppm() + bytes([i]), name), want)

    def test_what_is_no_image(self):
        with open(os.path.join(MODELS, "fender.obj"), "rb") as file:
            cage = file.read()
        jp2 = b"\0\0\0\x0cjP  \r\n\x87\n\0\0\0\x14ftypjp2 \0\0\0\0jp2 " + bytes(60)
        with Client(self.daemon.unix) as client:
            for data, name in ((cage, "cage.obj"), (cage + b"#", "lie.png"), (cage + b"##", "lie.tga"),
                               (b"some words\n", "words.txt"), (b"P", "p.ppm"), (jp2, "a.jp2"),
                               (b"8BPS" + bytes(60), "a.psd"), (b"DDS " + bytes(130), "a.dds"),
                               (b"SDPX" + bytes(9000), "a.dpx"), (b"\x01\xda" + bytes(600), "a.sgi"),
                               (bytes(1000), "zeros.bin"), (b"P7\nWIDTH 1\n", "a.pam"),
                               (b"RIFF\0\0\0\0AVI ", "film.avi"), (b"\x00\x00\x01\x00\x01\x00", "a.ico")):
                with self.subTest(name=name):
                    self.assertTrue(self.refusal(client, data, name).startswith(
                        f"{name}: {NO_FORMAT}PNG, "))

    def test_an_empty_file(self):
        with Client(self.daemon.unix) as client:
            client.send(wire.upload_begin(7, bytes(32), 0, "empty.png", wire.IMAGE))
            self.assert_refused(client, wire.ERROR_REQUEST, "size_bytes", 7)

    def test_cut_files(self):
        """Cuts the file after the bytes that tell its format, in the middle, and before its last byte."""
        with Client(self.daemon.unix) as client:
            files = {**pictures.EXACT, **pictures.LINEAR, **self.rendered(client)}
            for name, data in files.items():
                least = 18 if name.endswith("tga") else 12
                for cut in sorted({least, (least + len(data)) // 2, len(data) - 1}):
                    with self.subTest(name=name, cut=cut):
                        try:
                            self.draw(client, data[:cut], f"{cut}.{name}")
                        except wire.Refused as refused:
                            self.assertEqual(refused.code, wire.ERROR_IMAGE)
                            for words in ("sandbox", "crashed", NO_FORMAT):
                                self.assertNotIn(words, refused.text)
                        else:  # the end of this format is not part of the picture
                            self.assertGreater(cut, least)

    def test_the_client_lists_what_the_daemon_reads(self):
        with Client(self.daemon.unix) as client:
            formats = self.refusal(client, b"no image", "words").partition(NO_FORMAT)[2]
        for command in ("patterns",), ("render", "--help"):
            text = subprocess.run([SHEEN, *command], capture_output=True, text=True, timeout=20,
                                  check=True).stdout
            self.assertIn(formats, re.sub(r"\s+", " ", text), command)
        readme = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "README.md")
        with open(readme, encoding="utf-8") as file:
            self.assertIn(formats, re.sub(r"\s+", " ", file.read()))
