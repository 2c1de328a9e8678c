# SPDX-License-Identifier: MIT
"""Energy of the nodes of a scene's machine by the activity of their gates, part by part, beside what the model tells."""
import re

import bench
import gates

# The model's terms, by the part of a node whose energy they are. Memories and wires are no gates.
TERMS = {"pairs: products": "pipes", "pairs: adders": "pipes", "pairs: registers": "pipes",
         "kicks: products": "pipes", "kicks: adders": "pipes", "kicks: registers": "pipes", "filter: adders": "filter",
         "filter: registers": "filter", "cull: adders": "cull", "cull: registers": "cull", "update: products": "update",
         "update: adders": "update", "update: registers": "update", "links: registers": "links",
         "clock: pairs": "clock", "clock: kicks": "clock", "clock: filter": "clock", "clock: cull": "clock", "clock: update": "clock", "clock: links": "clock",
         "clock: gates and control": "clock"}
LEFT_OUT = r"read |write |links: wires|wires within|leakage|memory of|links$"


def modelled(node):
    """{part: [low, high]} in pJ."""
    parts = {}
    for row in node["terms"]:
        if re.match(LEFT_OUT, row["term"]):
            continue
        part = parts.setdefault(TERMS[row["term"]], [0, 0])
        for end in (0, 1):
            part[end] += row["picojoules"][end]
    return parts


def sources(project):
    """What a node is made of, without the lattice around it."""
    files = [project / line for line in (project / "files.f").read_text().split()]
    around = ("lattice", "gather", "spread", "stage", "tree", "watch")
    return [file for file in files if file.stem.removeprefix("cuboct_") not in around]


def recorded(work, node):
    """Of a node the lines for the bench, and the first that counts: the one after the start."""
    pairs = [line.split() for line in (work / f"node_{node['node']}.hex").read_text().splitlines()]
    first = next(k for k, (inputs, _) in enumerate(pairs) if inputs[-2] == "1") + 1
    return [outputs + inputs for inputs, outputs in pairs], first


def compile_bench(work, netlist, nodes, delays=False):
    bits = lambda port: sum(re.fullmatch(rf"{port}(\[\d+\])?", name) is not None for name in netlist.ports)
    faces = bits("has_link_i")
    most = max(len(recorded(work, node)[0]) for node in nodes)
    text = bench.bench(netlist.ports, bits("load_data_i"), bits("link_data_i") // faces, faces, most)
    gates.compile_bench(netlist, text, work, delays)


def measured(work, node, netlist, energy):
    """{part: {"registers": pJ, "gates": pJ}} and "clock", "leakage" in pJ, over the node's cycles; changes of the nets."""
    lines, first = recorded(work, node)
    (work / "lines.hex").write_text("\n".join(lines) + "\n")
    cycles = node["cycles"]
    changes = gates.simulate(netlist, work, f"+lines={len(lines)}", f"+first={first}", f"+cycles={cycles}")
    found = {"clock": 0, "leakage": 0}
    for (path, kind, pins), dynamic, (_, clock, leakage) in zip(netlist.cells, gates.power(netlist, energy, changes), energy):
        found["clock"] += clock * netlist.clocks(kind, pins, cycles, changes)
        found["leakage"] += leakage * cycles
        if kind == gates.GATE:
            found["clock"] += dynamic
            continue
        part = found.setdefault(netlist.part(path), {"registers": 0, "gates": 0, "flops": 0, "cells": 0})
        part["registers" if kind in netlist.flops else "gates"] += dynamic
        part["flops"] += kind in netlist.flops
        part["cells"] += 1
    return found, changes
