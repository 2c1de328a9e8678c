#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Each call of a run fails once, in turn: the run ends with one clear error or goes on, what was written before is whole,
nothing is left behind. usage: sweep.py BIN FAIL_CALL.so [--engines E,...] [--calls C,...] [--most N] [--grow SHARE]

A run is new, or goes on from a checkpoint. The n-th call fails for n = 1, 2, 3, ... until the run makes fewer; beyond
--most the step grows by SHARE of n. Where the engine is a program of its own, or ranks, its calls fail too. Behind a call,
":kill": the engine's program is killed there instead. The wall clock ("clock") jumps from the first reading on, which may change nothing.
At the n-th reading of the host the board is gone ("unplug"); another one stands there when the run is tried again. --gpu has the
engine on the host, --mpi FAIL_MPI.so, --board cuboct-board-sim."""
import argparse
import bisect
import collections
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SCENE, ARCH = ROOT / "tests" / "samples" / "scene.toml", ROOT / "scenes" / "archs" / "icebreaker.toml"
CALLS = "open write rename sync truncate mmap fork thread memory directory read clock".split()
# Others run in the command's own process.
PROGRAMS = {"systemc": "cuboct-systemc", "rtl": "cuboct-rtl", "fpga": "cuboct-fpga", "gpu": "cuboct-gpu",
            "ranks": "cuboct-lattice"}
WORDS = {"ranks": ["--engine", "lattice", "--ranks", "2"]}
RUN = ["run", "scene.toml", "--steps", "24", "--frame-every", "6", "--frames", "xyz", "--quiet", "--out", "out"]
CHECKPOINTS = ["--checkpoint-every", "6 steps"]
WITHOUT = {"systemc", "rtl"}  # engines that leave no checkpoints
SECONDS = 60
LEFT = re.compile(r"\.tmp|\.part|~$|\.lock$")  # of a directory that no run is at work in
KEPT = {"out/trace.part.h5": "trace.h5", "out/rasters.part.h5": "rasters.h5"}  # frames so far, where the file itself could not be made


class Functions:
    """Of a program, by the place of a call."""

    def __init__(self, program):
        lines = subprocess.run(["nm", "-n", "--defined-only", program], capture_output=True, text=True).stdout.splitlines()
        rows = [line.split() for line in lines if len(line.split()) == 3]
        self.places, self.names = [int(row[0], 16) for row in rows], [row[2] for row in rows]

    def at(self, place):
        return self.names[bisect.bisect_right(self.places, place) - 1] if place and self.places else ""


class Runs:
    def __init__(self, given):
        self.bin, self.library, self.given = given.bin, given.library, given
        self.folder = Path(tempfile.mkdtemp(prefix="cuboct-faults-"))
        shutil.copy(SCENE, self.folder / "scene.toml")
        (self.folder / "tmp").mkdir()
        if given.gpu:  # the engine stands beside the command
            (self.folder / "bin").mkdir()
            for program, path in ("cuboct", self.bin / "cuboct"), ("cuboct-read-trace", self.bin / "cuboct-read-trace"), ("cuboct-gpu", given.gpu):
                shutil.copy(path, self.folder / "bin" / program)
            self.bin = self.folder / "bin"
        self.board = None
        self.out, self.mark = self.folder / "out", self.folder / "mark"

    def run(self, words, **fault):
        environment = {**os.environ, "TMPDIR": str(self.folder / "tmp"), "XDG_CACHE_HOME": str(self.folder / "cache"), "LC_ALL": "C"}
        if fault:
            libraries = [self.library] + ([self.given.mpi] if self.given.mpi and fault["call"] == "mpi" else [])
            environment |= {"LD_PRELOAD": ":".join(map(str, libraries)), "CUBOCT_FAIL_MARK": str(self.mark)}
            environment |= {f"CUBOCT_FAIL_{key.upper()}": str(value) for key, value in fault.items()}
        self.mark.unlink(missing_ok=True)
        return subprocess.run([self.bin / "cuboct", *words], cwd=self.folder, env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                              timeout=SECONDS)

    def clock_jumps(self):
        """The library does what it is there for."""
        environment = {**os.environ, "LD_PRELOAD": str(self.library), "CUBOCT_FAIL_CALL": "clock", "CUBOCT_FAIL_AT": "1"}
        told = int(subprocess.run(["date", "+%s"], env=environment, capture_output=True, check=True).stdout)
        return told - time.time() > 80000

    def start_board(self):
        """A board of this scene's machine, Verilated, at this run's port."""
        project, port, cache = self.folder / "project", self.folder / "port", {"XDG_CACHE_HOME": str(self.given.cache)} if self.given.cache else {}
        if not project.exists():
            emit = ["emit", "scene.toml", "--arch", ARCH, "--board", "icebreaker", "--baud", "3000000", "--unchecked", "--out", project]
            done = subprocess.run([self.bin / "cuboct", *emit], cwd=self.folder, capture_output=True)
            if done.returncode != 0:
                raise SystemExit(done.stderr.decode())
        self.board = subprocess.Popen([self.given.board, project], stdout=open(port, "wb"), env={**os.environ, **cache})
        while not port.read_bytes().endswith(b"\n"):
            if self.board.poll() is not None:
                raise SystemExit("cuboct-board-sim ended")
            time.sleep(0.05)
        device = self.folder / "board"
        device.unlink(missing_ok=True)
        device.symlink_to(port.read_text().strip())

    def end(self):
        if self.board:
            self.board.kill()
        shutil.rmtree(self.folder)

    def clear(self):
        shutil.rmtree(self.out, ignore_errors=True)
        for left in (self.folder / "tmp").iterdir():
            shutil.rmtree(left) if left.is_dir() else left.unlink()

    def result(self):
        """What a whole run left: the hash of its last state, and its frames."""
        summary = json.loads((self.out / "summary.json").read_text())
        return summary.get("state_hash"), summary["steps"], (self.out / "frames.xyz").read_bytes()

    def left(self):
        names = [str(p.relative_to(self.folder)) for place in ("out", "tmp") for p in (self.folder / place).rglob("*")]
        return [n for n in names if (LEFT.search(n) or n.startswith("tmp/")) and not (n in KEPT and not (self.out / KEPT[n]).exists())]


class Sweep:
    def __init__(self, runs, engine):
        self.runs, self.engine = runs, engine
        self.words = RUN + WORDS.get(engine, ["--engine", engine]) + ([] if engine in WITHOUT else CHECKPOINTS)
        if engine == "fpga":
            runs.start_board()
            self.words += ["--arch", str(ARCH), "--baud", "3000000", "--port", str(runs.folder / "board")]
        self.wrong, self.ends, self.said, self.functions = [], collections.Counter(), {}, {}
        runs.clear()
        whole = runs.run(self.words)
        if whole.returncode != 0:
            raise SystemExit(f"{engine}: {whole.stderr.decode()}")
        self.reference = runs.result()
        self.cut = self.cut_at_checkpoint()

    def cut_at_checkpoint(self):
        """A directory whose run was killed with its second checkpoint; None where the engine leaves none."""
        cut = self.runs.folder / f"cut-{self.engine}"
        for at in range(1, 0 if self.engine in WITHOUT else 20):
            self.runs.clear()
            self.runs.run(self.words, call="rename", at=at, kills="")
            if not (self.runs.out / "checkpoint").exists():
                continue
            time.sleep(0.5 if self.engine in PROGRAMS else 0)  # its program ends, too
            shutil.copytree(self.runs.out, cut)
            return cut
        return None

    def judge(self, case, done, before, crashed):
        runs, code, said = self.runs, done.returncode, done.stderr.decode(errors="replace")
        self.ends[code] += 1
        self.said.setdefault((case[1], code, re.sub(r"\d+", "N", said)[:200]), case)
        found = []
        if crashed:
            pass
        elif case[1] == "clock" and code != 0:
            found.append(f"ends with {code} as the clock jumps: {said[-300:]!r}")
        elif code not in (0, 1, 2):
            found.append(f"ends with {code}: {said[-300:]!r}")
        elif code != 0 and (not said.strip() or "terminate" in said or said.count("\n") > 6):
            found.append(f"ends with {code} and says {said[:600]!r}")
        elif code != 0 and case[1] == "write" and "is damaged" in said:
            found.append(f"takes what could not be written for damaged: {said[:600]!r}")
        elif code != 0 and case[1] == "mpi" and case[2] not in said:
            found.append(f"does not name the call that failed: {said[:600]!r}")
        if (left := set(runs.left()) - before) and not crashed and case[2] not in ("unlink", "remove"):
            found.append(f"leaves {', '.join(sorted(left))}")
        if code == 0:
            try:
                if runs.result() != self.reference:
                    found.append(f"ends with 0 and another result, and says {said[:300]!r}")
            except (OSError, ValueError) as error:
                found.append(f"ends with 0 without a result ({error}), and says {said[:300]!r}")
        else:
            # Whoever tries again: from the checkpoint where there is one, else anew.
            goes_on = ["--resume"] if (runs.out / "checkpoint").exists() else ["--force"]
            if case[0] == "resumed" and goes_on != ["--resume"] and not (runs.out / "summary.json").exists():
                found.append("loses the checkpoint")
            again = runs.run(self.words + goes_on)
            if again.returncode != 0:
                found.append(f"cannot be run again with {goes_on[0]}: {again.stderr.decode()[:300]!r}")
            elif runs.result() != self.reference:
                found.append(f"run again with {goes_on[0]} has another result")
        self.wrong += [f"{self.engine} {' '.join(map(str, case))}: {f}" for f in found]

    def is_hdf5(self, program, place):
        if program not in self.functions:
            self.functions[program] = Functions(self.runs.bin / program)
        return self.functions[program].at(place).startswith("H5")

    def one(self, start, call, program, at, rank=None):
        """False where the run made fewer such calls."""
        runs = self.runs
        runs.clear()
        if start == "resumed":
            shutil.copytree(self.cut, runs.out)
        before = set(runs.left())
        fault = {"call": "read" if call == "unplug" else call.removesuffix(":kill"), "at": at, "in": program}
        if call.endswith(":kill"):
            fault["kills"] = ""
        elif call == "unplug":
            fault["kills"] = runs.board.pid
        if rank is not None:
            fault["rank"] = rank
        try:
            done = runs.run(self.words + (["--resume"] if start == "resumed" else []), **fault)
        except subprocess.TimeoutExpired:
            done = None
        if call == "unplug" and runs.mark.exists():
            runs.board.wait()
            runs.start_board()
        if done is None:
            self.wrong.append(f"{self.engine} {start} {call} {program} {rank or ''} {at}: does not end")
            return True
        if not runs.mark.exists() and call != "clock":
            return False
        function, place = runs.mark.read_text().split() if runs.mark.exists() else ("none", "0")
        # Some allocations of HDF5's that fail crash it, or it ends the program: as after a kill the next run must go on.
        crashed = call == "memory" and done.returncode in (-signal.SIGSEGV, 255) and self.is_hdf5(program, int(place, 16))
        self.judge((start, call, function, program, at) + ((f"rank {rank}",) if rank is not None else ()), done, before, crashed)
        return call != "clock"

    def all(self, calls, most, grow):
        for start in ["new"] + (["resumed"] if self.cut else []):
            for call in calls:
                for program, rank in self.places(call):
                    at = 1
                    while self.one(start, call, program, at, rank):
                        at += 1 if at < most else max(1, int(grow * at))
        return self

    def places(self, call):
        """Where it fails: the command, and the engine's program or each of two ranks."""
        program = PROGRAMS.get(self.engine)
        here = [] if call in ("mpi", "device", "unplug") or call.endswith(":kill") else [("cuboct", None)]
        return here + ([] if program is None else [(program, rank) for rank in ((0, 1) if self.engine == "ranks" else (None,))])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin", type=lambda p: Path(p).resolve())
    parser.add_argument("library", type=lambda p: Path(p).resolve())
    parser.add_argument("--engines", default="golden,reference,lattice")
    parser.add_argument("--calls", default=",".join(CALLS))
    parser.add_argument("--most", type=int, default=200)
    parser.add_argument("--grow", type=float, default=0.1)
    parser.add_argument("--gpu", type=lambda p: Path(p).resolve())
    parser.add_argument("--mpi", type=lambda p: Path(p).resolve())
    parser.add_argument("--board", type=lambda p: Path(p).resolve())
    parser.add_argument("--cache", type=lambda p: Path(p).resolve(), help="of the board, compiled")
    parser.add_argument("--tell", action="store_true", help="each kind of end")
    given = parser.parse_args()
    runs = Runs(given)
    if "clock" in given.calls.split(",") and not runs.clock_jumps():
        raise SystemExit("the wall clock does not jump")
    wrong, total = [], 0
    for engine in given.engines.split(","):
        sweep = Sweep(runs, engine).all(given.calls.split(","), given.most, given.grow)
        wrong += sweep.wrong
        total += sum(sweep.ends.values())
        print(f"{engine}: {sum(sweep.ends.values())} calls failed, exit codes {dict(sorted(sweep.ends.items()))}, {len(sweep.wrong)} wrong", flush=True)
        if given.tell:
            for (call, code, said), case in sorted(sweep.said.items(), key=str):
                print(f"  {code} {' '.join(map(str, case))}: {said!r}")
    print("\n".join(wrong))
    runs.end()
    sys.exit(bool(wrong) or total == 0)


main()
