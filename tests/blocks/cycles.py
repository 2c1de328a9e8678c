# SPDX-License-Identifier: MIT
"""Cycle tables. A fenced block of a page says what goes into a module, cycle by cycle, and shows what came out of it
when it was simulated (Icarus):

    cuboct_fifo Bits=8 Depth=2            the module and its parameters
    parameters A=1 B=2                    more of them
    project CASE                          modules that are generated are those of this case (emit_case)
    constant has_link_i=3f                inputs that no column holds and that are not 0
    with assign a_i = b_o;                SystemVerilog beside the module: what stands around it
    where own = counts_i[4:0]; x = ...    a column's name for a part of a port, or for any expression
    show data_o when valid_o              `-` in cycles in which valid_o is not 1
    changes 300                           run until cycle 300; a row for each cycle that differs from the one before
    cycle | push_i data_i | full_o count:d

Left of the second bar are inputs, right of it outputs; a column's name may leave out _i or _o. A column is hexadecimal,
with :d decimal, :s signed, :b binary.
One-bit columns show `.` for 0; `x` is unknown. A row holds until the next one: cycles between them are run, not shown.
Before cycle 0 two cycles are spent in reset, all inputs 0. An input set in a row changes after that cycle's first edge;
outputs are read before its last."""
import dataclasses
import pathlib
import re
import shutil
import subprocess
import tempfile

from library import InputError

KEYS = ("parameters", "project", "constant", "with", "where", "show", "changes")
LIMIT = 60  # seconds of a simulation
FORMATS = {"": 16, "d": 10, "s": 10, "b": 2}


@dataclasses.dataclass
class Column:
    title: str       # as the page has it
    expression: str  # SystemVerilog
    form: str        # key of FORMATS
    when: str        # expression, "" for always


@dataclasses.dataclass
class Table:
    where: str       # page and line, for messages
    head: list       # the lines before the columns, as they are
    module: str
    parameters: dict
    project: str
    constants: dict
    around: list
    changes: int     # 0: the rows are those of the page
    inputs: list
    outputs: list
    rows: list       # (cycle, [values of inputs])


def split_pairs(words, where):
    pairs = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals:
            raise InputError(f"{where}: '{word}' is not NAME=VALUE")
        pairs[name] = value
    return pairs


def read_table(lines, where):
    """A block's lines to a table. Of rows only the inputs are read; with `changes` only rows that change one."""
    words = lines[0].split()
    table = Table(where, [lines[0]], words[0], split_pairs(words[1:], where), "", {}, [], 0, [], [], [])
    names, whens = {}, {}
    columns = None
    for line in lines[1:]:
        key, _, rest = line.partition(" ")
        if columns is None and key in KEYS:
            table.head.append(line)
            if key == "parameters":
                table.parameters |= split_pairs(rest.split(), where)
            elif key == "project":
                table.project = rest.strip()
            elif key == "constant":
                table.constants |= split_pairs(rest.split(), where)
            elif key == "with":
                table.around.append(rest)
            elif key == "where":
                for part in rest.split(";"):
                    name, equals, expression = part.partition(" = ")
                    if not equals:
                        raise InputError(f"{where}: '{line}' is not NAME = EXPRESSION; NAME = EXPRESSION ...")
                    names[name.strip()] = expression.strip()
            elif key == "show":
                shown, _, condition = rest.partition(" when ")
                whens |= {name: condition.strip() for name in shown.split()}
            else:
                table.changes = int(rest)
        elif columns is None:
            columns = line.split("|")
            if columns[0].strip() != "cycle" or len(columns) != 3:
                raise InputError(f"{where}: '{line}' is none of {', '.join(KEYS)}, nor 'cycle | inputs | outputs'")
            for text, into, shows in zip(columns[1:], (table.inputs, table.outputs), ({}, whens)):
                for title in text.split():
                    name, _, form = title.partition(":")
                    if form not in FORMATS:
                        raise InputError(f"{where}: column '{title}': the format '{form}' is none of d, s, b")
                    into.append(Column(title, names.get(name, name), form, shows.get(name, "")))
        else:
            cells = line.split("|")
            values = cells[1].split() if len(cells) > 1 else []
            if not cells[0].strip().isdigit() or len(values) != len(table.inputs):
                raise InputError(f"{where}: '{line}' is not a cycle and {len(table.inputs)} inputs")
            row = (int(cells[0]), values)
            if table.rows and row[0] <= table.rows[-1][0]:
                raise InputError(f"{where}: cycle {row[0]} comes after {table.rows[-1][0]}")
            if not table.changes or not table.rows or table.rows[-1][1] != values:
                table.rows.append(row)
    if columns is None or not table.rows:
        raise InputError(f"{where}: a cycle table needs columns and a row")
    return table


