#!/usr/bin/env python3
"""Makes the models in this folder: python3 tests/models/make_models.py [FOLDER]. Needs only Python's standard
library, and gives the same bytes on every machine. Coordinates are rounded to multiples of 2^-12, which single
precision (glTF) and OBJ's decimals both represent exactly, so that fender.obj and fender.gltf are the same cage."""
import base64
import json
import math
import os
import struct
import sys

GRID = 4096


def snap(value):
    return round(value * GRID) / GRID


class Cage:
    """Vertices and faces; vertices are numbered in the order in which the faces first use them."""

    def __init__(self, positions, faces):
        order = {}
        for face in faces:
            for vertex in face:
                order.setdefault(vertex, len(order))
        self.positions = [None] * len(order)
        for vertex, number in order.items():
            self.positions[number] = tuple(snap(x) + 0.0 for x in positions[vertex])
        self.faces = [tuple(order[vertex] for vertex in face) for face in faces]


def write_obj(path, cage, tags=(), comment=""):
    with open(path, "w", newline="\n") as out:
        out.write("# %s\n# made by tests/models/make_models.py\n" % comment)
        for p in cage.positions:
            out.write("v %r %r %r\n" % p)
        for face in cage.faces:
            out.write("f %s\n" % " ".join(str(v + 1) for v in face))
        for tag in tags:
            out.write(tag + "\n")


def write_usd(path, cage, tags, comment):
    """USD's text form. Tags are those of single edges, vertices and faces, as write_obj() takes them."""
    kinds = {"crease": [], "corner": [], "hole": []}
    for tag in tags:
        _, kind, _, *values = tag.split()
        kinds[kind].append(values)

    def array(kind, name, values):
        return "    %s[] %s = [%s]\n" % (kind, name, ", ".join(str(value) for value in values))

    with open(path, "w", newline="\n") as out:
        out.write('#usda 1.0\n(\n    doc = """%s\n    made by tests/models/make_models.py"""\n    metersPerUnit = 1\n'
                  '    upAxis = "Z"\n)\n\ndef Mesh "cage"\n{\n' % comment)
        out.write('    uniform token subdivisionScheme = "catmullClark"\n'
                  '    uniform token interpolateBoundary = "edgeOnly"\n')
        out.write(array("point3f", "points", ("(%r, %r, %r)" % p for p in cage.positions)))
        out.write(array("int", "faceVertexCounts", (len(face) for face in cage.faces)))
        out.write(array("int", "faceVertexIndices", (v for face in cage.faces for v in face)))
        out.write(array("int", "creaseIndices", (v for crease in kinds["crease"] for v in crease[:2])))
        out.write(array("int", "creaseLengths", (2 for _ in kinds["crease"])))
        out.write(array("float", "creaseSharpnesses", (crease[2] for crease in kinds["crease"])))
        out.write(array("int", "cornerIndices", (corner[0] for corner in kinds["corner"])))
        out.write(array("float", "cornerSharpnesses", (corner[1] for corner in kinds["corner"])))
        out.write(array("int", "holeIndices", (v for hole in kinds["hole"] for v in hole)))
        out.write("}\n")


def fan(faces):
    """FB_ngon_encoding: a fan of triangles for each polygon; two fans in a row have different first vertices."""
    triangles, previous = [], None
    for face in faces:
        if face[0] == previous:
            raise ValueError("rotate the faces first")
        previous = face[0]
        for i in range(1, len(face) - 1):
            triangles.append((face[0], face[i], face[i + 1]))
    return triangles


