# SPDX-License-Identifier: MIT
"""What the studies of this folder share: cases that are run once, progress, tables and pictures.

A case is a scene that `cuboct run` runs into a directory of its own. A study that was cut goes on where it was: finished cases stay, as long
as their scene and their options are the same; one that was cut begins at its checkpoint, where its engine leaves one."""
from __future__ import annotations

import argparse
import json
import os
import pathlib
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from typing import Any

import h5py
import numpy as np

import cuboct

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


class Case:
    """A run that is finished; `stages` are those of a scene that has some."""

    def __init__(self, directory: pathlib.Path):
        self.directory = directory
        self.summary = json.loads((directory / "summary.json").read_text())
        runs = sorted((p.parent for p in directory.glob("*/run.toml")), key=lambda p: int(p.name.split("-")[0]))
        self.stages = [Case(run) for run in runs]

    def value(self, name: str) -> Any:
        """Of a line of the summary."""
        return self.summary[name]["value"]

    def curve(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Times in s, values in SI."""
        with h5py.File(self.directory / "trace.h5") as trace:
            curve = trace["curves"][name]
            return curve["step"][:] * trace.attrs["dt"], curve["value"][:]

    def frames(self) -> Iterator[tuple[float, np.ndarray, np.ndarray]]:
        """Time in s, ids, positions in m of each state that was kept, of engines of the fixed rule and of real numbers."""
        with h5py.File(self.directory / "trace.h5") as trace:
            head = trace.attrs
            if "bodies" in trace:
                x = trace["bodies/x"][:].reshape(len(trace["bodies/step"]), -1, 3)
                for step, positions in zip(trace["bodies/step"], x):
                    yield step * head["dt"], np.arange(len(positions)), positions
                return
            frames, first = trace["frames"], trace["frames/first"]
            edge = head["cell_edge"] * head.get("cell_shape", 1)
            unit = edge / 2.0 ** (head["position_frac"] + head["guard"])
            corner = head["origin"] + trace["lattice/cell"][:] * edge
            for k, step in enumerate(frames["step"]):
                rows = slice(first[k], first[k + 1])
                yield step * head["dt"], frames["id"][rows], corner[frames["node"][rows]] + frames["x"][rows] * unit

    @property
    def particle_steps(self) -> float:
        return self.value("particles") * self.value("steps")


class Study:
    """One study: its command line, its directory, its cases."""

    def __init__(self, name: str, about: str):
        parser = argparse.ArgumentParser(prog=f"tools/study {name}", description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(f"{name}.study"), help="directory of results (%(default)s)")
        parser.add_argument("--small", action="store_true", help="the small version: seconds instead of minutes, coarser figures")
        parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="cases run at once (%(default)s)")
        parser.add_argument("--docs", action="store_true", help="also write the tables and pictures of docs/measured anew")
        parser.add_argument("--cuboct", type=pathlib.Path, default=ROOT / "build/cuboct", help="the command (%(default)s)")
        arguments = parser.parse_args()
        if arguments.jobs < 1:
            parser.error(f"argument --jobs: {arguments.jobs} is not at least 1")
        if arguments.docs and arguments.small:
            parser.error("argument --docs: the pages hold figures of the whole study: leave out --small")
        self.name, self.small, self.docs = name, arguments.small, arguments.docs
        self.out, self.jobs, self.command = arguments.out, arguments.jobs, arguments.cuboct
        self.began = time.monotonic()
        self.out.mkdir(parents=True, exist_ok=True)

    # ---- cases

    def run(self, scenes: Mapping[str, Mapping[str, Any]], *options: str) -> dict[str, Case]:
        """Runs what is not finished yet. `options` are those of `cuboct run`."""
        return dict(zip(scenes, self._all({name: (lambda n=name: self._run(n, scenes[n], options)) for name in scenes})))

    def elastic(self, scenes: Mapping[str, Mapping[str, Any]], *options: str) -> dict[str, dict[str, Any]]:
        """What `cuboct elastic --json` says of each."""
        return dict(zip(scenes, self._all({name: (lambda n=name: self._elastic(n, scenes[n], options)) for name in scenes})))

    def _all(self, work: Mapping[str, Any]) -> list[Any]:
        """The results in order, from as many threads as there are jobs; tells how far it is."""
        found: dict[str, Any] = {}
        begin = time.monotonic()
        with ThreadPoolExecutor(self.jobs) as pool:
            futures = {pool.submit(task): name for name, task in work.items()}
            try:
                for done in as_completed(futures):
                    found[futures[done]] = done.result()
                    spent = time.monotonic() - begin
                    left = spent / len(found) * (len(work) - len(found))
                    print(f"{self.name}: {len(found)} of {len(work)} cases, {futures[done]}; {spent:.0f} s, about {left:.0f} s left", file=sys.stderr)
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise
        return [found[name] for name in work]

    def _command(self, *arguments: object) -> str:
        process = subprocess.run([str(self.command), *map(str, arguments)], capture_output=True, text=True)
        if process.returncode < 0 or process.returncode == 130:
            raise KeyboardInterrupt
        if process.returncode:
            raise SystemExit(f"{self.name}: {process.stderr.strip() or process.stdout.strip()[-2000:]}")
        return process.stdout

    def _file(self, name: str, scene: Mapping[str, Any], options: Sequence[str]) -> tuple[pathlib.Path, bool, bool]:
        """The file of the scene; whether it was there as it is; whether the case is finished."""
        path = self.out / "cases" / f"{name.replace('/', ' per ')}.toml"
        path.parent.mkdir(parents=True, exist_ok=True)
        text = f"# options: {' '.join(options)}\n{cuboct.Scene(scene).toml()}"
        same = path.exists() and path.read_text() == text
        done = path.with_suffix(".done")
        if not same:
            done.unlink(missing_ok=True)
            path.write_text(text)
        return path, same, done.exists()

    def _run(self, name: str, scene: Mapping[str, Any], options: Sequence[str]) -> Case:
        path, same, done = self._file(name, scene, options)
        directory = path.with_suffix("")
        if not done:
            threads = [] if "--threads" in options else ["--threads", max(1, (os.cpu_count() or 1) // self.jobs)]
            part = same and ("stage" in scene and directory.exists() or (directory / "checkpoint").exists())
            self._command("run", path, "--out", directory, "--quiet", "--json", "--frames", "none", *threads, "--checkpoint-every", "1 min", "--resume" if part else "--force", *options)
            path.with_suffix(".done").touch()
        return Case(directory)

    def _elastic(self, name: str, scene: Mapping[str, Any], options: Sequence[str]) -> dict[str, Any]:
        path, _, done = self._file(name, scene, ["elastic", *options])
        answer = path.with_suffix(".json")
        if not done:
            answer.write_text(self._command("elastic", path, "--json", *options))
            path.with_suffix(".done").touch()
        return json.loads(answer.read_text())

    # ---- results

    def table(self, name: str, head: Sequence[str], rows: Sequence[Sequence[str]], machine: str = "any machine: exact") -> None:
        """Prints a table, and keeps it as NAME.tsv with where it comes from: docs/tables prints it on its page."""
        commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip() or "unknown"
        lines = [f"# commit: {commit}", f"# machine: {machine}", f"# command: tools/study {self.name}", *("\t".join(row) for row in (head, *rows))]
        for folder in self._folders("measured/data"):
            (folder / f"{name}.tsv").write_text("\n".join(lines) + "\n")
        widths = [max(len(row[k]) for row in (head, *rows)) for k in range(len(head))]
        for row in (head, *rows):
            print("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip())
        print()

    @contextmanager
    def figure(self, name: str, columns: int = 1, size: tuple[float, float] = (6.4, 4.2), kind: str = "svg") -> Iterator[Any]:
        """Axes of matplotlib, which become NAME.svg, or for many points NAME.png."""
        import matplotlib

        matplotlib.use("svg" if kind == "svg" else "agg")
        matplotlib.rcParams.update({"svg.hashsalt": "cuboct", "font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "axes.axisbelow": True})
        from matplotlib import pyplot

        figure, axes = pyplot.subplots(1, columns, figsize=size, layout="constrained")
        yield axes
        for folder in self._folders("images"):
            figure.savefig(folder / f"{name}.{kind}", dpi=150, metadata={"Date": None} if kind == "svg" else {"Software": None})
        pyplot.close(figure)

    def _folders(self, place: str) -> list[pathlib.Path]:
        return [self.out, *([ROOT / "docs" / place] if self.docs else [])]

    def end(self) -> None:
        print(f"{time.monotonic() - self.began:.0f} s, of which finished cases took none; tables and pictures: {self.out}")


def check(name: str, value: float, reference: float, tolerance: float) -> None:
    """Ends the study with exit code 1 where a figure is further from its reference than the tolerance, relatively."""
    error = value / reference - 1
    if not abs(error) <= tolerance:
        raise SystemExit(f"{name}: {value:.6g} differs from {reference:.6g} by {100 * error:+.2f} %, more than {100 * tolerance:.3g} %")


def main(study: Any) -> None:
    """Runs the study's function; Ctrl-C ends it with exit code 130, what is finished stays."""
    try:
        study()
    except KeyboardInterrupt:
        print("interrupted: the same command goes on with what is left", file=sys.stderr)
        sys.exit(130)
    except cuboct.InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
