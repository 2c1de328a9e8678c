# SPDX-License-Identifier: MIT
"""What is wrong with how a program ended: a list of (kind of fault, what was seen)."""
import json
import os
import re
import signal

from sandbox import CPU_SECONDS

LONGEST_REFUSAL = 4000    # bytes: an excerpt shows 80 characters, a name of a user perhaps twice as much
LONGEST_WORDS = 200000    # of a run that was watched, or a table
LARGEST_PEAK = int(os.environ.get("MUTATED_PEAK_MIB", 1500)) << 20

# Words of libraries and of the language's runtime. What the input says may stand in a message; no input says these.
FOREIGN = re.compile(
    rb"\[json\.exception|terminate called|what\(\):|basic_string|\bstoi\b|\bstod\b|\bstoull?\b|filesystem error|std::|std_|\bH5[A-Z]?[a-z]*\b"
    rb"|HDF5-DIAG|vector::|_M_[a-z]+|bad_alloc|bad_cast|bad optional|bad_variant|bad_function|Assertion|assertion|Sanitizer|runtime error:"
    rb"|Segmentation|core dumped|SQLITE_|sqlite3_|toml::|nlohmann|Traceback|unordered_map::|map::at|CLI::|fmt::|Eigen::|0x[0-9a-f]{9,}"
    rb"|gnuplot>|line 0:|pure virtual|stack smashing|free\(\)|malloc|corrupted|out of memory")
GUARDED = re.compile(rb"crashes the library that reads it \([A-Za-z ]+\)")  # a guarded reader tells of a library, in words of its own
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")
EXCERPT = re.compile(r"^ *\d+ \| ")
POINTER = re.compile(r"^ +\| +\^$|^ +\| \^$")
PLACED = re.compile(r"^[^\n]*?:\d+(:\d+)?: ")
WARNING = re.compile(r"^(warning|note): |^  hint: ")
LEFTOVER = re.compile(r"(-wal|-shm|-journal|\.tmp|\.tmp\.\w+|~|\.part|\.partial)$")

# Refusals that are about no line of the input, which yet is a text: they are of the machine, of another file or directory, of the command line,
# or of what several values together make.
NOWHERE = re.compile(
    r"holds no run|is not a file|no such file|is a directory|cannot (read|write|make|open)|memory|disk|belongs to|made by another|"
    r"already|this file is in|another study|another fit|another scene|unknown option|has no frames|no checkpoint|"
    r"left out|the value of|argument \d+ of|is required|is given|has no value|word too many|words too many|takes a number|excludes|requires|"
    r"^--|: --|in doubles|particles: '|interrupted")


def refusal(text, placed, as_json):
    """Faults of the words of exit code 2."""
    if as_json:
        try:
            error = json.loads(text)["error"]
            text, where = str(error["message"]), error["line"] is not None
        except (ValueError, KeyError, TypeError):
            return [("shape", "--json, and standard error holds no error in JSON")]
        return [] if where or not placed or NOWHERE.search(text) else [("no place", text)]
    lines = text.rstrip("\n").split("\n")
    while lines and WARNING.match(lines[0]):
        lines.pop(0)
    if not lines or not lines[0].strip():
        return [("shape", "exit code 2 without an error")]
    message, rest = lines[0], lines[1:]
    if len(rest) >= 2 and EXCERPT.match(rest[0]) and POINTER.match(rest[1]):
        rest = rest[2:]
    if rest and rest[0].startswith("  hint: "):
        rest = rest[1:]
    if rest == ["Run with --help for more information."]:
        rest = []
    found = []
    if rest:
        found.append(("shape", "more than one error, or more than it takes: " + rest[0]))
    if placed and not PLACED.match(message) and not NOWHERE.search(message):
        found.append(("no place", message))
    return found


def words(text, limit):
    found = []
    if len(text) > limit:
        found.append(("enormous message", f"{len(text)} bytes"))
    foreign = FOREIGN.search(GUARDED.sub(b"", text))
    if foreign:
        line = text[text.rfind(b"\n", 0, foreign.start()) + 1:].split(b"\n", 1)[0]
        found.append(("foreign words", line[:300].decode("utf-8", "replace")))
    try:
        control = CONTROL.search(text.decode())
        if control:
            found.append(("control character", repr(control.group()) + " in " + repr(text.decode()[max(0, control.start() - 80):control.end()])))
    except UnicodeDecodeError as error:
        found.append(("control character", f"no UTF-8: {error}"))
    return found