def write_gltf(path, cage, pieces, name):
    """One mesh of several primitives with separate vertices, whose seams the reader must weld."""
    size = (len(cage.faces) + pieces - 1) // pieces
    data, views, accessors, primitives = b"", [], [], []

    def add(payload, accessor, target):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(payload),
                      "target": target})
        accessors.append(dict(accessor, bufferView=len(views) - 1))
        data += payload + b"\0" * (-len(payload) % 4)
        return len(accessors) - 1

    for start in range(0, len(cage.faces), size):
        part = Cage(cage.positions, cage.faces[start:start + size])
        points = part.positions
        indices = [v for triangle in fan(part.faces) for v in triangle]
        position = add(
            b"".join(struct.pack("<3f", *p) for p in points),
            {"componentType": 5126, "type": "VEC3", "count": len(points),
             "min": [min(p[i] for p in points) for i in range(3)],
             "max": [max(p[i] for p in points) for i in range(3)]}, 34962)
        index = add(struct.pack("<%dH" % len(indices), *indices),
                    {"componentType": 5123, "type": "SCALAR", "count": len(indices)}, 34963)
        primitives.append({"attributes": {"POSITION": position}, "indices": index, "mode": 4,
                           "extensions": {"FB_ngon_encoding": {}}})

    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode("ascii")
    document = {
        "asset": {"version": "2.0", "generator": "tests/models/make_models.py"},
        "extensionsUsed": ["FB_ngon_encoding"],
        "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "meshes": [{"name": name, "primitives": primitives}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": uri}]}
    with open(path, "w", newline="\n") as out:
        json.dump(document, out, indent=1)
        out.write("\n")


# Fender ----------------------------------------------------------------------------------------

class Layout:
    """A flat layout of quads, whose vertices are identified by name."""

    def __init__(self):
        self.points, self.numbers, self.faces = [], {}, []

    def vertex(self, key, point):
        if key not in self.numbers:
            self.numbers[key] = len(self.points)
            self.points.append(point)
        return self.numbers[key]

    def split(self):
        """Divides every quad into four, with new points at the middles."""
        points, middle, faces = list(self.points), {}, []

        def between(*vertices):
            key = tuple(sorted(vertices))
            if key not in middle:
                middle[key] = len(points)
                points.append(tuple(sum(self.points[v][i] for v in vertices) / len(vertices)
                                    for i in range(2)))
            return middle[key]

        for a, b, c, d in self.faces:
            ab, bc, cd, da = between(a, b), between(b, c), between(c, d), between(d, a)
            centre = between(a, b, c, d)
            faces += [(a, ab, centre, da), (ab, b, bc, centre), (centre, bc, c, cd),
                      (da, centre, cd, d)]
        self.points, self.faces = points, faces


ARCH_X, ARCH_Y, ARCH_R = 610.0, -40.0, 255.0
LENGTH = 1000.0


def top_edge(x):
    return 560.0 - 70.0 * (x / LENGTH - 0.35) ** 2 - 25.0 * (x / LENGTH)


def fender_layout():
    """A C of quads round the wheel arch, blocks round the C, and in front of it a fan of six.

    The blocks are columns 0..4 (front), 4..8 (over the arch), 8..10 (rear) by rows 0..2 (beside
    the arch) and 2..5 (over it); the corners of the C become vertices of valence 5. In the front a
    patch of 2 x 4 quads gives way to six round one vertex of valence 6, which leaves a vertex of
    valence 3 at the middle of either long side.
    """
    layout = Layout()
    columns = [0, 75, 155, 235, 300, 455, 610, 765, 920, 960, 1000]
    rows = [0, 0.27, 0.56, 0.70, 0.85, 1.0]

    def grid(i, j):
        x = float(columns[i])
        return layout.vertex((i, j), (x, rows[j] * top_edge(x)))

    def quad(i, j):
        return (grid(i, j), grid(i + 1, j), grid(i + 1, j + 1), grid(i, j + 1))

    for i in range(10):
        for j in range(5):
            in_arch = 4 <= i < 8 and j < 2
            in_fan = 1 <= i < 3 and 1 <= j < 5
            if not in_arch and not in_fan:
                layout.faces.append(quad(i, j))

    centre = layout.vertex("six", (155.0, rows[3] * top_edge(155.0) * 0.97))
    ring = ([(1, 1), (2, 1), (3, 1), (3, 2), (3, 3), (3, 4), (3, 5), (2, 5), (1, 5), (1, 4),
             (1, 3), (1, 2)])
    ring = [grid(i, j) for i, j in ring]
    for k in range(1, 12, 2):
        layout.faces.append((centre, ring[k], ring[(k + 1) % 12], ring[(k + 2) % 12]))

    outer = [(4, 0), (4, 1), (4, 2), (5, 2), (6, 2), (7, 2), (8, 2), (8, 1), (8, 0)]
    start = math.asin(-ARCH_Y / ARCH_R)
    for k in range(8):
        inner = []
        for step in (k, k + 1):
            angle = math.pi - start - (math.pi - 2 * start) * step / 8
            inner.append(layout.vertex(("arch", step), (ARCH_X + ARCH_R * math.cos(angle),
                                                        ARCH_Y + ARCH_R * math.sin(angle))))
        layout.faces.append((inner[0], inner[1], grid(*outer[k + 1]), grid(*outer[k])))
    return layout


