"""How the screen feels, over a pseudo-terminal; see latency.sh."""

import argparse
import codecs
import fcntl
import os
import pty
import re
import select
import shutil
import signal
import statistics
import struct
import subprocess
import tempfile
import termios
import time

COLUMNS, ROWS = 80, 24
RIGHT, LEFT, DOWN = b"\x1b[C", b"\x1b[D", b"\x1b[B"
TICK = os.sysconf("SC_CLK_TCK")
SEQUENCE = re.compile(r"\x1b\[([?]?)([0-9;]*)([A-Za-z])|\x1b\][^\x07]*\x07|\x1b[=>]")


class Eyes:
    """What a terminal of one column per character shows, of the sequences that the program writes."""

    def __init__(self):
        self.decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self.rest = ""
        self.cells = [[(" ", False)] * COLUMNS for _ in range(ROWS)]
        self.row = self.column = 0
        self.inverse = False
        self.frames = 0

    def see(self, data):
        text = self.rest + self.decoder.decode(data)
        at = 0
        while at < len(text):
            if text[at] == "\x1b":
                found = SEQUENCE.match(text, at)
                if not found:
                    break
                at = found.end()
                if found.group(3):
                    self.obey(*found.groups())
                continue
            if text[at] == "\r":
                self.column = 0
            elif text[at] == "\n":
                self.row = min(self.row + 1, ROWS - 1)
            elif self.column < COLUMNS:
                self.cells[self.row][self.column] = (text[at], self.inverse)
                self.column += 1
            at += 1
        self.rest = text[at:]

    def obey(self, private, numbers, letter):
        values = [int(number or 0) for number in numbers.split(";")]
        first = max(values[0], 1)
        if private:
            self.frames += (letter, values[0]) == ("l", 2026)
        elif letter == "H":
            self.row, self.column = first - 1, (values[1] - 1 if len(values) > 1 else 0)
        elif letter == "C":
            self.column += first
        elif letter in "XK":
            end = COLUMNS if letter == "K" else self.column + first
            for column in range(self.column, end):
                self.cells[self.row][column] = (" ", False)
        elif letter == "J":
            self.cells = [[(" ", False)] * COLUMNS for _ in range(ROWS)]
        elif letter == "m":
            # A colour's own numbers may be 0 or 7: what follows 38 or 48 is no attribute.
            while values:
                value = values.pop(0)
                if value in (38, 48):
                    values = values[2:] if values[0] == 5 else values[4:]
                elif value in (0, 27):
                    self.inverse = False
                elif value == 7:
                    self.inverse = True

    def text(self):
        return "\n".join("".join(cell for cell, _ in row).rstrip() for row in self.cells)

    def tab(self):
        """The digit of the view shown."""
        return "".join(cell for cell, inverse in self.cells[1] if inverse).strip()[:1]


class Program:
    """A program in a pseudo-terminal."""

    def __init__(self, command):
        environment = {**os.environ, "LC_ALL": "C.UTF-8", "TERM": "xterm-256color"}
        environment.pop("NO_COLOR", None)
        self.eyes, self.bytes = Eyes(), 0
        self.began = time.perf_counter()
        self.process, self.end = pty.fork()
        if self.process == 0:
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
            os.execvpe(command[0], command, environment)

    def read(self, patience):
        """Reads what is there, or comes in time; false when nothing did."""
        if not select.select([self.end], [], [], max(patience, 0))[0]:
            return False
        data = os.read(self.end, 1 << 16)
        self.bytes += len(data)
        self.eyes.see(data)
        return True

    def until(self, seen, patience=300.0):
        """Seconds until a whole frame shows what is wanted."""
        began = time.perf_counter()
        while True:
            left = began + patience - time.perf_counter()
            before = self.eyes.frames
            if not self.read(left):
                raise SystemExit("the screen does not show what was asked for:\n" + self.eyes.text())
            if self.eyes.frames > before and seen(self.eyes):
                return time.perf_counter() - began

    def quiet(self, silence):
        """Waits until nothing was written for so long; returns when the last byte came."""
        last = time.perf_counter()
        while self.read(silence):
            last = time.perf_counter()
        return last

    def press(self, keys):
        os.write(self.end, keys)

    def seconds(self):
        """Processor seconds of all its threads."""
        with open(f"/proc/{self.process}/stat") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / TICK

    def memory(self, name):
        with open(f"/proc/{self.process}/status") as file:
            return next(int(line.split()[1]) / 1024 for line in file if line.startswith(name))

    def close(self):
        os.kill(self.process, signal.SIGKILL)
        os.waitpid(self.process, 0)
        os.close(self.end)


def quantile(values, share):
    return sorted(values)[min(int(len(values) * share), len(values) - 1)]


def shown(name, value):
    """Seen when the parameter has this value in the panel."""
    return lambda eyes: f"{name} " in eyes.text() and re.search(rf"▸ {name} +‹{value}›", eyes.text())


def series(kind, turns, presses):
    """Key presses in turn, back and forth, with what shows that a frame is that press's."""
    if kind == "view switch":
        order = b"234567890" + b"1"
        for turn in range(presses):
            digit = order[turn % len(order) : turn % len(order) + 1]
            yield digit, lambda eyes, digit=digit.decode(): eyes.tab() == digit
    else:
        value, step = turns, 1
        for turn in range(presses):
            step = -step if turn and turn % 50 == 0 else step
            value += step
            yield (RIGHT if step > 0 else LEFT), shown(kind, value)


