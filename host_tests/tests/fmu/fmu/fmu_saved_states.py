"""Saved states of an importer's instance, and their bytes."""

from __future__ import annotations

from fmu_importer import OK, Importer

SUFFIX = {2: "FMUstate", 3: "FMUState"}


def save(importer: Importer):
    """A new saved state."""
    state = importer.ffi.new("void **")
    importer.must(f"Get{SUFFIX[importer.version]}", state)
    return state


def serialize(importer: Importer) -> bytes:
    """The present state as bytes."""
    suffix, state, size = SUFFIX[importer.version], save(importer), importer.ffi.new("size_t *")
    importer.must(f"Serialized{suffix}Size", state[0], size)
    room = importer.ffi.new("char[]" if importer.version == 2 else "uint8_t[]", size[0])
    importer.must(f"Serialize{suffix}", state[0], room, size[0])
    importer.must(f"Free{suffix}", state)
    return bytes(importer.ffi.buffer(room))


def deserialize(importer: Importer, data: bytes) -> int:
    """Puts bytes back; the status."""
    suffix, state = SUFFIX[importer.version], importer.ffi.new("void **")
    name = f"DeSerialize{suffix}" if importer.version == 2 else f"Deserialize{suffix}"
    room = importer.ffi.new("char[]" if importer.version == 2 else "uint8_t[]", data)
    status = importer.call(name, room, len(data), state)
    if status == OK:
        importer.must(f"Set{suffix}", state[0])
        importer.must(f"Free{suffix}", state)
    return status
