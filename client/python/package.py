#!/usr/bin/python3
"""Makes the package: package.py VERSION FOLDER. Copies client/python/sheen to FOLDER/sheen and writes messages.py and
version.py there, FOLDER/sheen-VERSION.dist-info, and a wheel of both. Equal sources give an equal wheel. Needs no
network and only Python's standard library."""
import base64
import hashlib
import os
import shutil
import sys
import zipfile

import tables

HERE = os.path.dirname(os.path.abspath(__file__))
METADATA = """Metadata-Version: 2.1
Name: sheen
Version: {}
Summary: Exact reflection lines on subdivision surfaces, rendered by a daemon, as numpy arrays
License: MIT
Requires-Python: >=3.11
Requires-Dist: numpy>=1.20
Provides-Extra: zstd
Requires-Dist: zstandard; extra == "zstd"
"""
WHEEL = """Wheel-Version: 1.0
Generator: sheen
Root-Is-Purelib: true
Tag: py3-none-any
"""


def write(folder, name, text):
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)


def write_wheel(folder, version, names):
    """The wheel of these files, which are below the folder; RECORD has their hashes."""
    record = f"sheen-{version}.dist-info/RECORD"
    rows = []
    with zipfile.ZipFile(os.path.join(folder, f"sheen-{version}-py3-none-any.whl"), "w") as wheel:

        def add(name, data):
            info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o100644 << 16
            wheel.writestr(info, data)

        for name in names:
            with open(os.path.join(folder, name), "rb") as file:
                data = file.read()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            rows.append(f"{name},sha256={digest},{len(data)}\n")
            add(name, data)
        add(record, "".join(rows) + f"{record},,\n")


def main():
    version, folder = sys.argv[1:]
    shutil.rmtree(folder, ignore_errors=True)
    source, made = os.path.join(HERE, "sheen"), os.path.join(folder, "sheen")
    about = os.path.join(folder, f"sheen-{version}.dist-info")
    os.makedirs(made)
    os.makedirs(about)
    for name in os.listdir(source):
        if name.endswith(".py") or name == "py.typed":
            shutil.copyfile(os.path.join(source, name), os.path.join(made, name))
    write(made, "messages.py", tables.module(os.path.join(HERE, "..", "..", "protocol")))
    write(made, "version.py", f'"""The version of the package."""\n__version__ = "{version}"\n')
    write(about, "METADATA", METADATA.format(version))
    write(about, "WHEEL", WHEEL)
    write_wheel(folder, version, [f"{os.path.basename(top)}/{name}" for top in (made, about)
                                  for name in sorted(os.listdir(top))])


if __name__ == "__main__":
    main()