def counter_clockwise(points, face):
    area = sum(points[a][0] * points[b][1] - points[b][0] * points[a][1]
               for a, b in zip(face, face[1:] + face[:1]))
    return face if area > 0 else tuple(reversed(face))


def relax(layout, rounds):
    """Moves every interior point towards the mean of its edge and face neighbours. The boundary is unchanged, except
    for the arch, whose points are put back onto its circle."""
    edges, around = {}, {}
    for face in layout.faces:
        for a, b in zip(face, face[1:] + face[:1]):
            edges[frozenset((a, b))] = edges.get(frozenset((a, b)), 0) + 1
        for k in range(4):
            weights = around.setdefault(face[k], {})
            for offset, weight in ((1, 1.0), (2, 0.5), (3, 1.0)):
                other = face[(k + offset) % 4]
                weights[other] = weights.get(other, 0.0) + weight
    fixed = {v for edge, count in edges.items() if count == 1 for v in edge}
    for _ in range(rounds):
        points = list(layout.points)
        for v, weights in around.items():
            if v in fixed:
                continue
            total = sum(weights.values())
            mean = [sum(layout.points[o][i] * w for o, w in weights.items()) / total
                    for i in range(2)]
            points[v] = tuple(0.4 * layout.points[v][i] + 0.6 * mean[i] for i in range(2))
        layout.points = points


def on_the_arch(layout):
    """After the division, the middles of the arch's edges lie on its chords; moves them onto the circle."""
    for v, (x, y) in enumerate(layout.points):
        radius = math.hypot(x - ARCH_X, y - ARCH_Y)
        if radius < ARCH_R * 1.01 and y > -1:
            scale = ARCH_R / radius
            layout.points[v] = (ARCH_X + (x - ARCH_X) * scale, ARCH_Y + (y - ARCH_Y) * scale)


def fender_height(x, y):
    """A crowned panel with a soft flare over the wheel, in mm; smooth everywhere."""
    u, v = x / LENGTH - 0.45, y / 500.0 - 0.35
    crown = 95.0 * (1 - 1.25 * u * u - 0.25 * u * u * u) - 95.0 * v * v - 14.0 * v * v * v
    distance = math.hypot(x - ARCH_X, y - ARCH_Y) - ARCH_R
    flare = 20.0 * math.exp(-(distance / 125.0) ** 2)
    return crown + flare


def limit_points(points, faces):
    """The point of the surface for each control point: Catmull-Clark's limit masks for quads, and a cubic B-spline
    along the boundary."""
    edges, diagonals, counts = {}, {}, {}
    for face in faces:
        for k, v in enumerate(face):
            after, before = face[(k + 1) % 4], face[k - 1]
            edges.setdefault(v, set()).update((after, before))
            diagonals.setdefault(v, []).append(face[(k + 2) % 4])
            edge = frozenset((v, after))
            counts[edge] = counts.get(edge, 0) + 1
    limits = []
    for v, point in enumerate(points):
        ends = [e for e in edges[v] if counts[frozenset((v, e))] == 1]
        if ends:
            weights, total = [(point, 4.0)] + [(points[e], 1.0) for e in ends], 6.0
        else:
            n = len(edges[v])
            weights = ([(point, float(n * n))] + [(points[e], 4.0) for e in sorted(edges[v])] +
                       [(points[d], 1.0) for d in diagonals[v]])
            total = float(n * (n + 5))
        limits.append([sum(p[i] * w for p, w in weights) / total for i in range(3)])
    return limits


def fit_height(points, faces, height):
    """Moves the control points in height until the surface (and not the cage) has the given height."""
    points = [(x, y, height(x, y)) for x, y in points]
    for _ in range(12):
        limits = limit_points(points, faces)
        points = [(x, y, z + height(lx, ly) - lz)
                  for (x, y, z), (lx, ly, lz) in zip(points, limits)]
    return points


