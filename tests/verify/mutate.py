# SPDX-License-Identifier: MIT
"""Mutants of hand-written SystemVerilog modules.

All mutants of a module live in one text and are chosen while it runs: where a statement `x = E;` has the mutants 7
and 9 it becomes `x = (asked == 7) ? E7 : (asked == 9) ? E9 : E;`. One compilation serves them all (mutant schemata:
Untch, Offutt, Harrold, ISSTA 1993). In E7 one token of E is another, or E7 is a constant. A conditional operator hands
its context's width and sign on to its branches, and constants are written as $signed(1'b0), which changes neither;
so with asked == 0 the module is what it was.

A function that is not automatic computes constants, while the hardware is made: its mutants cannot be asked for in a run. They
are marked `constant` and left out of the schemata; `one` gives the text with one of them.

Left alone: declarations, parameters, generate conditions, loop headers, ranges in brackets, replication counts,
assertions, `unused_*`.
"""
import re

PACKAGE = """// SPDX-License-Identifier: MIT
// Which mutant is asked for: a number, 0 for none.
package cuboct_mutation;
  import "DPI-C" function int cuboct_mutant_asked();
  int asked = cuboct_mutant_asked();
endpackage
"""
ASKED = "cuboct_mutation::asked"
ZERO, ONES = "$signed(1'b0)", "~$signed(1'b0)"

# Token: its replacements, each with a name of the kind of mutant.
SWAPS = {
    "+": [("-", "+ to -")], "-": [("+", "- to +")], "*": [("+", "* to +")],
    "&&": [("||", "&& to ||")], "||": [("&&", "|| to &&")],
    "&": [("|", "& to |")], "|": [("&", "| to &")], "^": [("|", "^ to |")],
    "==": [("!=", "== to !=")], "!=": [("==", "!= to ==")],
    "<": [("<=", "< to <=")], "<=": [("<", "<= to <")], ">": [(">=", "> to >=")], ">=": [(">", ">= to >")],
    "<<": [(">>", "<< to >>")], ">>>": [(">>", ">>> to >>")], ">>": [("<<", ">> to <<")],
    "!": [("", "! left out")], "~": [("", "~ left out")],
    "$signed": [("$unsigned", "signed to unsigned")],
}
# Kinds that leave nothing of the expression.
WHOLE = ("stuck at 0", "stuck at 1", "never loaded", "reset left out", "if always", "if never")
TOKEN = re.compile(r"\$?[A-Za-z_][\w$]*|\d*'[sS]?[bdh][0-9a-fA-F_xz]+|'[01]|\d+|&&|\|\||==|!=|<=|>=|<<<|>>>|<<|>>|::|"
                   r"\+:|-:|[-+*/&|^~!<>?:(){}\[\],.;=#@%]|\S")


class Mutant:
    def __init__(self, number, module, line, kind, text, constant):
        self.number, self.module, self.line, self.kind, self.text = number, module, line, kind, text
        self.constant = constant  # is made by a compilation of its own


def blank(text):
    """Comments, attributes and simulation-only parts as spaces, every place where it was."""
    def spaces(m):
        return re.sub(r"[^\n]", " ", m.group(0))
    text = re.sub(r"//[^\n]*", spaces, text)
    text = re.sub(r"\(\*.*?\*\)", spaces, text)
    text = re.sub(r"`ifndef SYNTHESIS.*?`endif|`ifdef FORMAL.*?`endif", spaces, text, flags=re.S)
    return re.sub(r"`\w+[^\n]*", spaces, text)


def tokens_of(code):
    return [(m.group(0), m.start(), m.end()) for m in TOKEN.finditer(code)]


def matching(tokens, k):
    """The token that closes the bracket at k."""
    pairs = {"(": ")", "[": "]", "{": "}"}
    depth, close, opening = 0, pairs[tokens[k][0]], tokens[k][0]
    for j in range(k, len(tokens)):
        if tokens[j][0] == opening:
            depth += 1
        elif tokens[j][0] == close:
            depth -= 1
            if depth == 0:
                return j
    raise ValueError("no closing bracket")


class Region:
    """An expression that is evaluated while the hardware runs, or `constant` while it is made: code[start:end]."""
    def __init__(self, start, end, role, target, constant=False):
        self.start, self.end, self.role, self.target, self.constant = start, end, role, target, constant


