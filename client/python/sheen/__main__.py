"""python3 -m sheen: version, info, render."""
from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from pathlib import Path
from typing import Any, cast

from sheen import Error, Options, Session, __version__, messages
from sheen.errors import BadArgument, BadImage
from sheen.frame import ENDINGS
from sheen.planes import PLANES

EXIT_WRONG_USAGE = 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m sheen", description="Exact reflection lines on subdivision "
                                     "surfaces, from Python. The command `sheen` can do more.")
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("version", help="print the versions of the package and of the protocol")
    info = commands.add_parser("info", help="describe a model as one JSON object")
    render = commands.add_parser("render", help="render a picture, or planes as numpy's .npz")
    for command in (info, render):
        command.add_argument("model", metavar="MODEL")
        command.add_argument("--weld", action="store_true", help="join vertices of an OBJ file at equal positions")
        for name in ("server", "ca", "cert", "key", "token-file", "device"):
            command.add_argument("--" + name, help="as for the command sheen")
    render.add_argument("-o", "--output", metavar="FILE", required=True,
                        help="a picture (.png .exr .jpg .tif), or .npz for arrays")
    render.add_argument("--planes", default="colour", metavar="LIST", help=f"of an .npz file: {','.join(PLANES)}")
    for option in Options.__annotations__:
        if option not in ("camera",):
            render.add_argument("--" + option.rstrip("_").replace("_", "-"), dest="option_" + option, metavar="VALUE",
                                help="as for sheen render")
    return parser


def _connect(given: argparse.Namespace) -> Session:
    token = None
    if given.token_file:
        try:
            token = Path(given.token_file).read_text(encoding="utf-8").splitlines()[0]
        except (OSError, IndexError) as wrong:
            raise BadArgument(f"cannot read a token from {given.token_file}: {wrong}") from None
    return Session(given.server, token=token, ca=given.ca, cert=given.cert, key=given.key, device=given.device)


def _plain(value: Any) -> Any:
    return value.hex() if isinstance(value, bytes) else value


def _info(given: argparse.Namespace) -> None:
    with _connect(given) as session:
        info = session.info(session.upload(given.model, weld=given.weld))
    rows = dataclasses.asdict(info, dict_factory=lambda pairs: {name: _plain(value) for name, value in pairs
                                                                if value is not None})
    print(json.dumps(rows, indent=1))


def _render(given: argparse.Namespace) -> None:
    import numpy as np
    ending = Path(given.output).suffix.lower()
    format = next((name for name, endings in ENDINGS.items() if ending in endings), None)
    if not format and ending != ".npz":
        raise BadArgument(f"{given.output}: must end in .png .exr .jpg .jpeg .tif .tiff or .npz")
    options = {name: value for name in Options.__annotations__
               if (value := getattr(given, "option_" + name, None)) is not None}
    with _connect(given) as session:
        model = session.upload(given.model, weld=given.weld)
        frame = session.render(model, planes=given.planes.split(",") if ending == ".npz" else ("colour",),
                               format=format or "planes", **cast(Options, options))
    if format:
        frame.save(given.output)
        return
    try:
        np.savez_compressed(given.output, **frame.planes)
    except OSError as wrong:
        raise BadImage(f"{given.output}: cannot be written: {wrong.strerror}") from None


def main() -> int:
    given = _parser().parse_args()
    try:
        if given.command == "version":
            print(f"sheen {__version__}, protocol 1.{messages.MINOR}")
        else:
            (_info if given.command == "info" else _render)(given)
        return 0
    except Error as failure:
        print(f"sheen: {failure}", file=sys.stderr)
        return failure.exit_code


if __name__ == "__main__":
    sys.exit(main())