def fender():
    layout = fender_layout()
    layout.split()
    on_the_arch(layout)
    layout.faces = [counter_clockwise(layout.points, face) for face in layout.faces]
    relax(layout, 60)
    faces, previous = [], None
    for face in layout.faces:
        if face[0] == previous:
            face = face[1:] + face[:1]
        previous = face[0]
        faces.append(face)
    return Cage(fit_height(layout.points, faces, fender_height), faces)


# The others ------------------------------------------------------------------------------------

def grid_cage(n, point):
    positions = [point(i / n, j / n, i, j) for j in range(n + 1) for i in range(n + 1)]
    faces = [(j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1,
              (j + 1) * (n + 1) + i) for j in range(n) for i in range(n)]
    return Cage(positions, faces)


def body():
    """A cube of 4 x 4 quads on each side, inflated to the shape of a car."""
    n, points, faces = 4, [], []
    numbers = {}

    def vertex(p):
        if p not in numbers:
            d = [math.tan(math.pi / 4 * c) for c in p]
            norm = math.sqrt(sum(c * c for c in d))
            # Between a ball and a box: the fourth-power norm keeps the corners round.
            box = sum(c ** 4 for c in d) ** 0.25
            d = [c * (0.35 / norm + 0.65 / box) for c in d]
            x, y, z = 2.1 * d[0], 0.85 * d[1], 0.5 * d[2]
            cabin = math.exp(-((x + 0.25) / 0.95) ** 2)
            z += 0.42 * cabin * (0.5 + 0.5 * math.tanh(2.5 * z))
            y *= 1 - 0.12 * (x / 2.1) ** 2
            numbers[p] = len(points)
            points.append((x, y, z))
        return numbers[p]

    axes = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
    steps = [2 * i / n - 1 for i in range(n + 1)]
    for u, v, w in axes:
        for side in (-1.0, 1.0):
            for j in range(n):
                for i in range(n):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        p = [0.0, 0.0, 0.0]
                        p[u], p[v], p[w] = steps[i + di], steps[j + dj], side
                        corners.append(vertex(tuple(p)))
                    faces.append(tuple(corners if side > 0 else reversed(corners)))
    return Cage(points, faces)


def sheet():
    def point(u, v, _i, _j):
        x, y = 4 * u - 2, 4 * v - 2
        return (x, y, 0.25 * math.sin(1.3 * x + 0.3) * math.cos(1.1 * y) + 0.06 * x * y)
    return grid_cage(12, point)


def plane():
    """The vertices are moved within the plane, far from any regular pattern."""
    state = 12345

    def random():
        nonlocal state
        state = (state * 1103515245 + 12345) % 2 ** 31
        return state / 2 ** 31 - 0.5

    def point(u, v, i, j):
        dx, dy = 0.16 * random(), 0.16 * random()
        if i in (0, 6):
            dx = dy = 0.0
        if j in (0, 6):
            dx = dy = 0.0
        return (2 * u - 1 + dx, 2 * v - 1 + dy, 0.0)
    return grid_cage(6, point)


def pole():
    """A dome: 24 triangles around its pole, and four rings of quads below them."""
    valence, rings = 24, 5
    points = [(0.0, 0.0, 1.0)]
    for ring in range(1, rings + 1):
        polar = math.radians(80) * ring / rings
        for k in range(valence):
            around = 2 * math.pi * k / valence
            points.append((math.sin(polar) * math.cos(around), math.sin(polar) * math.sin(around),
                           math.cos(polar)))
    faces = [(0, 1 + k, 1 + (k + 1) % valence) for k in range(valence)]
    for ring in range(rings - 1):
        a, b = 1 + ring * valence, 1 + (ring + 1) * valence
        faces += [(a + k, b + k, b + (k + 1) % valence, a + (k + 1) % valence)
                  for k in range(valence)]
    return Cage(points, faces)