def statements(tokens, k, stop, regions, in_ff):
    """Assignments and if conditions of tokens[k:stop] in an always block or function."""
    while k < stop:
        word = tokens[k][0]
        if word == "if" and tokens[k + 1][0] == "(":
            close = matching(tokens, k + 1)
            regions.append(Region(tokens[k + 1][2], tokens[close][1], "if", None))
            k = close + 1
        elif word in ("for", "unique", "case") or word == "integer":
            if word == "for":
                k = matching(tokens, k + 1) + 1
            elif word == "case":
                k = matching(tokens, k + 1) + 1
            elif word == "integer":
                while tokens[k][0] != ";":
                    k += 1
            else:
                k += 1
        elif word in ("begin", "end", "else", "endcase", "default", ";", "endfunction"):
            k += 1
            if word == "begin" and tokens[k][0] == ":":
                k += 2
        else:
            # A label of a case item ends at a ':' before any '=' or ';'.
            j, depth, equals = k, 0, None
            while j < stop and tokens[j][0] != ";":
                t = tokens[j][0]
                if t in "([{":
                    depth += 1
                elif t in ")]}":
                    depth -= 1
                elif depth == 0 and equals is None and t in ("=", "<="):
                    equals = j
                elif depth == 0 and equals is None and t == ":":
                    break
                j += 1
            if j < stop and tokens[j][0] == ":":
                k = j + 1
                continue
            if equals is not None:
                regions.append(Region(tokens[equals][2], tokens[j][1], "ff" if in_ff else "comb",
                                      (tokens[k][1], tokens[equals][1])))
            k = j + 1


def regions_of(code):
    tokens = tokens_of(code)
    regions, k, n = [], 0, len(tokens)
    while k < n and tokens[k][0] != ";":  # the header, up to `);`
        k += 1
    while k < n:
        word = tokens[k][0]
        if word == "assign":
            j = k
            while tokens[j][0] != "=":
                j = matching(tokens, j) + 1 if tokens[j][0] in "([{" else j + 1
            end = j
            while tokens[end][0] != ";":
                end += 1
            regions.append(Region(tokens[j][2], tokens[end][1], "assign", (tokens[k][2], tokens[j][1])))
            k = end + 1
        elif word in ("always_comb", "always_ff", "function"):
            j = k + 1
            if word == "always_ff":
                j = matching(tokens, k + 2) + 1
            if word == "function":
                while tokens[j][0] != "endfunction":
                    j += 1
                begin = k
                while tokens[begin][0] != "begin":
                    begin += 1
                inside = []
                statements(tokens, begin, j, inside, False)
                for region in inside:
                    region.constant = tokens[k + 1][0] != "automatic"
                regions += inside
                k = j + 1
                continue
            if tokens[j][0] == "begin":
                depth, end = 0, j
                while True:
                    if tokens[end][0] == "begin":
                        depth += 1
                    elif tokens[end][0] == "end":
                        depth -= 1
                        if depth == 0:
                            break
                    end += 1
            else:
                end = j
                while tokens[end][0] != ";":
                    end += 1
            statements(tokens, j, end + 1, regions, word == "always_ff")
            k = end + 1
        elif word in ("localparam", "typedef", "parameter", "genvar", "integer"):
            while tokens[k][0] != ";":
                k += 1
        elif word in ("if", "for") and tokens[k + 1][0] == "(":
            k = matching(tokens, k + 1) + 1  # of a generate block
        elif word == "." and tokens[k + 2][0] == "(" and tokens[k + 1][0][0].islower() \
                and tokens[k + 1][0].endswith("i"):
            close = matching(tokens, k + 2)
            if close > k + 3:
                regions.append(Region(tokens[k + 2][2], tokens[close][1], "port", (tokens[k][1], tokens[k + 2][1])))
            k = close + 1
        elif word == "#" and tokens[k + 1][0] == "(":
            k = matching(tokens, k + 1) + 1
        else:
            k += 1
    return regions


def changed_number(word):
    """A constant's neighbours."""
    m = re.fullmatch(r"(\d+)'([bd])([01]+|\d+)", word)
    if not m:
        return []
    width, base = int(m.group(1)), m.group(2)
    value = int(m.group(3), 2 if base == "b" else 10)
    if width == 1:
        return [(f"1'b{1 - value}", f"{word} to 1'b{1 - value}")]
    other = (value + 1) % (1 << width)
    text = f"{width}'d{other}"
    return [(text, f"{word} to {text}")]


