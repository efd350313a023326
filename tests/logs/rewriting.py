"""Rewrite an MCAP file with mcap's own reader and writer, as other programs do: new numbers, order, compression."""

import io
from collections.abc import Callable, Sequence

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer


def rewritten(
    data: bytes,
    *,
    compression: CompressionType = CompressionType.LZ4,
    chunk_size: int = 1 << 20,
    chunking: bool = True,
    crcs: bool = True,
    keep: Callable[[str], bool] = lambda topic: True,
    metadata: Callable[[str], bool] = lambda name: True,
    metadata_last: bool = False,
    first: Sequence[str] = (),
    order: Callable[[list], list] = list,
    spared: int = 0,
    library: str = "another program",
    sequences: bool = True,
) -> bytes:
    """Return the same messages in another file.

    Parameters
    ----------
    keep, metadata
        Which topics and which metadata records are kept.
    first
        Topics that are described first, and so get the lowest numbers.
    order
        Turns the list of (schema, channel, message) in the order of time into the one that is written.
    spared
        Numbers of channels that stay unused.
    """
    reader = make_reader(io.BytesIO(data))
    messages = order([each for each in reader.iter_messages() if keep(each[1].topic)])
    stream = io.BytesIO()
    writer = Writer(
        stream,
        compression=compression,
        chunk_size=chunk_size,
        use_chunking=chunking,
        enable_crcs=crcs,
        enable_data_crcs=crcs,
    )
    writer.start("", library)

    def describe() -> None:
        for name, values in ((each.name, each.metadata) for each in make_reader(io.BytesIO(data)).iter_metadata()):
            if metadata(name):
                writer.add_metadata(name, values)
        for each in make_reader(io.BytesIO(data)).iter_attachments():
            writer.add_attachment(each.create_time, each.log_time, each.name, each.media_type, each.data)

    if not metadata_last:
        describe()
    numbers: dict[str, int] = {}
    place = {topic: k for k, topic in enumerate(first)}
    seen = {channel.topic: (schema, channel) for schema, channel, _ in messages}
    for k in range(spared):
        writer.register_schema(f"spared.{k}", "protobuf", b"")
    for topic in sorted(seen, key=lambda topic: place.get(topic, len(place))):
        schema, channel = seen[topic]
        kind = writer.register_schema(schema.name, schema.encoding, schema.data)
        numbers[topic] = writer.register_channel(topic, channel.message_encoding, kind, channel.metadata)
    for _, channel, message in messages:
        sequence = message.sequence if sequences else 0
        writer.add_message(numbers[channel.topic], message.log_time, message.data, message.publish_time, sequence)
    if metadata_last:
        describe()
    writer.finish()
    return stream.getvalue()
