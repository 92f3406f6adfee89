"""A GPU that is lost, injected into the test build (faults.c)."""
import os
import subprocess
import unittest

import daemon
import wire
from test_operations import get, metrics_address, read_metrics

FENDER = os.path.join(daemon.MODELS, "fender.obj")


class FaultyDaemon(daemon.Daemon):
    program = os.path.join(daemon.BUILD, "sheend-faults")

    def __init__(self, faults, *arguments):
        super().__init__(*arguments, env={"SHEEN_FAULTS": faults})


class LostGpu(unittest.TestCase):
    def serve(self, faults, *arguments):
        server = FaultyDaemon(faults, *arguments)
        self.addCleanup(lambda: server.process.poll() is None and server.stop())
        return server

    def client(self, server):
        client = wire.Client(server.unix, minor=1)
        self.addCleanup(client.socket.close)
        return client

    def draw(self, client, model, **named):
        """A frame's bytes, and how often it was lost before."""
        lost = 0
        while True:
            try:
                return client.render(model, **named).data, lost
            except wire.Refused as refused:
                self.assertEqual(refused.code, wire.ERROR_GPU_LOST, refused)
                lost += 1

    def test_a_lost_frame_is_told_and_the_next_is_drawn(self):
        for fault in ("gpu.lost", "gpu.fence"):
            server = self.serve(f"{fault}:1:1", "--gpu-losses", "0")
            client = self.client(server)
            model = client.upload(daemon.CUBE, "cube.obj")
            with self.assertRaises(wire.Refused) as caught:
                client.render(model)
            self.assertEqual(caught.exception.code, wire.ERROR_GPU_LOST)
            self.assertIn("ask again", caught.exception.text)
            again, lost = self.draw(client, model)
            self.assertEqual(lost, 0)
            self.assertIn("generation=2", server.wait_for("the GPU was lost"))
            healthy = self.serve("gpu.lost:1:0")
            other = self.client(healthy)
            self.assertEqual(again, other.render(other.upload(daemon.CUBE, "cube.obj")).data)
            self.assertEqual(server.stop(), 0)

    def test_all_comes_back(self):
        """Model, light image and polygons, and a frame of many tiles goes on after the lost one."""
        square = b"P6\n2 2\n255\n" + bytes((255, 0, 0, 0, 255, 0, 0, 0, 255, 90, 90, 90))
        pictures = []
        for faults in ("gpu.lost:9:0", "gpu.lost:9:8"):
            server = self.serve(faults, "--gpu-losses", "0")
            client = self.client(server)
            model = client.upload(daemon.CUBE, "cube.obj")
            image = client.upload(square, "light.ppm", wire.IMAGE)
            light = wire.field(5, wire.field(6, wire.field(1, wire.PATTERN_IMAGE) +
                                             wire.field(6, image)))
            level2 = wire.field(40, 1) + wire.field(41, 2)
            drawn = [self.draw(client, model, extra=extra, kind=wire.STILL, width=size, height=size)
                     for extra in (light, level2) for size in (64, 500, 64)]
            pictures.append([picture for picture, _ in drawn])
            self.assertEqual(sum(lost for _, lost in drawn),
                             server.errors().count("fault: gpu.lost"))
            self.assertEqual(server.stop(), 0)
        self.assertGreater(sum(lost for _, lost in drawn), 3)
        self.assertEqual(pictures[0], pictures[1])

    def test_three_losses_end_the_daemon_with_75(self):
        server = self.serve("gpu.lost:4:3")
        client = self.client(server)
        model = client.upload(daemon.CUBE, "cube.obj")
        answers = []
        for _ in range(40):
            try:
                client.render(model)
                answers.append(0)
            except wire.Refused as refused:
                answers.append(refused.code)
                if refused.code != wire.ERROR_GPU_LOST:
                    break
        self.assertEqual(answers.count(wire.ERROR_GPU_LOST), 3)
        self.assertEqual(answers[-1], wire.ERROR_SHUTTING_DOWN)
        self.assertEqual(server.wait(), 75)
        self.assertFalse(os.path.exists(server.path))

    def test_twenty_losses_under_load(self):
        n_losses = 20
        server = self.serve(f"gpu.lost:29:{n_losses}", "--gpu-losses", "0", "--metrics",
                            "tcp:127.0.0.1:0")
        clients = [subprocess.Popen([daemon.SHEEN, "stream", FENDER, "--server", server.unix,
                                     "--frames", "80", "--size", "160x120", *more],
                                    stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                   for more in ([], ["--class", "still"], ["--class", "batch"])]
        for client in clients:
            _, said = client.communicate(timeout=120)
            self.assertEqual(client.returncode, 0, said)
        self.assertEqual(server.errors().count("fault: gpu.lost"), n_losses)
        text = get(metrics_address(server), "/metrics")[1]
        self.assertEqual(read_metrics(text)["sheen_gpu_generation"], 1 + n_losses)
        self.assertEqual(server.stop(), 0)


if __name__ == "__main__":
    unittest.main()