def literal(text, form, where):
    """A value of a page as SystemVerilog."""
    text = "0" if text == "." else text
    if text == "x":
        return "'x"
    try:
        value = int(text, FORMATS[form])
    except ValueError as error:
        raise InputError(f"{where}: '{text}' is not a number of base {FORMATS[form]}") from error
    return str(value) if form == "s" else f"'h{value:x}"


BENCH = """`timescale 1ns/1ns
module block_bench{header};
{declarations}
  {module} {passed}dut ({ports});
  integer cycle;
  task step(input integer shown);
    begin
      #3;
      if (shown != 0) begin
        $write("%0d", cycle);
{writes}
        $write("\\n");
      end
      #1 clk_i = 1'b1;
      #4 clk_i = 1'b0;
      cycle = cycle + 1;
    end
  endtask
  initial begin
    clk_i = 1'b0;
    rst_ni = 1'b0;
{start}
    repeat (2) begin
      #4 clk_i = 1'b1;
      #4 clk_i = 1'b0;
    end
    rst_ni = 1'b1;
    cycle = 0;
{rows}
    $finish;
  end
endmodule
module block_top;
  block_bench {overrides}bench ();
endmodule
"""


def bench(table, module):
    """A module around the block that drives the rows and writes what is seen: per cycle the number, then each value in
    binary, a value that is not to be shown as `-`."""
    ports, parameters = module.ports, module.parameters
    names = {port.name for port in ports}
    for columns, suffix in ((table.inputs, "_i"), (table.outputs, "_o")):
        for column in columns:
            if column.expression not in names and column.expression + suffix in names:
                column.expression += suffix
    around = set(re.findall(r"\w+", re.sub(r"\.\w+", "", " ".join(table.around))))
    driven = {re.match(r"\w+", column.expression)[0] for column in table.inputs}
    held = {port.name: "'0" for port in ports if port.kind == "in"}
    for name in list(table.constants) + sorted(driven):
        if name not in held and name not in around:
            raise InputError(f"{table.where}: '{name}' is no input of {table.module}")
    for name, value in table.constants.items():
        held[name] = literal(value, "", table.where)
    # An input that the code around the module speaks of, and no column nor constant, is driven there.
    tied = around - driven - set(table.constants) | {"clk_i", "rst_ni"}

    connect = lambda pairs: ", ".join(f".{name}({value})" for name, value in pairs)
    writes = []
    for column in table.inputs + table.outputs:
        show = f'$write(" %b", {column.expression});'
        writes.append(f"if (({column.when}) === 1'b1) {show} else $write(\" -\");" if column.when else show)
    rows = []
    for cycle, values in table.rows:
        rows.append(f"while (cycle < {cycle}) step({int(table.changes > 0)});")
        rows += [f"{column.expression} = {literal(value, column.form, table.where)};"
                 for column, value in zip(table.inputs, values)]
        rows.append("step(1);")
    if table.changes:
        rows.append(f"while (cycle <= {table.changes}) step(1);")
    passed = connect((item.name, item.name) for item in parameters if item.kind != "derived")
    header = ",\n  ".join(item.text for item in parameters)
    overrides = connect(table.parameters.items())
    lines = lambda indent, texts: "\n".join(indent + text for text in texts)
    return BENCH.format(
        module=table.module, header=f" #(\n  {header}\n)" if header else "", passed=f"#({passed}) " if passed else "",
        declarations=lines("  ", [f"{port.text};" for port in ports]
                           + [f"logic {name};" for name in ("clk_i", "rst_ni") if name not in names] + table.around),
        ports=", ".join(f".{port.name}" for port in ports), writes=lines("        ", writes),
        start=lines("    ", [f"{name} = {value};" for name, value in held.items() if name not in tied]),
        rows=lines("    ", rows), overrides=f"#({overrides}) " if overrides else "")


