"""Faults: a lost GPU, exhausted memory, descriptors and disks, and killed processes. Some faults are injected into
the test build (faults.c). SHEEN_KILLS is the number of processes to kill."""
import os
import random
import re
import resource
import signal
import subprocess
import tempfile
import time
import unittest

import wire
from daemon import BUILD, CUBE, MESA, MODELS, SANITIZED, SHEEN, Daemon, grid
from test_operations import get, metrics_address, read_metrics
from test_untrusted import children, is_alive, workers

FENDER = os.path.join(MODELS, "fender.obj")
UPLOADS_BYTES, QUEUED = 8, 15  # a field of STATS


class FaultyDaemon(Daemon):
    program = os.path.join(BUILD, "sheend-faults")

    def __init__(self, faults, *arguments):
        super().__init__(*arguments, env={"SHEEN_FAULTS": faults})


class LostGpu(unittest.TestCase):
    def serve(self, faults, *arguments):
        server = FaultyDaemon(faults, "--device", MESA, *arguments)
        self.addCleanup(lambda: server.process.poll() is None and server.stop())
        return server

    def client(self, server):
        client = wire.Client(server.unix, minor=1)
        self.addCleanup(client.socket.close)
        return client

    def draw(self, client, model, **named):
        """Returns a frame's bytes, and how often the frame was lost before."""
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
            model = client.upload(CUBE, "cube.obj")
            with self.assertRaises(wire.Refused) as caught:
                client.render(model)
            self.assertEqual(caught.exception.code, wire.ERROR_GPU_LOST)
            self.assertIn("ask again", caught.exception.text)
            again, lost = self.draw(client, model)
            self.assertEqual(lost, 0)
            self.assertIn("generation=2", server.wait_for("the GPU was lost"))
            healthy = self.serve("gpu.lost:1:0")
            other = self.client(healthy)
            self.assertEqual(again, other.render(other.upload(CUBE, "cube.obj")).data)
            self.assertEqual(server.stop(), 0)

    def test_all_comes_back(self):
        """After a loss the model, the light image and the polygons are uploaded again, and a frame of many tiles
        continues."""
        square = b"P6\n2 2\n255\n" + bytes((255, 0, 0, 0, 255, 0, 0, 0, 255, 90, 90, 90))
        pictures = []
        for faults in ("gpu.lost:9:0", "gpu.lost:9:8"):
            server = self.serve(faults, "--gpu-losses", "0")
            client = self.client(server)
            model = client.upload(CUBE, "cube.obj")
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

    def test_lost_between_two_slices(self):
        """Two frames of polygons that take several steps to upload and to draw. The frame that is being drawn at the
        loss must be requested again; the other one continues by itself."""
        level6 = wire.field(40, 1) + wire.field(41, 6)
        pictures = []
        for faults in ("gpu.lost:9:0", "gpu.lost:9:3"):
            server = self.serve(faults, "--gpu-losses", "0")
            clients = [self.client(server) for _ in range(2)]
            model = [client.upload(grid(6), "sheet.obj") for client in clients][0]
            lost, asked = 0, {}
            for client in clients:
                asked[client] = client.ask(model, extra=level6, kind=wire.BATCH)
            while asked:
                for client, seq in list(asked.items()):
                    got, what = client.answer()
                    self.assertEqual(got, seq)
                    del asked[client]
                    if isinstance(what, wire.Frame):
                        pictures.append(what.data)
                        continue
                    self.assertEqual(what.code, wire.ERROR_GPU_LOST, what)
                    lost += 1
                    asked[client] = client.ask(model, extra=level6, kind=wire.BATCH)
            self.assertEqual(lost, server.errors().count("fault: gpu.lost"))
            self.assertEqual(server.stop(), 0)
        self.assertEqual(lost, 3)
        self.assertEqual(pictures, pictures[:1] * 4)

    def test_polygons_go_between_two_tiles(self):
        """Other polygons have taken the frame's room on the device: the frame gets its polygons again and
        continues."""
        server = self.serve("gpu.polygons:4:3")
        client = self.client(server)
        model = client.upload(CUBE, "cube.obj")
        level2 = wire.field(40, 1) + wire.field(41, 2)
        first, *others = [client.render(model, 900, 900, extra=level2, kind=wire.STILL).data
                          for _ in range(4)]
        self.assertEqual(others, [first] * 3)
        self.assertEqual(server.errors().count("fault: gpu.polygons"), 3)
        self.assertEqual(server.stop(), 0)

    def test_three_losses_end_the_daemon_with_75(self):
        server = self.serve("gpu.lost:4:3")
        client = self.client(server)
        model = client.upload(CUBE, "cube.obj")
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
        clients = [subprocess.Popen([SHEEN, "stream", FENDER, "--server", server.unix,
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



class Shortage(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.addCleanup(self.folder.cleanup)
        self.output = os.path.join(self.folder.name, "out.png")

    def test_memory(self):
        """The fault fails one request; the next request works."""
        for fault, encoding in (("model.build", wire.ZSTD), ("encode", wire.ZSTD),
                                ("encode", wire.JPEG)):
            server = FaultyDaemon(f"{fault}:1:1")
            with wire.Client(server.unix, minor=1) as client:
                model = client.upload(CUBE, "cube.obj")
                with self.assertRaises(wire.Refused) as caught:
                    client.render(model, encoding=encoding)
                self.assertEqual(caught.exception.code, wire.ERROR_OVERLOADED)
                self.assertIn("memory", caught.exception.text)
                client.render(model, encoding=encoding)
            self.assertEqual(server.stop(), 0)

    def test_no_descriptor_to_accept_with(self):
        """The client waits in the queue through five failures, and the log has two lines about them, not five."""
        server = FaultyDaemon("accept.emfile:1:5")
        with wire.Client(server.unix) as client:
            client.render(client.upload(CUBE, "cube.obj"))
        log = server.errors()
        self.assertEqual(log.count("fault: accept.emfile"), 5)
        self.assertEqual(log.count("cannot accept clients"), 1)
        self.assertIn("Too many open files", log)
        self.assertEqual(log.count("accepting clients again"), 1)
        self.assertEqual(server.stop(), 0)

    def test_descriptors(self):
        """A client that connects while no descriptor is free waits for one; no other client is disconnected."""
        server = Daemon()
        pid = server.process.pid
        with wire.Client(server.unix) as first:
            model = first.upload(CUBE, "cube.obj")
            first.render(model)
            lowest = max(int(fd) for fd in os.listdir(f"/proc/{pid}/fd")) + 1
            hard = resource.prlimit(pid, resource.RLIMIT_NOFILE)[1]
            resource.prlimit(pid, resource.RLIMIT_NOFILE, (lowest, hard))
            waiting = [wire.Client(server.unix, greet=False) for _ in range(lowest)]
            self.addCleanup(lambda: [client.socket.close() for client in waiting])
            first.render(model)
            time.sleep(0.3)
            self.assertEqual(len(os.listdir(f"/proc/{pid}/fd")), lowest)
            resource.prlimit(pid, resource.RLIMIT_NOFILE, (hard, hard))
            with wire.Client(server.unix) as last:
                last.render(model)
        self.assertEqual(server.stop(), 0)

    def test_disk(self):
        def with_full_disk():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        server = Daemon()
        done = subprocess.run([SHEEN, "render", FENDER, "--server", server.unix, "-o", self.output],
                              preexec_fn=with_full_disk, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("out.png", done.stderr)
        self.assertEqual(os.listdir(self.folder.name), [])
        for command in (["info", FENDER], ["render", FENDER, "--json", "-o", self.output],
                        ["stream", FENDER, "--frames", "2", "--size", "64x48"]):
            with open("/dev/full", "w", encoding="ascii") as full:
                done = subprocess.run([SHEEN, *command, "--server", server.unix], stdout=full,
                                      stderr=subprocess.PIPE, text=True, timeout=60)
            self.assertEqual(done.returncode, 3, (command, done.stderr))
            self.assertIn("standard output cannot be written", done.stderr)
        self.assertEqual(server.stop(), 0)

    def test_broken_pipe(self):
        """The readers of the daemon's log and of its answers both go away."""
        reader, writer = os.pipe()
        server = subprocess.Popen([Daemon.program, "--device", "software", "--log-level", "debug",
                                   "--listen", f"unix:{self.folder.name}/s"], stderr=writer)
        os.close(writer)
        self.assertIn(b"listening", os.read(reader, 4096))
        os.close(reader)
        for _ in range(3):
            with wire.Client(f"unix:{self.folder.name}/s") as client:
                client.send(wire.render(5, client.upload(CUBE, "cube.obj"), 900, 900))
        with wire.Client(f"unix:{self.folder.name}/s") as client:
            client.render(client.upload(CUBE, "cube.obj"))
        server.terminate()
        self.assertEqual(server.wait(30), 0)


class Stuck(unittest.TestCase):
    """A daemon that shuts down waits for nothing beyond its time limit."""

    def told_at_the_end(self, server, client, seq):
        with client:
            server.terminate()
            number, refused = client.answer()
            self.assertEqual((number, refused.code), (seq, wire.ERROR_SHUTTING_DOWN))
        self.assertEqual(server.wait(30), 0)

    def test_a_thread(self):
        server = FaultyDaemon("tables.stuck:1:1", "--drain-timeout", "1", "--metrics",
                              "tcp:127.0.0.1:0")
        client = wire.Client(server.unix)
        seq = client.ask(client.upload(CUBE, "cube.obj"))
        server.wait_for("fault: tables.stuck")
        self.told_at_the_end(server, client, seq)
        self.assertIn("ended while a thread was at work", server.errors())
        self.assertFalse(os.path.exists(server.path))
        server.stop()

    def test_a_reader(self):
        server = Daemon("--drain-timeout", "1")
        client = wire.Client(server.unix)
        reader = workers(server.process.pid)["sheend-cage"]
        os.kill(reader, signal.SIGSTOP)
        self.told_at_the_end(server, client, client.ask(client.upload(CUBE, "cube.obj")))
        self.assertNotIn("at work", server.errors())
        server.stop()

    def test_a_writer(self):
        server = Daemon("--drain-timeout", "1")
        client = wire.Client(server.unix)
        model = client.upload(CUBE, "cube.obj")
        client.render(model, encoding=wire.TIFF)
        writer = workers(server.process.pid)["sheend-image"]
        os.kill(writer, signal.SIGSTOP)
        self.told_at_the_end(server, client, client.ask(model, encoding=wire.TIFF))
        self.assertNotIn("at work", server.errors())
        server.stop()

    def test_the_client_goes_on_with_the_next(self):
        with tempfile.TemporaryDirectory(prefix="sheen-test-") as folder:
            server = Daemon("--drain-timeout", "1", folder=folder, tcp=False)
            reader = workers(server.process.pid)["sheend-cage"]
            os.kill(reader, signal.SIGSTOP)
            client = subprocess.Popen([SHEEN, "render", FENDER, "--server", server.unix, "--size",
                                       "64x48", "-o", os.path.join(folder, "a.png")],
                                      stderr=subprocess.PIPE, text=True)
            with wire.Client(server.unix) as other:
                stats = other.stats()
                while stats[UPLOADS_BYTES][0] < os.path.getsize(FENDER) or stats[QUEUED][0] < 1:
                    time.sleep(0.02)
                    stats = other.stats()
            self.assertEqual(server.stop(), 0)
            after = Daemon(folder=folder, tcp=False)
            said = client.communicate(timeout=60)[1]
            self.assertEqual(client.returncode, 0, said)
            self.assertIn("not done within the 1 s (drain-timeout)", said)
            self.assertIn("connecting again", said)
            self.assertEqual(after.stop(), 0)


class Sending(unittest.TestCase):
    """A socket that accepts one byte, no byte, or fails, at every n-th write."""

    def serve(self, faults):
        server = FaultyDaemon(faults)
        self.addCleanup(lambda: server.process.poll() is None and server.stop())
        return server

    def draw(self, address):
        with wire.Client(address) as client:
            model = client.upload(CUBE, "cube.obj")
            return [client.render(model, 700, 500, encoding=encoding).data
                    for encoding in (wire.RAW, wire.ZSTD) for _ in range(4)]

    def test_what_arrives_is_the_same(self):
        healthy = self.serve("send.short:1:0")
        want = self.draw(healthy.unix)
        for fault in ("send.short", "send.full"):
            for every in (1, 2):
                server = self.serve(f"{fault}:{every}:40")
                self.assertEqual([self.draw(address) for address in (server.unix, server.tcp)],
                                 [want, want])
                self.assertGreater(server.errors().count(f"fault: {fault}"), 10)
                self.assertEqual(server.stop(), 0)

    def test_a_broken_one_ends_its_session_alone(self):
        server = self.serve("send.broken:6:1")
        with wire.Client(server.unix) as other, wire.Client(server.tcp) as client:
            model = client.upload(CUBE, "cube.obj")
            with self.assertRaises((EOFError, OSError)):
                for _ in range(6):
                    client.render(model)
            self.assertEqual(server.errors().count("fault: send.broken"), 1)
            other.render(other.upload(CUBE, "cube.obj"))
            self.assertEqual(other.stats()[2], [1])
        self.assertEqual(server.stop(), 0)


class TakenOver(unittest.TestCase):
    """Somebody's code runs within the daemon: what it may no longer do is refused, and clients are served."""
    NEEDED_BY_SANITIZERS = ("a process", "signal 0 to the parent", "ptrace", "a file to write", "a file to make", "ioctl",
                            "memory to execute", "memory made executable")  # by their run-time libraries

    def refused(self, fault, *arguments):
        server = FaultyDaemon(fault + ":1:1", *arguments)
        with wire.Client(server.unix) as client:
            frame = client.render(client.upload(CUBE, "cube.obj"))
        self.assertEqual(len(frame.data), 64 * 48 * 4)
        said = server.wait_for("refused: ")
        self.assertEqual(server.stop(), 0)
        refused, tried = re.search(r"refused: (\d+) of (\d+) calls", said).groups()
        permitted = re.findall(r"permitted: (.+) \(", said)
        needed = self.NEEDED_BY_SANITIZERS if SANITIZED else ()
        self.assertLessEqual(set(permitted), set(needed))
        self.assertEqual(int(refused) + len(permitted), int(tried))
        return int(tried)

    def test_on_processors(self):
        self.assertEqual(self.refused("taken.over"), 38)
        self.assertEqual(self.refused("taken.over", "--models", MODELS), 38)

    @unittest.skipIf(MESA is None, "no GL device")
    def test_by_a_driver(self):
        self.assertEqual(self.refused("taken.over.gl", "--device", MESA), 32)


@unittest.skipIf(MESA is None, "no GL device")
class StuckCompiler(unittest.TestCase):
    """The driver's compiler never returns from a program for lattices."""
    LATTICE = wire.field(5, wire.field(6, wire.field(1, 1)))

    def test_frames_whose_programs_exist_are_drawn(self):
        server = FaultyDaemon("lattice.stuck:1:1", "--device", MESA, "--stuck-after", "1", "--metrics", "tcp:127.0.0.1:0")
        self.addCleanup(server.process.kill)
        with wire.Client(server.unix, minor=1) as first, wire.Client(server.unix) as second:
            model = first.upload(CUBE, "cube.obj", share=True)
            expected = first.render(model).data
            lattices = [first.ask(model, extra=self.LATTICE, kind=wire.BATCH) for _ in range(2)]
            server.wait_for("fault: lattice.stuck")
            for client in (second, first):
                for _ in range(3):
                    self.assertEqual(client.render(model).data, expected)
            for seq in lattices:
                first.send(wire.message(wire.CANCEL, seq))
            cancelled = [first.answer() for _ in lattices]
            self.assertEqual({seq for seq, _ in cancelled}, set(lattices))
            self.assertEqual({error.code for _, error in cancelled}, {wire.ERROR_CANCELLED})
            self.assertEqual(second.render(model).data, expected)
        self.assert_health_tells(server)

    def assert_health_tells(self, server):
        address = metrics_address(server)
        while not get(address, "/healthz")[1].startswith("the compiler of shaders has been at one piece of work"):
            time.sleep(0.1)
        self.assertEqual(get(address, "/healthz")[0], 503)
        self.assertGreater(read_metrics(get(address, "/metrics")[1])['sheen_thread_busy_seconds{thread="compile"}'], 1)
        server.wait_for("the compiler of shaders")


class Killed(unittest.TestCase):
    """kill -9 of the daemon or of its client while a model is uploaded, built and drawn."""
    ROUNDS = int(os.environ.get("SHEEN_KILLS", "6"))

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.addCleanup(self.folder.cleanup)
        self.model = os.path.join(self.folder.name, "big.obj")
        with open(self.model, "wb") as file:
            file.write(grid(100))
        self.path = os.path.join(self.folder.name, "sheen.sock")
        seed = random.randrange(1 << 32)
        self.noise = random.Random(seed)
        print(f"seed {seed}", end=" ", flush=True)

    def start_client(self, *more):
        return subprocess.Popen([SHEEN, "render", self.model, "--size", "900x700", "-o",
                                 os.path.join(self.folder.name, "out.png"), *more],
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def wait_until(self, is_so, what):
        end = time.monotonic() + 20
        while not is_so():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.02)

    def wait_for_end_of(self, pids):
        self.wait_until(lambda: not any(is_alive(pid) for pid in pids), f"{pids} live on")

    def family(self, pid):
        """A process's children and their descendants that have not ended."""
        found = []
        try:
            for child in children(pid):
                found += [child, *self.family(child)]
        except (FileNotFoundError, ProcessLookupError):
            pass
        return found

    def test_daemon(self):
        for _ in range(self.ROUNDS):
            server = Daemon(folder=self.folder.name, path=self.path, tcp=False)
            client = self.start_client("--server", server.unix, "--reconnect", "0")
            time.sleep(self.noise.uniform(0, 0.8))
            family = self.family(server.process.pid)
            server.process.kill()
            server.process.wait()
            _, said = client.communicate(timeout=30)
            self.assertIn(client.returncode, (0, 4), said)
            self.wait_for_end_of(family)
            left = set(os.listdir(self.folder.name)) - {"big.obj", "sheen.sock"}
            self.assertEqual(left, {"out.png"} if "out.png" in left else set())
            server.stop()
        server = Daemon(folder=self.folder.name, path=self.path, tcp=False)
        client = self.start_client("--server", server.unix)
        _, said = client.communicate(timeout=60)
        self.assertEqual(client.returncode, 0, said)
        self.assertEqual(server.stop(), 0)
        self.assertFalse(os.path.exists(self.path))

    def test_client(self):
        server = Daemon(folder=self.folder.name, path=self.path, tcp=False)
        with wire.Client(server.unix) as other:
            for _ in range(self.ROUNDS):
                client = self.start_client("--server", server.unix)
                time.sleep(self.noise.uniform(0, 0.8))
                client.kill()
                client.communicate()
                self.wait_until(lambda: other.stats()[2] == [1], "the session lives on")
                self.assertLessEqual(set(os.listdir(self.folder.name)),
                                     {"big.obj", "sheen.sock", "out.png"})
        self.assertEqual(server.stop(), 0)

    def test_client_of_a_private_daemon(self):
        for _ in range(self.ROUNDS):
            client = self.start_client("--device", "software")
            time.sleep(self.noise.uniform(0, 1))
            family = self.family(client.pid)
            client.kill()
            client.communicate()
            self.wait_for_end_of(family)


if __name__ == "__main__":
    unittest.main()