def reset_branches(code):
    """Spans of what `if (!rst_ni)` guards."""
    for m in re.finditer(r"if \(!rst_ni\) (begin)?", code):
        end = re.compile(r"\bend\b" if m.group(1) else ";").search(code, m.end()).end()
        yield m.end(), end


def changes(region, text, code, resets):
    """(kind, replacement) of a region; `text` with comments, `code` without."""
    start, end = region.start, region.end
    inside = code[start:end]
    tokens = [(t, a + start, b + start) for t, a, b in tokens_of(inside)]
    found, k = [], 0
    before = None
    while k < len(tokens):
        word, a, b = tokens[k]
        if word == "[":
            close = matching(tokens, k)
            before, k = "]", close + 1
            continue
        if word == "(" and (j := matching(tokens, k)) + 1 < len(tokens) and tokens[j + 1][0] == "{":
            before, k = ")", j + 1  # a replication count
            continue
        if word == "{" and k + 2 < len(tokens) and re.fullmatch(r"\d+|[A-Z]\w*", tokens[k + 1][0]) \
                and tokens[k + 2][0] == "{":
            k += 2
            before = "{"
            continue
        options = SWAPS.get(word, [])
        if word in "+-&|^~" and len(word) == 1:
            binary = before is not None and re.fullmatch(r"[\w$'.]+|\)|\]|\}", before)
            if not binary:
                options = [] if word != "~" else options
        options = options + changed_number(word)
        for other, kind in options:
            found.append((kind, text[start:a] + other + text[b:end]))
        before = word
        k += 1
    whole = inside.strip()
    if region.role == "if":
        found.append(("if always", " 1'b1"))
        found.append(("if never", " 1'b0"))
    else:
        if whole not in ("'0", "1'b0") and not re.fullmatch(r"\d+'[bd]0+", whole):
            found.append(("stuck at 0", " " + ZERO))
        if whole not in ("'1", "1'b1"):
            found.append(("stuck at 1", " " + ONES))
    if region.role == "ff":
        target = code[region.target[0]:region.target[1]].strip().rstrip("<=").strip()
        in_reset = any(a <= region.start < b for a, b in resets)
        found.append(("reset left out" if in_reset else "never loaded", " " + target))
    return found


def mutants_of(module, text, first):
    """Mutants of a module's text, numbered from `first`: (list, places). places: (start, end, [(number, text)])."""
    code = blank(text)
    result, places, number, resets = [], [], first, list(reset_branches(code))
    for region in sorted(regions_of(code), key=lambda r: r.start):
        target = code[region.target[0]:region.target[1]] if region.target else ""
        if "unused_" in target:
            continue
        here = []
        for kind, other in changes(region, text, code, resets):
            if " ".join(other.split()) == " ".join(code[region.start:region.end].split()):
                continue
            line = text.count("\n", 0, region.start) + 1
            shown = " ".join((target + ("= " if region.role in ("assign", "comb") else
                                        "<= " if region.role == "ff" else "") + blank(other)).split())
            if region.role == "if":
                shown = f"if ({shown})"
            if region.role == "port":
                shown = f"{' '.join(target.split())}({' '.join(blank(other).split())})"
            if kind in WHOLE:  # what it was tells such mutants of a module apart
                shown += " for " + " ".join(code[region.start:region.end].split())
            result.append(Mutant(number, module, line, kind, shown, region.constant))
            here.append((number, other.strip()))
            number += 1
        if here:
            places.append((region.start, region.end, here, region.constant))
    return result, places


def schemata(text, places, wanted):
    """The text with every wanted mutant in it."""
    for start, end, here, constant in sorted(places, reverse=True):
        chosen = [(n, other) for n, other in here if n in wanted]
        if not chosen or constant:
            continue
        original = text[start:end].strip()
        whole = "".join(f"({ASKED} == {n}) ? ({other}) : " for n, other in chosen) + f"({original})"
        text = text[:start] + (" " if text[start - 1] != "(" else "") + whole + text[end:]
    return text


def one(text, places, number):
    """The text with one mutant in the place of what it changes."""
    for start, end, here, _ in places:
        for n, other in here:
            if n == number:
                # Outside a schema an unsized constant takes its context's width.
                other = other.replace(ONES, "'1").replace(ZERO, "'0") if other in (ONES, ZERO) else other
                return text[:start] + (" " if text[start - 1] != "(" else "") + other + text[end:]
    raise ValueError(f"no mutant {number}")