KINDS = [("T", b"t", 20), ("k", b"k", 10), ("view switch", b"", 0)]


def latency(command, presses):
    """From press to frame while spectra are computed, each series in a cold run of its own."""
    for kind, first, value in KINDS:
        cache = tempfile.mkdtemp()
        program = Program([*command, "--cache", cache])
        # In another process, so that its floor has the program's load beside it and not our waiting.
        echo = Program(["sh", "-c", "stty raw -echo; echo ready; exec cat"])
        while "ready" not in echo.eyes.text():
            echo.read(5)
        program.until(lambda eyes: "solving" in eyes.text())
        if first:
            program.press(first)
            program.until(shown(kind, value))
        took, floor = [], []
        began, busy = time.perf_counter(), program.seconds()
        for keys, seen in series(kind, value, presses):
            program.press(keys)
            took.append(1e3 * program.until(seen, 10))
            start = time.perf_counter()
            echo.press(b"x")
            echo.read(5)
            floor.append(1e3 * (time.perf_counter() - start))
            while program.read(0.004):
                pass
            if "solving" not in program.eyes.text():
                print(f"  the spectra were done after {len(took)} presses")
                break
        cores = (program.seconds() - busy) / (time.perf_counter() - began)
        program.close()
        echo.close()
        shutil.rmtree(cache)
        print(
            f"  {kind:<12} {len(took):>5} {statistics.median(took):>8.2f} {quantile(took, 0.99):>7.2f} {max(took):>7.2f}"
            f" {statistics.median(floor):>11.2f} {quantile(floor, 0.99):>7.2f} {cores:>7.1f}"
        )


def settled(eyes):
    return "up to date" in eyes.text()


def sizes(program, presses):
    """Bytes per press, until nothing more is written."""
    for kind, first, value in KINDS:
        program.press(first or b"1")
        program.quiet(0.5)
        written = []
        for keys, _ in series(kind, value, presses):
            before = program.bytes
            program.press(keys)
            program.quiet(0.12)
            written.append(program.bytes - before)
        print(f"  {kind:<12} {presses:>5} {statistics.median(written):>8.0f} {quantile(written, 0.99):>7}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--presses", type=int, default=1000)
    parser.add_argument("--cache")
    parser.add_argument("binary")
    parser.add_argument("data")
    options = parser.parse_args()
    command = [options.binary, options.data]
    cache = options.cache or tempfile.mkdtemp()
    warm = [*command, "--cache", cache]
    print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores, {COLUMNS}×{ROWS}")

    print("press to frame while spectra are computed, milliseconds")
    print("               presses  median    99 %     max  floor median    99 %   cores")
    latency(command, options.presses)

    starts = []
    for _ in range(5):
        empty = tempfile.mkdtemp()
        program = Program([*command, "--cache", empty])
        program.until(lambda eyes: "2 Curves" in eyes.text())
        starts.append(1e3 * (time.perf_counter() - program.began))
        program.close()
        shutil.rmtree(empty)
    print(f"cold start to the first frame       {statistics.median(starts):7.1f} ms (of 5, most {max(starts):.1f})")

    subprocess.run([options.binary, "report", options.data, "--cache", cache], stdout=subprocess.DEVNULL, check=True)
    starts, used = [], []
    for _ in range(5):
        program = Program(warm)
        program.until(settled)
        starts.append(1e3 * (time.perf_counter() - program.began))
        used.append(1e3 * program.seconds())
        program.close()
    print(
        f"warm start to complete tables       {statistics.median(starts):7.1f} ms (of 5, most {max(starts):.1f};"
        f" {statistics.median(used):.0f} ms of processor)"
    )

    program = Program(warm)
    program.until(settled)
    program.quiet(1)
    print("bytes per press")
    print("               presses  median    99 %")
    sizes(program, min(options.presses, 100))
    before = program.bytes
    program.quiet(0.5)
    end = time.perf_counter() + 10
    while time.perf_counter() < end:
        program.read(end - time.perf_counter())
    print(f"bytes in 10 idle seconds            {program.bytes - before:7}")

    print(f"memory after the warm start         {program.memory('VmRSS'):7.0f} MB")
    # Every view, every kind of figure, shapes and their functions, other parameters, a pin and a sweep.
    for keys in [b"2", b"3", b"4", b"f", b"f", b"f", b"f", b"5", b"6", b"7", b".", b"\r", b"\r", b"f", b"f", b"9"]:
        program.press(keys)
        program.quiet(0.3)
    for keys in [b"e", b"e", b"w", b"f", b"8", DOWN * 20, b"]", b"]", b"]", b"]", b"]", b"n", RIGHT, RIGHT, b"P", b"d"]:
        program.press(keys)
        program.quiet(0.5)
    for keys in [RIGHT, b"0", b"uuu", b"m", RIGHT, b"u", b"k", b"Y", b"1"]:
        program.press(keys)
        program.quiet(1)
    while not settled(program.eyes):
        program.read(60)
    program.quiet(1)
    print(f"memory at the end of a full session {program.memory('VmRSS'):7.0f} MB, most {program.memory('VmHWM'):.0f} MB")
    program.close()
    if not options.cache:
        shutil.rmtree(cache)


main()
