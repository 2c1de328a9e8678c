# SPDX-License-Identifier: MIT
"""What the program itself makes, for inputs of the kinds that read it: directories of runs and studies, a checkpoint, a project."""
import os
import resource
import shutil
import subprocess

import sound

# A library of cells by hand: what yosys needs of one, and areas.
LIBERTY = """library(small) {
  delay_model : table_lookup;
  time_unit : "1ns";
  voltage_unit : "1V";
  capacitive_load_unit (1,pf);
""" + "".join(f"""  cell({name}) {{
    area : {area};
    cell_leakage_power : 0.1;
{"".join(f"    pin({pin}) {{ direction : input; capacitance : 0.01; }}" + chr(10) for pin in pins)}    pin(Y) {{ direction : output; function : "{function}"; }}
  }}
""" for name, area, pins, function in (("BUF", 6, "A", "A"), ("NOT", 3, "A", "A'"), ("NAND", 4, "AB", "(A*B)'"), ("NOR", 4, "AB", "(A+B)'"))) + """  cell(DFF) {
    area : 18;
    ff(IQ, IQN) { clocked_on : C; next_state : D; }
    pin(C) { direction : input; clock : true; capacitance : 0.01; }
    pin(D) { direction : input; capacitance : 0.01; }
    pin(Q) { direction : output; function : "IQ"; }
  }
}
"""


# Where a study keeps what it measured.
KEPT = {"explore": "results.db", "search": "search.db", "machines": "machines.jsonl", "fit": "evaluations.jsonl", "potential_fit": "starts.jsonl",
        "multiscale": "progress", "learn": "samples.jsonl", "pitch": "runs.jsonl"}


class NoShop(Exception):
    pass


def files_of(directory):
    found = {}
    for root, _, files in os.walk(directory):
        for name in files:
            path = os.path.join(root, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, directory)] = file.read()
    return found


def write(directory, files):
    for path, data in files.items():
        place = f"{directory}/{path}"
        os.makedirs(os.path.dirname(place), exist_ok=True)
        with open(place, "wb") as file:
            file.write(data)


class Shop:
    def __init__(self, program, root, scratch):
        self.program, self.root, self.scratch = program, root, scratch

    def made(self, name, files, command, codes=(0,), files_at_most=None):
        """The directory `out` that a command left."""
        place = f"{self.scratch}/{name}"
        write(place, files)
        limit = None
        if files_at_most:
            limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (files_at_most, files_at_most))
        ended = subprocess.run([self.program, *command], cwd=place, stdin=subprocess.DEVNULL, capture_output=True, preexec_fn=limit)
        if ended.returncode not in codes:
            raise NoShop(f"{name}: exit code {ended.returncode}: {ended.stderr.decode('utf-8', 'replace').strip()}")
        found = files_of(f"{place}/out")
        shutil.rmtree(place)
        return found

    def text(self, path):
        with open(f"{self.root}/{path}", "rb") as file:
            return file.read()

    def study(self, name):
        files, command = sound.STUDIES[name]
        found = self.made(name, files, command, (0, 1))
        if KEPT[name] not in found:
            raise NoShop(f"{name}: no {KEPT[name]} among {', '.join(sorted(found)) or 'no files'}")
        return found

    def item(self, name):
        scene = {"in/scene.toml": sound.SMALL_SCENE}
        if name == "programs":
            beside = os.path.dirname(self.program)
            return [p for p in ("cuboct-lattice", "cuboct-systemc", "cuboct-rtl") if os.path.exists(f"{beside}/{p}")] or ["cuboct"]
        if name == "run":
            return self.made(name, scene, ["run", "in/scene.toml", "--quiet", "--out", "out"])
        if name == "cut":
            # The frames have no room, so the last checkpoint stays; the checkpoint itself has.
            held = self.made(name, {"in/scene.toml": self.text("scenes/lj_block.toml")}, sound.LONG_RUN + ["--frames", "xyz"], (2,), 690000)
            return {path: data for path, data in held.items() if not path.startswith("frames")}
        if name == "project":
            return self.made(name, {"in/scene.toml": self.text("tests/synth/lone.toml"), "in/arch.toml": self.text("tests/synth/narrow.toml")},
                             ["emit", "in/scene.toml", "--arch", "in/arch.toml", "--out", "out", "--vector-steps", "2"])
        if name == "liberty":
            return {"cells.lib": LIBERTY.encode()}
        return self.study(name)


# What each kind takes.
NEEDS = {"run_directory": ["run"], "checkpoint": ["cut"], "results": list(sound.STUDIES), "liberty": ["project", "liberty"], "project": ["project"],
         "line": ["run", "programs"]}