def ngons():
    """A closed pentagonal drum of two storeys with one corner cut off above and one below: triangles, quads,
    pentagons and hexagons."""
    points, storeys = [], []
    for z, radius in ((-0.8, 0.85), (0.0, 1.0), (0.8, 0.85)):
        storeys.append([])
        for k in range(5):
            angle = 2 * math.pi * k / 5
            storeys[-1].append(len(points))
            points.append((radius * math.cos(angle), radius * math.sin(angle), z))
    bottom, middle, top = storeys
    faces = [list(reversed(bottom)), list(top)]
    for low, high in ((bottom, middle), (middle, top)):
        for k in range(5):
            m = (k + 1) % 5
            faces.append([low[k], low[m], high[m], high[k]])

    def cut(corner):
        """Replaces a vertex by a triangle with a new vertex on each of the vertex's edges."""
        on_edge = {}
        after = {}
        for face in faces:
            if corner not in face:
                continue
            at = face.index(corner)
            before, behind = face[at - 1], face[(at + 1) % len(face)]
            for other in (before, behind):
                if other not in on_edge:
                    on_edge[other] = len(points)
                    points.append(tuple(0.62 * points[corner][i] + 0.38 * points[other][i]
                                        for i in range(3)))
            face[at:at + 1] = [on_edge[before], on_edge[behind]]
            after[on_edge[behind]] = on_edge[before]
        start = next(iter(after))
        faces.append([start, after[start], after[after[start]]])

    cut(top[0])
    cut(bottom[2])
    return Cage(points, [tuple(face) for face in faces])


def tetra():
    points = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    return Cage(points, [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])


def creases():
    """The body with every kind of tag: a crease whose sharpness varies and ends, darts, three and more creases at a
    vertex, sharp vertices, and a hole."""
    cage = body()
    edges = sorted({tuple(sorted((f[k], f[k - 1]))) for f in cage.faces for k in range(len(f))})
    tags, state = [], 1

    def random(n):
        nonlocal state
        state = state * 1103515245 + 12345 & 0x7fffffff
        return state // 65536 % n

    sharpness = [0.4, 0.9, 1.0, 1.7, 2.5, 3.3, 5.6, 10.0]
    for a, b in edges:
        if random(4) == 0:
            tags.append("t crease 2/1/0 %d %d %g" % (a, b, sharpness[random(8)]))
    # A crease of constant sharpness, for strips: a ring of edges around the body.
    ring = [e for e in edges if all(abs(cage.positions[v][0]) < 1e-9 for v in e)]
    tags += ["t crease 2/1/0 %d %d 4.5" % e for e in ring]
    for vertex, value in ((3, 0.6), (17, 1.8), (40, 10.0), (55, 3.0)):
        tags.append("t corner 1/1/0 %d %g" % (vertex, value))
    tags.append("t hole 2/0/0 5 60")
    return cage, tags


def smooth_triangles():
    """The drum of ngons() with OpenSubdiv's smooth triangles, and some sharp edges on them."""
    cage = ngons()
    edges = sorted({tuple(sorted((f[k], f[k - 1]))) for f in cage.faces if len(f) == 3 for k in range(3)})
    tags = ["t smoothtriangles 0/0/1 smooth", "t creasemethod 0/0/1 chaikin"]
    tags += ["t crease 2/1/0 %d %d %g" % (*edge, sharpness)
             for edge, sharpness in zip(edges, (0.3, 0.8, 1.2))]
    return cage, tags


def nonmanifold():
    """A fin on a sheet, two sheets that share a vertex, and two quads with opposite windings."""
    points, faces = [], []

    def strip(origin, flip=False):
        first = len(points)
        for j in range(4):
            for i in range(4):
                points.append((origin[0] + i, origin[1] + j, origin[2] + 0.2 * (i - 1.5) ** 2))
        for j in range(3):
            for i in range(3):
                at = first + 4 * j + i
                face = (at, at + 1, at + 5, at + 4)
                faces.append(face[::-1] if flip and i == 1 and j == 1 else face)
        return first

    sheet_at = strip((0, 0, 0))
    fin = len(points)
    for j in range(4):
        points.append((1.2, j, 1.0))
    for j in range(3):
        faces.append((sheet_at + 4 * j + 1, sheet_at + 4 * j + 5, fin + j + 1, fin + j))
    left, right = strip((5, 0, 0)), strip((8, 3, 0))
    faces[:] = [tuple(left + 15 if v == right else v for v in face) for face in faces]
    strip((0, 5, 0), flip=True)
    return Cage(points, faces)


