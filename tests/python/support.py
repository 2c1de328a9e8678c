# SPDX-License-Identifier: MIT
"""usage of each test: NAME_test.py ROOT DIRECTORY_OF_CUBOCT"""
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

ROOT, PROGRAMS = sys.argv[1:3]
os.environ["PATH"] = PROGRAMS + ":" + os.environ["PATH"]


def scene_file(name):
    return os.path.join(ROOT, "scenes", name)


def command(*arguments):
    """What `cuboct` prints on stdout; its exit code must be 0."""
    return subprocess.run(
        [os.path.join(PROGRAMS, "cuboct"), *arguments], check=True, capture_output=True, text=True
    ).stdout


def cpu_seconds():
    """Of this process and the programs that it has started: what a busy machine does not change."""
    ticks = 0
    for child in subprocess.run(["ps", "-o", "pid=", "--ppid", str(os.getpid())], capture_output=True, text=True).stdout.split():
        try:
            with open(f"/proc/{child}/stat", encoding="utf-8") as stat:
                ticks += sum(map(int, stat.read().rsplit(")", 1)[1].split()[11:13]))
        except OSError:
            pass  # ended meanwhile
    return time.process_time() + ticks / os.sysconf("SC_CLK_TCK")


def interrupt_after(seconds):
    """SIGINT to this process once it and its programs have worked for so long."""
    begun = cpu_seconds()

    def wait():
        while cpu_seconds() < begun + seconds:
            time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=wait)
    thread.start()
    return thread


def failure(*arguments):
    """Exit code of `cuboct`, and what it prints on stderr."""
    done = subprocess.run([os.path.join(PROGRAMS, "cuboct"), *arguments], capture_output=True, text=True)
    return done.returncode, done.stderr


def main():
    unittest.main(argv=sys.argv[:1], module="__main__")