def copy_for_icarus(sources, folder):
    """Copies of the modules as Icarus 11 can simulate them: in its code for always_comb all blocks wait for one and the
    same event that nobody defines, so that a block which wakes any wakes all, for ever. The emitted bench has such
    copies too."""
    folder.mkdir()
    for source in sources:
        (folder / source.name).write_text(source.read_text().replace("always_comb", "always @*"))
    return folder


def simulate(table, module, folder):
    """What the bench writes: a list of (cycle, [values])."""
    for tool in ("iverilog", "vvp"):
        if not shutil.which(tool):
            raise InputError(f"{tool} was not found: install the Debian package iverilog")
    with tempfile.TemporaryDirectory() as work:
        source, program = pathlib.Path(work) / "bench.sv", pathlib.Path(work) / "bench.vvp"
        source.write_text(bench(table, module))
        command = ["iverilog", "-g2012", "-DSYNTHESIS", "-s", "block_top", "-o", program, "-Y", ".sv"]
        command += ["-y", folder, *sorted(folder.glob("*_pkg.sv"))]
        run = subprocess.run([*command, source], capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise InputError(f"{table.where}: Icarus refuses the table's bench:\n{run.stdout}{run.stderr}")
        try:
            run = subprocess.run(["vvp", "-n", program], cwd=work, capture_output=True, text=True, check=False,
                                 timeout=LIMIT)
        except subprocess.TimeoutExpired as error:
            raise InputError(f"{table.where}: the simulation did not end in {LIMIT} s: the code around the module "
                             f"oscillates, or the bench is too long") from error
    found = []
    for line in run.stdout.splitlines():
        words = line.split()
        if not words or not words[0].isdigit() or len(words) != 1 + len(table.inputs) + len(table.outputs):
            raise InputError(f"{table.where}: the simulation says: {line}")
        found.append((int(words[0]), words[1:]))
    if run.returncode != 0 or not found:
        raise InputError(f"{table.where}: the simulation ended with {run.returncode}: {run.stderr}")
    return found


def shown(bits, form):
    """A binary value as the page shows it."""
    if bits == "-":
        return "-"
    if not set(bits) <= {"0", "1"}:
        return "x"
    if bits == "0":
        return "."
    value = int(bits, 2)
    if form == "s" and bits[0] == "1":
        value -= 1 << len(bits)
    digits = (len(bits) + 3) // 4 if len(bits) <= 32 else 1
    return {"": f"{value:0{digits}x}", "b": bits}.get(form, str(value))


def print_table(table, found):
    """The block's lines."""
    columns = table.inputs + table.outputs
    rows = []
    for cycle, values in found:
        row = [str(cycle)] + [shown(value, column.form) for value, column in zip(values, columns)]
        if not table.changes or not rows or rows[-1][1:] != row[1:]:
            rows.append(row)
    titles = ["cycle"] + [column.title for column in columns]
    widths = [max(len(row[i]) for row in [titles, *rows]) for i in range(len(titles))]
    lines = []
    for row in [titles, *rows]:
        cells = [cell.rjust(width) for cell, width in zip(row, widths)]
        split = 1 + len(table.inputs)
        lines.append(" | ".join([cells[0], " ".join(cells[1:split]), " ".join(cells[split:])]).rstrip())
    return table.head + lines
