# SPDX-License-Identifier: MIT
"""Runs a program on one input in a directory of its own, with limits, and tells what it did and left."""
import dataclasses
import os
import resource
import signal
import subprocess
import time

# Of one program: beyond, it hangs. The heaviest sound input takes a third of that.
CPU_SECONDS = int(os.environ.get("MUTATED_CPU_SECONDS", 20))
# On the clock without any processor time: it waits for what never comes.
STALL_SECONDS = int(os.environ.get("MUTATED_STALL_SECONDS", 120))
MEMORY = 3 << 30          # of address space
LARGEST_FILE = 256 << 20


@dataclasses.dataclass
class Ended:
    code: int             # -N: by signal N
    out: bytes
    err: bytes
    cpu: float
    peak: int             # bytes
    stalled: bool
    left_running: bool


def limit_this_process():
    os.setsid()
    # Address sanitizers reserve terabytes of addresses.
    if not os.environ.get("MUTATED_NO_MEMORY_LIMIT"):
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 2))
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def members(group):
    """Processes of a group that still run, and the processor time of each."""
    found = {}
    for name in os.listdir("/proc"):
        if not name.isdigit():
            continue
        try:
            with open(f"/proc/{name}/stat", "rb") as file:
                fields = file.read().rsplit(b")", 1)[1].split()
        except (OSError, IndexError):
            continue
        if int(fields[2]) == group and fields[0] != b"Z":
            found[int(name)] = int(fields[11]) + int(fields[12])
    return found


def end(group):
    try:
        os.killpg(group, signal.SIGKILL)
    except ProcessLookupError:
        pass


def execute(command, directory, environment):
    """The two streams go to files, so that a flood of words fills no pipe."""
    with open(f"{directory}/.out", "w+b") as out, open(f"{directory}/.err", "w+b") as err:
        process = subprocess.Popen(command, cwd=directory, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                   preexec_fn=limit_this_process)
        stalled, last_time, moved, pause = False, None, time.monotonic(), 0.002
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            time.sleep(pause)
            pause = min(pause * 1.3, 0.2)
            if pause == 0.2:
                now = members(process.pid)
                if now != last_time:
                    last_time, moved = now, time.monotonic()
                elif time.monotonic() - moved > STALL_SECONDS:
                    stalled = True
                    end(process.pid)
        process.returncode = os.waitstatus_to_exitcode(status)
        left = members(process.pid)
        for _ in range(20):  # a child that was told to end may need a moment
            if not left:
                break
            time.sleep(0.05)
            left = members(process.pid)
        end(process.pid)
        texts = []
        for file in (out, err):
            file.seek(0)
            texts.append(file.read(1 << 20))
    for name in (".out", ".err"):
        os.unlink(f"{directory}/{name}")
    return Ended(process.returncode, *texts, usage.ru_utime + usage.ru_stime, usage.ru_maxrss << 10, stalled, bool(left))


def tree(directory):
    """Every file below, with its bytes; directories end with '/'. Pipes, links and sockets stand as what they are."""
    found = {}
    for root, directories, files in os.walk(directory):
        place = os.path.relpath(root, directory)
        for name in directories:
            found[os.path.normpath(f"{place}/{name}") + "/"] = b""
        for name in files:
            path = os.path.join(root, name)
            if os.path.islink(path) or not os.path.isfile(path):
                found[os.path.normpath(f"{place}/{name}")] = b"no plain file"
                continue
            with open(path, "rb") as file:
                found[os.path.normpath(f"{place}/{name}")] = file.read()
    return found
