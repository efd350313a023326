"""Compile the ``.proto`` files under ``schemas/`` into the FileDescriptorSets that are committed beside them.

For developers, after a change of a ``.proto``: ``python -m vines.schema._compile`` writes the sets anew, with
``--check`` it only says whether they are current. It needs grpcio-tools (in the ``dev`` extra); reading the
compiled set does not. Comments travel with the set, so that units can be shown and a log explains itself.
"""

from __future__ import annotations

import sys
import tempfile
from importlib import resources
from pathlib import Path

from vines.errors import SchemaError
from vines.packages import need
from vines.places import shipped

__all__ = ["DESCRIPTOR_SETS", "compile_descriptor_set", "main"]

DESCRIPTOR_SETS = {"vines.v1.binpb": "vines/v1", "vines.raw.binpb": "vines/raw", "foxglove.binpb": "foxglove"}
"""The compiled sets in the folder ``schemas``, and the folder of the sources of each."""


def compile_descriptor_set(schemas: Path, folder: str = "vines/v1") -> bytes:
    """Return the FileDescriptorSet of all ``.proto`` of a folder, serialised.

    Parameters
    ----------
    schemas : Path
        The folder ``schemas``.
    folder : str
        Folder of the sources in it.

    Raises
    ------
    PackageMissingError
        If grpcio-tools is missing.
    SchemaError
        If a source does not compile (its message is on stderr).
    """
    need("grpc_tools")
    from grpc_tools import protoc

    sources = sorted(path.relative_to(schemas).as_posix() for path in (schemas / folder).glob("*.proto"))
    well_known = resources.files("grpc_tools") / "_proto"
    with tempfile.TemporaryDirectory() as temporary:
        out = Path(temporary) / "set.binpb"
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
    """Write the sets, or with ``--check`` compare them; return the exit status (1 when one is out of date)."""
    schemas = shipped("schemas")
    late = 0
    for name, folder in DESCRIPTOR_SETS.items():
        target = schemas / name
        compiled = compile_descriptor_set(schemas, folder)
        current = target.is_file() and target.read_bytes() == compiled
        if "--check" in arguments:
            print(f"{name} is {'current' if current else 'out of date'}")
            late += not current
        else:
            if not current:
                target.write_bytes(compiled)
            print(f"{name}: {len(compiled)} bytes, {'unchanged' if current else 'written'}")
    return 1 if late else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
