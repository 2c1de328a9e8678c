#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A program with one fault after the other: the search must see each, and nothing where there is none.

usage: red.py      without cuboct: a script stands for it"""
import sys
sys.dont_write_bytecode = True

import os
import re
import subprocess
import tempfile

from inputs import Kinds

HERE = os.path.dirname(os.path.abspath(__file__))

GOOD = """#!/usr/bin/python3 -SE
import os, sys, signal, time, resource
words = sys.argv[1:]
out = words[words.index("--out") + 1] if "--out" in words else None
def refuse(text="in/scene.toml:3:1: no such thing\\n   3 | x\\n     | ^\\n  hint: another\\n"):
    sys.stderr.write(text)
    sys.exit(2)
def make(path, data):
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "wb") as file:
        file.write(data)
if words[0] == "check":
    FAULT
    refuse()
if out:
    make(out + "/summary.json", b"{}")
FAULTS_OF_RUNS
"""

# What a sound program does on `check` in its place: a word of the find, and the fault.
ON_CHECK = {
    "crash: SIGSEGV": "os.kill(os.getpid(), signal.SIGSEGV)",
    "crash: SIGABRT": "sys.stderr.write('terminate'); sys.stderr.flush(); os.abort()",
    "hang: more than": "\n    while True: pass",
    "hang: waits": "time.sleep(1000)",
    "memory:": "x = bytearray(150 << 20)",
    "wrong code: exit code 3": "sys.exit(3)",
    "wrong code: exit code 1 where nothing ran": "sys.stderr.write('bad\\n'); sys.exit(1)",
    "foreign file: beside was left": "make('beside', b'x')",
    "foreign file: tmp/x was left": "make(os.environ['TMPDIR'] + '/x', b'x')",
    "foreign file: home/.x was left": "make(os.environ['HOME'] + '/.x', b'x')",
    "foreign file: in/scene.toml was changed": "make('in/scene.toml', b'x')",
    "foreign file: in/silicon.tersoff is gone": "os.unlink('in/silicon.tersoff')",
    "half written: out/ after exit code 2": "make('out/half', b'x')",
    "foreign words": "refuse('in/scene.toml:1:1: [json.exception.type_error.302] type must be number\\n')",
    "foreign words: in/scene.toml:1:1: stoi": "refuse('in/scene.toml:1:1: stoi\\n')",
    "foreign words: in/scene.toml:1:1: basic": "refuse('in/scene.toml:1:1: basic_string::at: out of range\\n')",
    "foreign words: in/scene.toml:1:1: H5F": "refuse('in/scene.toml:1:1: H5Fopen(): unable to open file\\n')",
    "foreign words: AddressSanitizer": "sys.stderr.write('AddressSanitizer: x\\n'); sys.exit(0)",
    "control character: '\\\\x1b'": "refuse('in/scene.toml:1:1: a \\x1b[2J\\n')",
    "control character: no UTF-8": "sys.stderr.buffer.write(b'in/scene.toml:1:1: \\xff\\n'); sys.exit(2)",
    "enormous message: ": "refuse('in/scene.toml:1:1: ' + 'x' * 5000 + '\\n')",
    "no place: no such thing": "refuse('no such thing\\n')",
    "shape: more than one error": "refuse('in/scene.toml:1:1: a\\nin/scene.toml:2:1: b\\n')",
    "shape: exit code 2 without": "refuse('')",
    "process left": "\n    if os.fork() == 0: time.sleep(100)",
}
ON_RUN = {
    "leftover: out/results.db-wal": "if out: make(out + '/results.db-wal', b'x')",
    "leftover: out/trace.h5.17.tmp": "if out: make(out + '/trace.h5.17.tmp', b'x')",
    "half written: out/summary.json": "if out: make(out + '/summary.json', b'{\"a\": ')",
    "half written: out/trace.h5 begins": "if out: make(out + '/trace.h5', b'x')",
}


def number_of(command):
    """The first input of scenes that is for this command."""
    kinds = Kinds(os.path.dirname(os.path.dirname(HERE)), {})
    return next(n for n in range(1000) if kinds.case(1, "scene", n).command[0] == command)


def search(place, number):
    environment = os.environ | {"MUTATED_CPU_SECONDS": "2", "MUTATED_PEAK_MIB": "100", "MUTATED_STALL_SECONDS": "3"}
    ended = subprocess.run([f"{HERE}/run", "--only", f"scene:{number}", "--keep", f"{place}/finds", place],
                           env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    return ended.returncode, ended.stdout + ended.stderr


def wrong(fault, on_check, on_run, number):
    """What the search gets wrong of a program that has this fault."""
    with tempfile.TemporaryDirectory(prefix="mutated_red_") as place:
        with open(f"{place}/cuboct", "w", encoding="utf-8") as file:
            file.write(GOOD.replace("FAULTS_OF_RUNS", on_run).replace("FAULT", on_check))
        os.chmod(f"{place}/cuboct", 0o755)
        code, said = search(place, number)
        last = said.rstrip().split("\n")[-1]
        if not fault:
            return None if code == 0 and last == "1 inputs, 0 finds" else said
        if code != 1 or fault not in said or last != "1 inputs, 1 finds":
            return said
        again = re.search(r"again: \S+ --seed 1 --only (\w+):(\d+) ", said)
        if not again or not os.path.isfile(f"{place}/finds/{again[1]}_{again[2]}/command"):
            return "no command that repeats it, or the input was not kept:\n" + said
        return None


def main():
    check, run = number_of("check"), number_of("run")
    trials = [(None, "pass", "pass", check), (None, "pass", "pass", run)]
    trials += [(fault, what, "pass", check) for fault, what in ON_CHECK.items()] + [(fault, "pass", what, run) for fault, what in ON_RUN.items()]
    missed = 0
    for fault, on_check, on_run, number in trials:
        answer = wrong(fault, on_check, on_run, number)
        if answer is not None:
            missed += 1
            print(f"not seen: {fault or 'a sound program'}\n{answer}")
    print(f"{len(trials)} programs, {missed} not judged rightly")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
