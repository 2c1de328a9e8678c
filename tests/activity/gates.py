# SPDX-License-Identifier: MIT
"""A module of emitted RTL as gates of a liberty file, repeated in a bench with what it got in its machine, and the energy
that its nets' changes take. Memories stay what they are, words that are read and written: no gates, no energy here."""
import collections
import json
import os
import pathlib
import re
import subprocess

LIBRARY = pathlib.Path("/usr/share/qflow/tech/osu018/osu018_stdcells.lib")
TOOLS = ("yosys", "iverilog", "vvp", "sta", "mawk")
LONGEST = 900  # s, of a run of a tool
PERIOD = 100  # ns; what a clock takes does not depend on it
# Registers of so many bits and more with one enable have a gate before their clock: a latch, which is open while the clock is low,
# and an AND. Of fewer a multiplexer holds the value.
FEWEST = 3
GATE = "CUBOCT_GATE"
GATE_CELLS = (("INVX1", "A({CLK}), .Y({n}i)"), ("LATCH", "CLK({n}i), .D({EN}), .Q({n}q)"), ("AND2X2", "A({CLK}), .B({n}q), .Y({GCLK})"))
GATE_MODEL = f"module {GATE}(input CLK, EN, output GCLK); reg q = 0; always @* if (!CLK) q = EN; assign GCLK = CLK & q; endmodule\n"
GATE_MAP = f"""(* techmap_celltype = "$dffe" *)
module gated(CLK, EN, D, Q);
  parameter WIDTH = 1;
  parameter CLK_POLARITY = 1;
  parameter EN_POLARITY = 1;
  input CLK, EN;
  input [WIDTH-1:0] D;
  output [WIDTH-1:0] Q;
  wire gclk;
  wire _TECHMAP_FAIL_ = WIDTH < {FEWEST};
  {GATE} gate (.CLK(CLK), .EN(EN_POLARITY ? EN : ~EN), .GCLK(gclk));
  \\$dff #(.WIDTH(WIDTH), .CLK_POLARITY(1'b1)) register (.CLK(gclk), .D(D), .Q(Q));
endmodule
"""

# Parts of a node by the instance that holds a cell; what is in none is control.
PARTS = (("pipes", r"\.u_pipe\.|\.u_sums\.|\.gen_total"), ("filter", r"\.u_filter\."), ("cull", r"\.u_cull"),
         ("update", r"\.u_update\."), ("links", r"\.u_tx\."))
# Modules that keep their borders while gates are made, so that each gate belongs to one part.
KEPT = ("cuboct_pipe", "cuboct_filter", "cuboct_update", "cuboct_sums", "cuboct_cull", "cuboct_link_tx")


class Mistake(Exception):
    pass


