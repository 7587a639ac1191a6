# SPDX-License-Identifier: MIT
"""Pack a SPIR-V module for the program: words in hexadecimal, to be included in an array of C.

    pack_shader.py MODULE.spv LIST.inc

The size in bytes, how many specialization constants there may be, the bits of each that the module
reads, and the module deflated: the first bytes of all words, their second bytes, and so on.
renderer/shader_code.h reads it.
"""

import array
import pathlib
import sys
import zlib

HEADER_WORDS = 5
OP_NAME, OP_MEMBER_NAME, OP_CAPABILITY, OP_DECORATE, OP_MEMBER_DECORATE = 5, 6, 17, 71, 72
OP_CONSTANT_TRUE, OP_CONSTANT_FALSE, OP_CONSTANT = 41, 42, 43
OP_SPEC_CONSTANT_TRUE, OP_SPEC_CONSTANT, OP_SPEC_CONSTANT_OP = 48, 50, 52
OP_SELECT, OP_SHIFT_RIGHT_LOGICAL, OP_BITWISE_AND = 169, 194, 199
ASK_FOR_NOTHING = {OP_NAME, OP_MEMBER_NAME, OP_DECORATE, OP_MEMBER_DECORATE,
                   *range(OP_SPEC_CONSTANT_TRUE, OP_SPEC_CONSTANT + 1)}
SPEC_ID = 1
ALL_BITS = 0xFFFFFFFF
# To take a texel buffer of an array by a number that is not known, which lavapipe does not offer:
# the front end asks for it wherever a function is told the number, and has it known in the end.
IDLE_CAPABILITY = 5305  # StorageTexelBufferArrayDynamicIndexing


def instructions(words):
    at = HEADER_WORDS
    while at < len(words):
        length = words[at] >> 16
        yield words[at] & 0xFFFF, words[at : at + length]
        at += length


class Constants:
    """The constants of a module, and which bits of those that are open it reads."""

    def __init__(self, words):
        self.open, self.known, self.made = {}, {}, {}  # by id: number, value, (operation, operands)
        asked_for = set()  # ids, and literals, which at worst keep bits too many
        for operation, instruction in instructions(words):
            if operation == OP_DECORATE and instruction[2] == SPEC_ID:
                self.open[instruction[1]] = instruction[3]
            elif operation in (OP_CONSTANT_TRUE, OP_CONSTANT_FALSE):
                self.known[instruction[2]] = int(operation == OP_CONSTANT_TRUE)
            elif operation == OP_CONSTANT:
                self.known[instruction[2]] = instruction[3]
            elif operation == OP_SPEC_CONSTANT_OP:
                self.made[instruction[2]] = (instruction[3], instruction[4:])
            elif operation not in ASK_FOR_NOTHING:
                asked_for.update(instruction[1:])
        self.bits, self.read = [0] * (1 + max(self.open.values(), default=-1)), set()
        for name in asked_for:
            self.ask_for(name, ALL_BITS)

    def ask_for(self, name, bits):
        """Somebody reads these bits of a constant."""
        if name in self.open:
            self.bits[self.open[name]] |= bits
        elif name in self.made and (name, bits) not in self.read:
            self.read.add((name, bits))
            for operand, its_bits in self.operands(*self.made[name], bits):
                self.ask_for(operand, its_bits)

    def operands(self, operation, operands, bits):
        """What an operation reads for these bits of its result: a choice that is known reads one
        side, a shift higher bits, a mask those that it lets through; all else reads everything."""
        first, *others = operands
        if operation == OP_SELECT and first in self.known:
            return [(others[0 if self.known[first] else 1], bits)]
        if operation == OP_SHIFT_RIGHT_LOGICAL and others[0] in self.known:
            return [(first, bits << self.known[others[0]] & ALL_BITS)]
        if operation == OP_BITWISE_AND and others[0] in self.known:
            return [(first, bits & self.known[others[0]])]
        return [(operand, ALL_BITS) for operand in operands]


def pack(module: bytes) -> array.array:
    words = array.array("I", module)
    kept = words[:HEADER_WORDS]
    for operation, instruction in instructions(words):
        if operation != OP_CAPABILITY or instruction[1] != IDLE_CAPABILITY:
            kept.extend(instruction)
    bits = Constants(words).bits
    code = kept.tobytes()
    deflated = zlib.compress(b"".join(code[b::4] for b in range(4)), 9)
    packed = array.array("I", [4 * len(kept), len(bits), *bits])
    packed.frombytes(deflated + bytes(-len(deflated) % 4))
    return packed


def main():
    module, to = map(pathlib.Path, sys.argv[1:])
    words = [f"0x{word:x}," for word in pack(module.read_bytes())]
    lines = ["".join(words[i : i + 12]) for i in range(0, len(words), 12)]
    to.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
