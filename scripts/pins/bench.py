"""Runs jobs: each in a folder of its own, with the same environment on every call."""
import fnmatch
import json
import os
import pathlib
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

from canonical import canonical

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PINS = ROOT / "scripts" / "pins"
SECONDS = 300  # of a command; this ends one that hangs
LEFT_BEHIND = ".holotrace-*"  # files of programs that were killed

# What stands for a need of a job in /proc/cpuinfo, and the modules of Python that it takes.
INSTRUCTIONS = {"sse4": "sse4_1", "avx2": "avx2"}
MODULES = {"python": "numpy, holotrace", "scipy": "numpy, scipy, holotrace", "torch": "numpy, torch, holotrace.torch"}

# A cache was in use for too long: default rates and estimated plans of transforms round in another way.
LOCKED_CACHE = "has been locked by another program for 3 s and is not used"


def output_of(command, **more):
    """Standard output of a command; "" if it fails."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, **more)
    return done.stdout.strip() if done.returncode == 0 else ""


def machine(program):
    """What bytes depend on beside the program: the processor, its instruction set, and the libraries of this machine."""
    info = pathlib.Path("/proc/cpuinfo")
    text = info.read_text() if info.exists() else ""
    keys = ("model name", "cpu family", "model", "stepping", "CPU implementer", "CPU part")  # the last two of ARM
    facts = dict(re.findall(rf"^({'|'.join(keys)}|flags|Features)\s*: (.*)$", text, re.M))
    name = " ".join(facts.get(key, "") for key in keys).strip()
    libraries = {os.path.basename(os.path.realpath(path)) for path in re.findall(r"=> (/\S+)", output_of(["ldd", program]))}
    return {"processor": name or platform.processor() or platform.machine(), "processors": os.cpu_count(),
            "instructions": sorted(facts.get("flags", facts.get("Features", "")).split()), "libraries": sorted(libraries)}


def commit():
    git = ["git", "-C", str(ROOT)]
    changes = output_of([*git, "status", "--porcelain", "-uno"])
    return (output_of([*git, "rev-parse", "HEAD"]) or "unknown") + (" with changes" if changes else "")


class Bench:
    """
    The program, the Python package, and what this machine has not.

    folder   of the record
    program  that is run
    python   interpreter for the Python package
    needs    of all jobs: what is looked for on this machine
    """

    def __init__(self, folder, program, python, needs):
        self.folder, self.program = pathlib.Path(folder).resolve(), pathlib.Path(program).resolve()
        self.python = pathlib.Path(python).absolute()  # a link of a virtual environment
        own = ("HOLOTRACE_INSTRUCTIONS", "HOLOTRACE_SPLIT_DEVICES", "HOLOTRACE_OIDN")
        self.environment = {key: value for key, value in os.environ.items() if key not in own}
        # Kernels that PoCL has compiled are kept where other programs of the user find them: making them takes seconds.
        home = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache")
        self.environment.setdefault("POCL_CACHE_DIR", str(home / "pocl" / "kcache"))
        self.environment |= {"HOLOTRACE_PANELS": "", "HOLOTRACE_PROGRAM": str(self.program), "LC_ALL": "C.UTF-8",
                             "PYTHONPATH": str(self.program.parent / "python"), "PYTHONDONTWRITEBYTECODE": "1",
                             "XDG_CACHE_HOME": str(self.folder / "cache"), "XDG_CONFIG_HOME": str(self.folder / "none")}
        self.machine = machine(self.program)
        told = output_of([self.program, "info", "--devices", "--json"], env=self.environment)
        self.machine["devices"] = [one["name"] for one in json.loads(told)["devices"][1:]] if told else []
        self.machine["program"] = output_of([self.program, "--version"])
        self.missing = {need: reason for need in needs if (reason := self.why_missing(need))}

    def why_missing(self, need):
        """Why jobs with this need cannot run here; "" if they can."""
        if need == "opencl":
            return "" if self.machine["devices"] else "no OpenCL device here"
        if need == "mpi":
            return "" if shutil.which("mpirun") else "no mpirun here"
        if need in INSTRUCTIONS:
            return "" if INSTRUCTIONS[need] in self.machine["instructions"] else f"this processor has no {need.upper()}"
        try:
            subprocess.run([self.python, "-c", f"import {MODULES[need]}"], env=self.environment, capture_output=True, check=True)
        except (OSError, subprocess.CalledProcessError):
            return f"{self.python} cannot import {MODULES[need]}"
        return ""

    def why_left_out(self, job):
        return next((self.missing[need] for need in job.needs if need in self.missing), "")

    def words(self, job, command):
        first, *rest = shlex.split(command)
        if first.endswith(".py"):
            needs_package = MODULES.keys() & set(job.needs)
            return [str(self.python) if needs_package else sys.executable, str(PINS / first), *rest]
        threads = [] if first.startswith("-") else ["--threads", "1" if job.launcher else "2"]
        return [*job.launcher.split(), str(self.program), first, *rest, *threads]

    def run(self, job, folder):
        """
        Runs a job in an empty folder.

        Returns the canonical bytes of its files by their names, among them messages.txt, with all that its commands
        print; and the sentence of a command that failed, or "".
        """
        for _ in range(3):
            messages, failure = self.attempt(job, folder)
            if LOCKED_CACHE not in messages:
                break
        (folder / "messages.txt").write_text(messages, errors="surrogateescape")
        names = (str(path.relative_to(folder)) for path in sorted(folder.rglob("*")) if path.is_file())
        return {name: self.kept(folder / name) for name in names
                if not any(fnmatch.fnmatch(name, pattern) for pattern in (*job.loose, LEFT_BEHIND))}, failure

    def kept(self, path):
        """The canonical bytes of a file."""
        places = ((self.program, "PROGRAM"), (self.folder, "PINS"), (ROOT, "ROOT"), (tempfile.gettempdir(), "TEMPORARY"))
        return canonical(path.name, path.read_bytes(), places)

    def attempt(self, job, folder):
        """What the commands print, up to the first that fails, and the sentence of that one."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for path in job.copies:
            shutil.copy(folder / path, folder)
        messages = ""
        for command in job.commands:
            try:
                done = subprocess.run(self.words(job, command), cwd=folder, env=self.environment | job.environment, text=True,
                                      stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS, check=False,
                                      errors="surrogateescape")
                text, code = done.stdout + done.stderr, done.returncode
            except subprocess.TimeoutExpired:
                text, code = f"it takes more than {SECONDS} s", -1
            messages += f"$ {command}\n{text}"
            if code != 0:
                lines = text.strip().splitlines() or ["it prints nothing"]
                why = next((line for line in lines if line.startswith("holotrace: expected")), lines[-1])
                return messages + f"exit code {code}\n", f"{job.name}: exit code {code} of {command}\n    {why}"
        return messages, ""