def run(command, **more):
    done = subprocess.run(command, capture_output=True, text=True, **more)
    if done.returncode != 0:
        raise Mistake(f"{' '.join(map(str, command))}: exit status {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def functions(library):
    """{cell: {output pin: (Verilog expression, inputs)}}, and the cells that are flip-flops: {cell: (clock, data, output)}."""
    gates, flops = {}, {}
    for cell in re.split(r"\ncell \(", library.read_text())[1:]:
        name = cell[:cell.index(")")]
        pins = re.split(r"\n  pin\((\w+)\)", cell)
        inputs = [pin for pin, text in zip(pins[1::2], pins[2::2]) if "direction : input" in text]
        flop = re.search(r'\n  ff \((\w+),.*?next_state : "(\w+)".*?clocked_on : "(\w+)"', cell, re.S)
        outputs = {pin: found[1] for pin, text in zip(pins[1::2], pins[2::2])
                   if (found := re.search(r'function : "(.*?)"', text))}
        if flop and len(outputs) == 1 and not re.search("clear|preset", cell):
            flops[name] = (flop[3], flop[2], *outputs)
        elif not flop and outputs and "latch" not in cell:
            verilog = lambda f: re.sub(r"(?<=[\w)]) +(?=[\w(!])", "&", f).replace("!", "~").replace("+", "|")
            gates[name] = {pin: (verilog(function), inputs) for pin, function in outputs.items()}
    return gates, flops


def cell_delays(library):
    """{cell: ns} of the library's Verilog models: the mean of a cell's paths."""
    delays = {}
    for module in re.findall(r"^module .*?^endmodule", library.with_suffix(".v").read_text(), re.S | re.M):
        paths = [float(x) for x in re.findall(r"tp\w*\$\S+ = [\d.]+:([\d.]+):", module)]
        if paths:
            delays[re.match(r"module (\w+)", module)[1]] = sum(paths) / len(paths)
    return delays


def cell_models(gates, flops, delays):
    """Verilog of the cells: flip-flops begin at 0; values settle in no time, or as late as `delays` says of a cell."""
    text = ["`timescale 1ns/10ps\n", GATE_MODEL]
    late = lambda name: f"#{delays[name]:.2f} " if name in delays else ""
    for name, outputs in gates.items():
        inputs = next(iter(outputs.values()))[1]
        assigns = " ".join(f"assign {late(name)}{pin} = {function};" for pin, (function, _) in outputs.items())
        text.append(f"module {name}(input {', '.join(inputs)}, output {', '.join(outputs)}); {assigns} endmodule\n")
    for name, (clock, data, output) in flops.items():
        text.append(f"module {name}(input {clock}, {data}, output reg {output}); initial {output} = 0; "
                    f"always @(posedge {clock}) {output} <= {late(name)}{data}; endmodule\n")
    return "".join(text)


def synthesise(sources, top, out, library=LIBRARY):
    """out/gates.json, out/gates.v: `top` in cells of the library, flat; memories stay."""
    (out / "abc.constr").write_text("set_driving_cell BUFX4\nset_load 0.05 [all_outputs]\n")
    kept = " ".join(f"*{name}*" for name in KEPT)
    merge = f"opt_merge -share_all t:{GATE}\n"
    (out / "gate_map.v").write_text(GATE_MAP)
    (out / "gate.v").write_text(f"module {GATE}(input CLK, EN, output GCLK); endmodule\n")
    script = f"read_verilog -lib {out}/gate.v\n" + "".join(f"read_verilog -sv {source}\n" for source in sources)
    # What `synth` does, less memory_map.
    script += (f"hierarchy -check -top {top}\nsetattr -mod -set keep_hierarchy 1 {kept}\nproc\nflatten\nopt_expr\nopt_clean\n"
               "opt -nodffe -nosdff\nwreduce\npeepopt\nopt_clean\nalumacc\nshare\nopt -nosdff\nmemory -nomap\nopt_clean\n"
               f"opt -fast -full -nosdff\nopt -undriven -fine -nosdff\ntechmap -map {out}/gate_map.v t:$dffe\n{merge}"
               "techmap\nopt -fast -nodffe -nosdff\nopt_clean\n"
               f"dfflibmap -liberty {library}\nabc -liberty {library} -constr {out}/abc.constr -D 5000\n"
               f"setattr -mod -unset keep_hierarchy *\nflatten\n{merge}splitnets -ports\nopt_clean -purge\nrename -enumerate w:*\n"
               f"write_json {out}/gates.json\nwrite_verilog -noattr {out}/gates.v\n")
    (out / "gates.ys").write_text(script)
    run(["yosys", "-q", "-l", out / "gates.log", "-s", out / "gates.ys"])


class Netlist:
    """Cells and nets of out/gates.json. A net is a number."""

    def __init__(self, out, top, library=LIBRARY):
        module = json.loads((out / "gates.json").read_text())["modules"][top]
        self.gates, self.flops = functions(library)
        self.cells = []  # (path, type, {pin: net})
        for path, cell in module["cells"].items():
            if cell["type"] == "$mem_v2":
                continue
            if cell["type"] in self.gates or cell["type"] in self.flops or cell["type"] == GATE:
                self.cells.append((path, cell["type"], {pin: bits[0] for pin, bits in cell["connections"].items()}))
            else:
                raise Mistake(f"{out}/gates.json: a cell {cell['type']} at {path}, of which the library says nothing")
        self.names = {name: net["bits"][0] for name, net in module["netnames"].items()}
        self.ports = {name: (port["direction"], port["bits"][0]) for name, port in module["ports"].items()}

    def outputs(self, kind):
        return ["GCLK"] if kind == GATE else [self.flops[kind][2]] if kind in self.flops else list(self.gates[kind])

    def clocks(self, kind, pins, cycles, changes):
        """So often a cell's clock rises."""
        net = pins[self.flops[kind][0]] if kind in self.flops else None
        return cycles if net in (None, self.ports["clk_i"][1]) else changes.get(net, 0) / 2

    def part(self, path):
        return next((part for part, pattern in PARTS if re.search(pattern, "." + path.replace("\\", ""))), "control")


def compile_bench(netlist, bench, out, delays=False, library=LIBRARY):
    """out/bench.vvp: out/gates.v in the bench. `delays`: those of the library's own models of its gates."""
    text = (out / "gates.v").read_text()
    # A word that is read as it is written is no one's; it stays what it was.
    text = re.sub(r"\n +if \([^\n]*\)\n +_\d+_ <= \d+'hx+;", "", text)
    text = re.sub(r"(\n  reg (\[\d+:0\] )?(_\d+_|\\\S+ )( \[(\d+):0\])?;)(?=\n  (?:always|reg))", initial, text)
    (out / "simulated.v").write_text(text)
    cells = cell_models(netlist.gates, netlist.flops, cell_delays(library) if delays else {})
    (out / "cells.v").write_text(cells)
    (out / "bench.v").write_text(bench)
    run(["iverilog", "-g2012", "-o", out / "bench.vvp", "-s", "bench", out / "bench.v",
         out / "simulated.v", out / "cells.v"])


def random_bench(netlist, top, operands, cycles):
    """A bench that gives `operands`, {port: bits}, new random values of at most 64 bits at each clock."""
    def wire(name):
        port, _, index = name.partition("[")
        return "clk" if port == "clk_i" else f"{port}[{index.rstrip(']') or 0}]" if port in operands else ""
    connections = ", ".join(f".\\{name} ({wire(name)})" for name in netlist.ports)
    declared = "\n".join(f"  reg [{bits - 1}:0] {port} = 0;" for port, bits in operands.items())
    drawn = " ".join(f"{port} = {{$urandom, $urandom}};" for port in operands)
    return f"""`timescale 1ns/10ps
module bench;
  reg clk = 0;
  integer t;
{declared}
  {top} dut ({connections});
  initial begin
    $dumpfile("changes.vcd");
    $dumpvars(1, dut);
    $dumpoff;
    for (t = -4; t < {cycles}; t = t + 1) begin
      if (t == 0) $dumpon;
      #50 clk = 1; {drawn}
      #50 clk = 0;
    end
    $dumpoff;
    $display("PASS {cycles} cycles");
    $finish;
  end
endmodule
"""


def simulate(netlist, out, *plusargs):
    """Runs the bench, which dumps what changes in the cycles that count and prints PASS. {net: changes}."""
    pipe = out / "changes.vcd"
    pipe.unlink(missing_ok=True)
    os.mkfifo(pipe)
    # Names first, then a count for each code; a section of values that are shown anew counts nothing.
    awk = subprocess.Popen(["mawk", '/^\\$var/ {print} /^[01]/ {c[substr($0,2)]++} /^\\$end/ && d {d=0; split("",c)} '
                            '/^\\$dump(all|on|vars)/ {d=1} END {for (k in c) print "=", k, c[k]}', pipe],
                           stdout=(out / "changes").open("w"))
    printed = run(["vvp", "-n", "bench.vvp", *plusargs], cwd=out, timeout=LONGEST)
    awk.wait(LONGEST)
    pipe.unlink()
    if not re.search(r"^PASS", printed, re.M):
        raise Mistake(f"{out}: the gates do something else than the node\n{printed[-2000:]}")
    codes, changes = {}, collections.Counter()
    for line in (out / "changes").read_text().splitlines():
        words = line.split()
        if words[0] == "$var":
            codes[words[4].lstrip("\\")] = words[3]
        else:
            changes[words[1]] = int(words[2])
    return {net: changes[codes[name]] for name, net in netlist.names.items() if name in codes}


def random_operands(out, verilog, bits, cycles=300):
    """pJ of a clock of module t(clk_i, a, b, y) with new random a, b: as values settle at once, and with the cells' delays."""
    (out / "t.v").write_text(verilog)
    synthesise([out / "t.v"], "t", out)
    netlist = Netlist(out, "t")
    energy, found = energies(netlist, out), []
    for delays in (False, True):
        compile_bench(netlist, random_bench(netlist, "t", {"a": bits, "b": bits}, cycles), out, delays)
        found.append(sum(power(netlist, energy, simulate(netlist, out))) / cycles)
    return found


def initial(match):
    """The declaration, and 0 at the start in all words."""
    whole, _, name, _, last = match.groups()
    if last is None:
        return f"{whole}\n  initial {name} = 0;"
    return f"{whole}\n  initial begin : init_{match.start()} integer i; for (i = 0; i <= {last}; i = i + 1) {name}[i] = 0; end"


def data_energy(flop, library):
    """pJ that a change of a flip-flop's data takes within it, of the least slew that the library has."""
    cell = library.read_text().split(f"\ncell ({flop}) ")[1].split("\ncell (")[0]
    data = re.search(r"next_state : \"(\w+)\"", cell)[1]
    pin = re.split(rf"\n  pin\({data}\)", cell)[1].split("timing()")[0]
    return sum(float(x) for x in re.findall(r'values \("([\d.]+)', pin)) / 2


def energies(netlist, out, library=LIBRARY):
    """Of each cell, by OpenSTA: (pJ of a change at its output, pJ of a clock, leakage in pJ of 10 ns). OpenSTA is asked
    with all nets at rest and with all changing once a clock; the energy of a cell is linear in between. All registers have
    the port's own clock: what drives the pins of a clock is the tree's, with gates and without."""
    driven = {pins[pin] for _, kind, pins in netlist.cells for pin in netlist.outputs(kind)}
    clock = netlist.ports["clk_i"][1]
    ideal = lambda kind, pin, net: clock if kind in netlist.flops and pin == netlist.flops[kind][0] else net
    lines = [f"{kind} c{k} ({', '.join(f'.{pin}({net_name(ideal(kind, pin, net))})' for pin, net in pins.items())});"
             for k, (_, kind, pins) in enumerate(netlist.cells) if kind != GATE]
    gated = [k for k, (_, kind, _) in enumerate(netlist.cells) if kind == GATE]
    for k in gated:
        names = {pin: net_name(net) for pin, net in netlist.cells[k][2].items()}
        lines += [f"{kind} g{k}_{part} (.{pins.format(n=f'g{k}', **names)});" for part, (kind, pins) in enumerate(GATE_CELLS)]
    asked_cells = len(netlist.cells) + (len(GATE_CELLS) - 1) * len(gated)
    read = {net for _, _, pins in netlist.cells for net in pins.values() if isinstance(net, int)}
    given = sorted((read | {clock}) - driven)  # by ports and memories
    asked = sorted({net for direction, net in netlist.ports.values() if direction == "output"} & driven)
    text = f"module gates ({', '.join([net_name(net) for net in given] + [f'o{net}' for net in asked])});\n"
    text += "".join(f"input {net_name(net)};\n" for net in given)
    text += "".join(f"output o{net};\nassign o{net} = {net_name(net)};\n" for net in asked)
    text += "".join(f"wire {net_name(net)};\n" for net in sorted(driven))
    (out / "sta.v").write_text(text + "\n".join(lines) + "\nendmodule\n")
    script = [f"read_liberty {library}", "set_cmd_units -time ns -power W", f"read_verilog {out}/sta.v", "link_design gates",
              f"create_clock -name clk -period {PERIOD} [get_ports {net_name(clock)}]", "set_input_delay 0 -clock clk [all_inputs]"]
    for activity in (0, 1):
        script += [f"set_power_activity -global -activity {activity} -duty 0.5", f'puts "at {activity}"',
                   "report_power -digits 8 -instances [get_cells *]"]
    (out / "sta.tcl").write_text("\n".join([*script, "exit", ""]))
    still, moving = run(["sta", "-no_splash", "-exit", out / "sta.tcl"]).split("at 1\n")
    def told(printed):  # W times ns are nJ
        found = {name: ((float(internal) + float(switching)) * PERIOD * 1e3, float(leakage) * 1e4)
                 for internal, switching, leakage, name in re.findall(r"^ *(\S+) +(\S+) +(\S+) +\S+ +([cg]\w+)$", printed, re.M)}
        if len(found) != asked_cells:
            raise Mistake(f"{out}/sta.tcl: OpenSTA tells the power of {len(found)} of {asked_cells} cells")
        return found
    within = {flop: data_energy(flop, library) for flop in {kind for _, kind, _ in netlist.cells} & set(netlist.flops)}
    still, moving = told(still), told(moving)
    def of(k, kind):
        if kind != GATE:
            (none, leakage), (one, _) = still[f"c{k}"], moving[f"c{k}"]
            return one - none - within.get(kind, 0), none, leakage
        inverter, latch, both = (still[f"g{k}_{part}"] for part in range(len(GATE_CELLS)))
        return both[0] / 2, inverter[0] + latch[0], inverter[1] + latch[1] + both[1]  # the AND turns with the registers' clock
    return [of(k, kind) for k, (_, kind, _) in enumerate(netlist.cells)]


def power(netlist, energy, changes, library=LIBRARY):
    """pJ of each cell but for the clock's."""
    within = {flop: data_energy(flop, library) for flop in netlist.flops}
    of = lambda net: changes.get(net, 0)
    return [change * sum(of(pins[pin]) for pin in netlist.outputs(kind))
            + (within[kind] * of(pins[netlist.flops[kind][1]]) if kind in netlist.flops else 0)
            for (_, kind, pins), (change, _, _) in zip(netlist.cells, energy)]


def net_name(net):
    return f"1'b{net if net in '01' else 0}" if isinstance(net, str) else f"n{net}"
