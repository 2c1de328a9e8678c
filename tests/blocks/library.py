# SPDX-License-Identifier: MIT
"""What the modules' headers say. yosys reads the library and says which modules there are, with which ports and
parameters and on which line each port stands; that line of the source gives its width as an expression and its
comment, as yosys keeps neither."""
import dataclasses
import json
import pathlib
import re
import shutil
import subprocess
import tempfile


class InputError(Exception):
    """A page, a module or the command line is wrong."""


@dataclasses.dataclass
class Item:
    """A port or a parameter."""

    name: str
    kind: str     # in, out; a parameter's type; "derived" for a localparam of the header
    size: str     # of a port: bits; of a parameter: the value without another one
    comment: str  # of its line, "" if there is none
    group: str    # the comment on lines of its own before it and those after it, "" if there is none
    text: str     # its declaration, without comment and comma


@dataclasses.dataclass
class Module:
    name: str
    path: pathlib.Path
    about: str        # the comment before it
    parameters: list
    ports: list


def bits_of(range_text):
    """`[A-1:0]` is A bits, `[A:0]` A+1."""
    if not range_text:
        return "1"
    high = range_text[1:-1].rsplit(":", 1)[0].strip()
    if high.isdigit():
        return str(int(high) + 1)
    if high.endswith("-1"):
        return high[:-2]
    match = re.fullmatch(r"(.*)\+(\d+)", high)
    return f"{match[1]}+{int(match[2]) + 1}" if match else f"{high}+1"


WIDEST_INDENT = 8  # columns before the comment of a group; one farther right belongs to the declaration above


def header_items(lines):
    """The declarations between module and `);`: (line number, code, comment, group), a declaration per entry,
    numbers from 0."""
    items, group, joins = [], "", False
    code, comment, start = "", [], 0
    for number, line in enumerate(lines):
        text, _, remark = line.partition("//")
        text, remark = text.strip(), remark.strip()
        if not text and remark and not code and items and line.index("//") > WIDEST_INDENT:
            start_of, declared, words, group_of = items[-1]  # goes on with the words of the line before
            items[-1] = (start_of, declared, f"{words} {remark}", group_of)
        elif not text and remark and not code:
            group, joins = (f"{group} {remark}" if joins else remark), True
        elif text.startswith(("module ", ");")):
            continue
        elif text == ") (":
            group, joins = "", False
        elif text:
            joins = False
            start = start if code else number
            code = f"{code} {text}".strip()
            comment += [remark] if remark else []
            if text.endswith(",") or lines[number + 1].strip().startswith(")"):
                items.append((start, code.rstrip(","), " ".join(comment), group))
                code, comment = "", []
    return items


def read_module(name, facts, path, first):
    """A module whose keyword stands on line `first` (from 1), of which yosys tells `facts`."""
    lines = path.read_text().splitlines()
    end = next(i for i in range(first, len(lines)) if lines[i].startswith(");"))
    lead = first - 1
    while lead > 0 and re.match(r"//|\(\*", lines[lead - 1]) and "SPDX" not in lines[lead - 1]:
        lead -= 1
    about = [line[2:].strip() if not line.startswith("//   ") else line[2:]
             for line in lines[lead:first - 1] if line.startswith("//")]
    module = Module(name, path, "\n".join(about), [], [])
    places = {}
    for port, fact in facts["ports"].items():
        source = facts["netnames"][port]["attributes"]["src"]
        places[int(source.rsplit(":", 1)[1].split(".")[0])] = (port, fact["direction"])
    told = set(facts.get("parameter_default_values", {}))
    for number, code, comment, group in header_items(lines[first - 1:end + 1]):
        words = code.split()
        if words[0] in ("parameter", "localparam"):
            left, _, value = code.partition("=")
            item = left.split()[-1]
            kind = "derived" if words[0] == "localparam" else " ".join(left.split()[1:-1])
            module.parameters.append(Item(item, kind, " ".join(value.split()), comment, group, code))
            told.discard(item)
        else:
            port, direction = places.pop(first + number)
            wide = re.sub(r"^(input|output)\s+logic\s*", "", code[:code.rindex(port)]).strip()
            signed = "signed" in wide.split()
            size = bits_of(wide.replace("signed", "").strip()) + (", signed" if signed else "")
            module.ports.append(Item(port, "in" if direction == "input" else "out", size, comment, group,
                                     re.sub(r"^(input|output)\s+", "", code)))
    if places or told:
        odd = sorted(told | {port for port, _ in places.values()})[0]
        raise InputError(f"{path}: {name}: '{odd}' does not stand on a line of its own in the module's header")
    return module


def read_library(files):
    """The modules of the files, by name, as yosys sees them."""
    if not shutil.which("yosys"):
        raise InputError("yosys was not found: install the Debian package yosys")
    with tempfile.TemporaryDirectory() as work:
        out = pathlib.Path(work) / "library.json"
        names = " ".join(str(file) for file in files)
        script = f"read_verilog -sv {names}; delete */p:*; write_json {out}"
        run = subprocess.run(["yosys", "-q", "-p", script], capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise InputError(f"yosys cannot read the library:\n{run.stdout}{run.stderr}")
        found = json.loads(out.read_text())["modules"]
    modules = {}
    for name, facts in found.items():
        path, _, place = facts["attributes"]["src"].rpartition(":")
        modules[name] = read_module(name, facts, pathlib.Path(path), int(place.split(".")[0]))
    return modules
