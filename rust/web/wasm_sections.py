"""The sections of a WebAssembly module: https://webassembly.github.io/spec/core/binary/modules.html."""

HEADER = b"\0asm\1\0\0\0"
CUSTOM, EXPORT = 0, 7


def sections(module):
    """Yields the id and the content of each section.

    Raises:
        ValueError: if it is not a WebAssembly module.
    """
    if not module.startswith(HEADER):
        raise ValueError("not a WebAssembly module of version 1")
    at = len(HEADER)
    while at < len(module):
        kind = module[at]
        length, start = _read(module, at + 1)
        at = start + length
        if at > len(module):
            raise ValueError("the WebAssembly module ends within a section")
        yield kind, module[start:at]


def custom_section(module, name):
    """Returns the content of a custom section; None if the module has none of that name."""
    for kind, content in sections(module):
        if kind == CUSTOM:
            length, start = _read(content, 0)
            if content[start : start + length] == name.encode():
                return content[start + length :]
    return None


def with_custom_section(module, name, content):
    """Returns the module with one more custom section at its end."""
    named = _written(len(name.encode())) + name.encode() + content
    return module + bytes([CUSTOM]) + _written(len(named)) + named


def exports(module):
    """Returns the names that a module exports."""
    names = set()
    for kind, content in sections(module):
        if kind == EXPORT:
            count, at = _read(content, 0)
            for _ in range(count):
                length, start = _read(content, at)
                names.add(content[start : start + length].decode())
                _, at = _read(content, start + length + 1)
    return names


def _read(content, at):
    """Returns an unsigned LEB128 number, and where it ends."""
    number = shift = 0
    while True:
        if at >= len(content):
            raise ValueError("the WebAssembly module ends within a number")
        byte = content[at]
        at += 1
        number |= (byte & 0x7F) << shift
        if byte < 0x80:
            return number, at
        shift += 7


def _written(number):
    """Returns a number as unsigned LEB128."""
    written = bytearray()
    while number >= 0x80:
        written.append(number & 0x7F | 0x80)
        number >>= 7
    written.append(number)
    return bytes(written)