def triangles():
    """A waved sheet of plain triangles with a boundary; inner vertices have 4 to 8 triangles."""
    n, state = 10, 7

    def random():
        nonlocal state
        state = (state * 1103515245 + 12345) % 2 ** 31
        return state / 2 ** 31

    points = [(i + 0.3 * (random() - 0.5), j + 0.3 * (random() - 0.5), math.sin(0.7 * i) * math.cos(0.5 * j) + 0.1 * random())
              for j in range(n + 1) for i in range(n + 1)]
    faces = []
    for j in range(n):
        for i in range(n):
            a, b, c, d = (j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i)
            faces += [(a, b, c), (a, c, d)] if random() < 0.5 else [(a, b, d), (b, c, d)]
    return Cage(points, faces)


def bezier_pieces(control):
    """A cubic B-spline with uniform knots, which begins and ends at its first and last point, as Bezier pieces."""
    n, pieces = len(control), []
    knots = [0] * 3 + list(range(n - 2)) + [n - 3] * 3
    for k in range(3, n):
        a, b, piece = knots[k], knots[k + 1], []
        for j in range(4):  # the polar form at 3 - j times a and j times b
            d = list(control[k - 3:k + 1])
            for r in range(1, 4):
                x = a if r <= 3 - j else b
                for i in range(3, r - 1, -1):
                    low, high = knots[k - 3 + i], knots[k + 1 + i - r]
                    d[i] = tuple(((high - x) * p + (x - low) * q) / (high - low) for p, q in zip(d[i - 1], d[i]))
            piece.append(d[3])
        pieces.append(piece)
    return pieces


def bottle():
    """Bicubic Bezier patches: four around, seven from the middle of the bottom, a pole, to the mouth. The section is an ellipse
    of four cubic arcs, whose curvatures agree at their ends."""
    profile = [(0, 0, 0), (26, 0, 19), (38, 0, 26), (39, 12, 26), (33, 52, 24), (38, 96, 29), (34, 130, 26), (13, 140, 13),
               (12, 168, 12), (13, 184, 13)]  # half axis along x, height, half axis along z
    k = 0.5522847498307936  # 4 (sqrt(2) - 1) / 3
    arc = [(1, 0), (1, k), (k, 1), (0, 1)]
    patches = []
    for turn in range(4):
        for piece in bezier_pieces(profile):
            patches.append([(x * c, y, -z * s) for x, y, z in piece for c, s in arc])
        arc = [(-s, c) for c, s in arc]
    return patches


def write_bpt(path, patches, comment):
    with open(path, "w", newline="\n") as out:
        out.write("# %s\n# made by tests/models/make_models.py\n%d\n" % (comment, len(patches)))
        for patch in patches:
            out.write("3 3\n")
            for p in patch:
                out.write("%.13g %.13g %.13g\n" % tuple(x + 0.0 for x in p))


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))

    def path(name):
        return os.path.join(folder, name)

    panel = fender()
    write_obj(path("fender.obj"), panel, comment="A car's front fender with its wheel arch, millimetres")
    write_gltf(path("fender.gltf"), panel, 2, "fender")
    write_obj(path("body.obj"), body(), comment="A closed car-like body, metres")
    write_obj(path("sheet.obj"), sheet(), comment="An open wavy sheet")
    write_obj(path("plane.obj"), plane(), comment="A flat sheet in z = 0, its inner vertices moved in it")
    write_obj(path("pole.obj"), pole(), comment="A dome with a pole of valence 24")
    write_obj(path("ngons.obj"), ngons(), comment="A closed body of triangles, quads, pentagons, hexagons")
    write_obj(path("tetra.obj"), tetra(), comment="A tetrahedron")
    write_obj(path("creases.obj"), *creases(), comment="A closed body with every kind of tag")
    write_usd(path("creases.usda"), *creases(), comment="A closed body with every kind of tag")
    cage, tags = creases()
    write_obj(path("chaikin.obj"), cage, tags + ["t creasemethod 0/0/1 chaikin"],
              comment="The same body and tags, creases by Chaikin's rule")
    write_obj(path("smoothtriangles.obj"), *smooth_triangles(), comment="The drum with smooth triangles")
    write_obj(path("nonmanifold.obj"), nonmanifold(), comment="A fin, a shared vertex, a turned quad")
    write_obj(path("triangles.obj"), triangles(), comment="A waved sheet of plain triangles")
    write_bpt(path("bottle.bpt"), bottle(), comment="A bottle of 28 bicubic Bezier patches, millimetres")


if __name__ == "__main__":
    main()
