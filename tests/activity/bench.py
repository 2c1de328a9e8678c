# SPDX-License-Identifier: MIT
"""The bench that gives a node's netlist, cycle by cycle, what record_nodes wrote down, and compares what it shows."""


def fields(particle_bits, link_bits, faces):
    """Inputs and outputs in the order of record_nodes.cpp: (port, bits), least significant first."""
    inputs = [("rst_ni", 1), ("start_i", 1), ("steps_i", 32), ("has_link_i", faces), ("load_valid_i", 1),
              ("load_data_i", particle_bits), ("link_ready_i", faces), ("link_valid_i", faces), ("link_end_i", faces)]
    outputs = [("phase_start_o", 8), ("phase_end_o", 8), ("idle_o", 1), ("fault_valid_o", 1), ("observe_valid_o", 1),
               ("observe_data_o", particle_bits), ("link_ready_o", faces), ("link_valid_o", faces), ("link_end_o", faces)]
    beats = lambda port: [(f"{port}[{f}]", link_bits) for f in range(faces)]
    return inputs + beats("link_data_i"), outputs + beats("link_data_o")


def digits(bits):
    return (bits + 3) // 4


def places(fields_of):
    """{port: lowest bit of the line}; each field begins at a digit."""
    at, found = 0, {}
    for port, bits in fields_of:
        found[port] = at
        at += 4 * digits(bits)
    return found, at


def bench(netlist_ports, particle_bits, link_bits, faces, most_lines):
    """Its plusargs: lines; first, the first line of the window that counts; cycles, its length."""
    inputs, outputs = fields(particle_bits, link_bits, faces)
    place_in, width_in = places(inputs)
    place_out, width_out = places(outputs)
    widths = dict(outputs)

    def of(port, index):
        """Where bit `index` of a port lies in a line."""
        for places_of, name in ((place_in, "in"), (place_out, "out")):
            if port in places_of:
                return f"{name}[{places_of[port] + index}]"
            if f"{port}[0]" in places_of:
                face, bit = divmod(index, link_bits)
                return f"{name}[{places_of[f'{port}[{face}]'] + bit}]"
        return None

    wires, connections = [], []
    for name, (direction, _) in netlist_ports.items():
        port, _, index = name.partition("[")
        index = int(index.rstrip("]") or 0)
        if port == "clk_i":
            connections.append(".clk_i(clk)")
            continue
        place = of(port, index)
        if direction == "input":
            if place is None:
                place = "1'b0"
            connections.append(f".\\{name} ({place})")
        elif place is not None:
            connections.append(f".\\{name} (shown[{place[place.index('[') + 1:-1]}])")
    part = lambda vector, port: f"{vector}[{place_out[port]} +: {widths[port]}]"
    always = [port for port in ("phase_start_o", "phase_end_o", "idle_o", "fault_valid_o", "observe_valid_o", "link_ready_o",
                                "link_valid_o")]
    linked = f"in[{place_in['has_link_i']} +: {faces}]"
    mask = lambda port: f" & {linked}" if port.startswith("link_") else ""  # a face without a link shows what it likes
    checks = [f"check(({part('shown', p)}{mask(p)}) === ({part('out', p)}{mask(p)}), {k});" for k, p in enumerate(always)]
    checks.append(f"if ({part('out', 'observe_valid_o')}) check({part('shown', 'observe_data_o')} === {part('out', 'observe_data_o')}, 20);")
    for f in range(faces):
        valid = f"out[{place_out['link_valid_o'] + f}]"
        checks.append(f"if ({valid}) check({part('shown', f'link_data_o[{f}]')} === {part('out', f'link_data_o[{f}]')} && "
                      f"shown[{place_out['link_end_o'] + f}] === out[{place_out['link_end_o'] + f}], {30 + f});")
    newline = "\n    "
    return f"""`timescale 1ns/10ps
module bench;
  reg clk = 0;
  reg [{width_out - 1}:0] out;
  reg [{width_in - 1}:0] in;
  wire [{width_out - 1}:0] shown;
  reg [{width_in + width_out - 1}:0] line [0:{most_lines - 1}];
  integer t, matched = 0, lines, first, cycles, got;
  cuboct_node dut ({(',' + newline).join(connections)});
  task check(input same, input integer what);
    if (same) matched = matched + 1;
    else begin
      $display("FAIL cycle %0d: output %0d differs", t, what);
      $finish;
    end
  endtask
  initial begin
    got = $value$plusargs("lines=%d", lines) + $value$plusargs("first=%d", first) + $value$plusargs("cycles=%d", cycles);
    $readmemh("lines.hex", line);
    $dumpfile("changes.vcd");
    $dumpvars(1, dut);
    $dumpoff;
    {{out, in}} = line[0];
    for (t = 0; t < lines - 1; t = t + 1) begin
      if (t == first) $dumpon;
      if (t == first + cycles) $dumpoff;
      #50 clk = 0;
      #50;
      if (t > 1) begin
      {newline.join(checks)}
      end
      // What comes over links comes from registers of the same clock.
      clk = 1;
      {{out, in}} <= line[t+1];
    end
    $display("PASS %0d comparisons, %0d cycles", matched, t);
    $finish;
  end
endmodule
"""
