#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Compiles an HLSL file with the DirectX Shader Compiler where only its library is there, not its program.

dxc.py [ARGUMENT…] FILE, the arguments being those of `dxc`. The library is DXC_LIBRARY, or libdxcompiler.so beside this file.
`scripts/dxc.sh` gets one. Its interfaces are COM's as Linux builds of that version have them: IUnknown with a virtual destructor.
"""

import ctypes
import os
import sys
import uuid
from pathlib import Path

COMPILER = uuid.UUID("73e22d93-e6ce-47f3-b5bf-f0664f39c1b0")
ICOMPILER = uuid.UUID("228b4687-5a6a-4730-900c-9702b2203f54")
IRESULT = uuid.UUID("58346cda-dde7-4497-9461-6f87af5e0659")
# After QueryInterface, AddRef, Release and two destructors.
FIRST_METHOD = 5
UTF8 = 65001


class Source(ctypes.Structure):
    """DxcBuffer."""

    _fields_ = [("bytes", ctypes.c_char_p), ("size", ctypes.c_size_t), ("encoding", ctypes.c_uint32)]


def method(this, index, result, *arguments):
    """Calls a method of an interface by its place after those of IUnknown."""
    table = ctypes.cast(this, ctypes.POINTER(ctypes.POINTER(ctypes.c_void_p)))[0]
    types = [ctypes.c_void_p, *(type(argument) for argument in arguments)]
    return ctypes.CFUNCTYPE(result, *types)(table[FIRST_METHOD + index])(this, *arguments)


def pointer(to):
    return ctypes.cast(ctypes.byref(to), ctypes.c_void_p)


def main():
    *arguments, file = sys.argv[1:]
    library = os.environ.get("DXC_LIBRARY", Path(__file__).resolve().parent / "libdxcompiler.so")
    create = ctypes.CDLL(str(library)).DxcCreateInstance
    create.restype = ctypes.c_int32
    compiler, result, status, said = (ctypes.c_void_p(), ctypes.c_void_p(), ctypes.c_int32(), ctypes.c_void_p())
    if create(COMPILER.bytes_le, ICOMPILER.bytes_le, ctypes.byref(compiler)) != 0:
        sys.exit(f"{library} gives no compiler")
    text = Path(file).read_bytes()
    source = Source(text, len(text), UTF8)
    words = (ctypes.c_wchar_p * len(arguments))(*arguments)
    interface = ctypes.create_string_buffer(IRESULT.bytes_le, 16)
    count, none = ctypes.c_uint32(len(arguments)), ctypes.c_void_p()
    method(
        compiler, 0, ctypes.c_int32, pointer(source), pointer(words), count, none, pointer(interface), pointer(result)
    )
    method(result, 0, ctypes.c_int32, pointer(status))
    method(result, 2, ctypes.c_int32, pointer(said))
    size = method(said, 1, ctypes.c_size_t)
    message = ctypes.string_at(method(said, 0, ctypes.c_void_p), size).decode(errors="replace") if size else ""
    sys.stderr.write(message.replace("hlsl.hlsl:", f"{file}:").rstrip("\0"))
    # The library's destructors need not run.
    sys.stderr.flush()
    os._exit(0 if status.value == 0 else 1)


main()
