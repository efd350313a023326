"""Compile ``schemas/vines/v1/*.proto`` into the FileDescriptorSet that is committed beside them.

For developers, after a change of a ``.proto``: ``python -m vines.schema._compile`` writes the set anew, with
``--check`` it only says whether it is current. It needs grpcio-tools (in the ``dev`` extra); reading the
compiled set does not. Comments travel with the set, so that units can be shown and a log explains itself.
"""

from __future__ import annotations

import sys
import tempfile
from importlib import resources
from pathlib import Path

from vines.errors import SchemaError
from vines.places import shipped

__all__ = ["DESCRIPTOR_SET", "compile_descriptor_set", "main"]

DESCRIPTOR_SET = "vines.v1.binpb"
"""Name of the compiled set in the folder ``schemas``."""


def compile_descriptor_set(schemas: Path) -> bytes:
    """Return the FileDescriptorSet of all ``vines/v1/*.proto`` under a folder, serialised.

    Parameters
    ----------
    schemas : Path
        The folder that holds ``vines/v1``.

    Raises
    ------
    SchemaError
        If grpcio-tools is missing, or a source does not compile (its message is on stderr).
    """
    try:
        from grpc_tools import protoc
    except ImportError as missing:
        raise SchemaError("compiling the schemas needs grpcio-tools; pip install '.[dev]'") from missing
    sources = sorted(path.relative_to(schemas).as_posix() for path in (schemas / "vines" / "v1").glob("*.proto"))
    well_known = resources.files("grpc_tools") / "_proto"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / DESCRIPTOR_SET
        status = protoc.main(
            [
                "protoc",
                f"--proto_path={schemas}",
                f"--proto_path={well_known}",
                "--include_imports",
                "--include_source_info",
                f"--descriptor_set_out={out}",
                *sources,
            ]
        )
        if status != 0:
            raise SchemaError(f"protoc exited {status} on {', '.join(sources)}; correct what it printed above")
        return out.read_bytes()


def main(arguments: list[str]) -> int:
    """Write the set, or with ``--check`` compare it; return the exit status (1 when it is out of date)."""
    folder = shipped("schemas")
    target = folder / DESCRIPTOR_SET
    compiled = compile_descriptor_set(folder)
    current = target.is_file() and target.read_bytes() == compiled
    if "--check" in arguments:
        print(f"{DESCRIPTOR_SET} is {'current' if current else 'out of date'}")
        return 0 if current else 1
    if not current:
        target.write_bytes(compiled)
    print(f"{DESCRIPTOR_SET}: {len(compiled)} bytes, {'unchanged' if current else 'written'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
