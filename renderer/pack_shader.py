# SPDX-License-Identifier: MIT
"""Pack a SPIR-V module for the program: words in hexadecimal, to be included in an array of C.

    pack_shader.py MODULE.spv LIST.inc

The size in bytes, a bit for each specialization constant that the module has, and the module
deflated. renderer/shader_code.h reads it.
"""

import array
import pathlib
import sys
import zlib

MASK_WORDS = 3  # as shader_code.h has it
HEADER_WORDS = 5
OP_NAME, OP_CAPABILITY, OP_SPEC_CONSTANT_TRUE, OP_SPEC_CONSTANT, OP_DECORATE = 5, 17, 48, 50, 71
SPEC_ID = 1
# To take a texel buffer of an array by a number that is not known, which lavapipe does not offer:
# the front end asks for it wherever a function is told the number, and has it known in the end.
IDLE_CAPABILITY = 5305  # StorageTexelBufferArrayDynamicIndexing


def instructions(words):
    at = HEADER_WORDS
    while at < len(words):
        length = words[at] >> 16
        yield words[at] & 0xFFFF, words[at : at + length]
        at += length


def asked_for(words) -> set:
    """Operands of all instructions: ids, and literals, which at worst keep a constant too many."""
    found = set()
    for operation, instruction in instructions(words):
        if OP_SPEC_CONSTANT_TRUE <= operation <= OP_SPEC_CONSTANT:
            continue  # which ask for none, and begin with their own
        if operation not in (OP_NAME, OP_DECORATE):
            found.update(instruction[1:])
    return found


def pack(module: bytes) -> array.array:
    words = array.array("I", module)
    used = asked_for(words)
    kept, mask = words[:HEADER_WORDS], 0
    for operation, instruction in instructions(words):
        if operation == OP_DECORATE and instruction[2] == SPEC_ID and instruction[1] in used:
            mask |= 1 << instruction[3]
        if operation != OP_CAPABILITY or instruction[1] != IDLE_CAPABILITY:
            kept.extend(instruction)
    if mask >> 32 * MASK_WORDS:
        sys.exit(f"a specialization constant beyond {32 * MASK_WORDS - 1}")
    deflated = zlib.compress(kept.tobytes(), 9)
    packed = array.array("I", [4 * len(kept)])
    packed.extend(mask >> 32 * i & 0xFFFFFFFF for i in range(MASK_WORDS))
    packed.frombytes(deflated + bytes(-len(deflated) % 4))
    return packed


def main():
    module, to = map(pathlib.Path, sys.argv[1:])
    words = [f"0x{word:x}," for word in pack(module.read_bytes())]
    lines = ["".join(words[i : i + 12]) for i in range(0, len(words), 12)]
    to.write_text("\n".join(lines) + "\n")


main()