def named(command):
    """Paths that a command line itself gives to be written: the words behind options, and of `new`."""
    words = [word for before, word in zip(command, command[1:]) if before.startswith("-") or before == "new"]
    words += [word.split("=", 1)[1] for word in command if word.startswith("--") and "=" in word]
    return tuple(os.path.normpath(word) for word in words if word and os.path.normpath(word) != ".")


def left(before, after, code, outputs):
    """`before`, `after`: all files of the working directory, by their paths. `outputs`: what their names may begin with."""
    found = []
    own = {name for name in before if not name.startswith("out")}
    for name in sorted(own | set(after)):
        if name.startswith(outputs):
            continue
        if name not in after:
            found.append(("foreign file", f"{name} is gone"))
        elif name not in before:
            found.append(("foreign file", f"{name} was left"))
        elif before[name] != after[name]:
            found.append(("foreign file", f"{name} was changed"))
    made = {name: data for name, data in after.items() if name.startswith("out")}
    if code == 2:
        old = {name: data for name, data in before.items() if name.startswith("out")}
        searched = "out/search.db" in made and not old  # it remembers what it measured before it met what it refuses
        changed = [] if searched else [name for name in sorted(set(made) | set(old)) if made.get(name) != old.get(name)]
        found += [("half written", f"{name} after exit code 2") for name in changed[:1]]
    for name, data in made.items():
        if LEFTOVER.search(name) and name not in before:
            found.append(("leftover", name))
        if name in before and before[name] == data:
            continue
        whole = {".json": b"{", ".png": b"\x89PNG", ".h5": b"\x89HDF", ".html": b"<", ".db": b"SQLite", ".svg": b"<"}
        for ending, head in whole.items():
            if name.endswith(ending) and code != 2 and not data.startswith(head):
                found.append(("half written", f"{name} begins with {data[:12]!r}"))
        if name.endswith(".json") and code != 2:
            try:
                json.loads(data)
            except ValueError as error:
                found.append(("half written", f"{name}: {error}"))
    return found


def began(case, ended, after, text):
    """Whether there was a run, a study or a synthesis that could fail."""
    if case.command[0] in ("check", "emit", "boards", "new", "report", "picture"):
        return False
    if case.command[0] == "elastic":  # the answer is that the matter is not stable
        return b"stable" in ended.out
    return any(name.startswith("out/") for name in after) or bool(re.search(r"\bstep \d|runs?\b|at a (?:pitch|strain) of|no pitch of at most|interrupted|failed|differ", text))


def judge(case, ended, before, after):
    if ended.stalled:
        return [("hang", "waits without end, and takes no processor time")]
    if ended.code in (-signal.SIGXCPU, -signal.SIGKILL):
        return [("hang", f"more than {CPU_SECONDS} s of processor time")]
    found = []
    if ended.code < 0:
        found.append(("crash", signal.Signals(-ended.code).name + ": " + ended.err[-300:].decode("utf-8", "replace")))
    elif ended.code not in (0, 1, 2):
        found.append(("wrong code", f"exit code {ended.code}"))
    text = ended.err.decode("utf-8", "replace")
    if ended.code == 1 and not began(case, ended, after, text):
        found.append(("wrong code", "exit code 1 where nothing ran: " + text[:300]))
    if ended.code in (1, 2) and not text.strip() and ended.code == 2:
        found.append(("shape", "exit code 2 without a word"))
    elif ended.code == 2:
        found += refusal(text, case.placed, "--json" in case.command)
    found += words(ended.err, LONGEST_REFUSAL if ended.code == 2 else LONGEST_WORDS)
    found += words(ended.out, LONGEST_WORDS)
    if ended.peak > LARGEST_PEAK:
        found.append(("memory", f"{ended.peak >> 20} MiB"))
    if ended.left_running:
        found.append(("process left", "a child outlived the program"))
    # cuboct-rtl keeps compiled nodes, as docs/reference/emulators.md says; synth its stages (docs/reference/synth.md).
    kept = ("home/.cache",) if case.program == "cuboct-rtl" or case.command[:1] == ["synth"] else ()
    return found + left(before, after, ended.code, ("out",) + kept + (named(case.command) if case.kind == "line" else ()))
