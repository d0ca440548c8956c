"""A job, and what the lists of jobs have in common."""
import dataclasses
import re

# A job runs in a folder of its own. It finds its inputs, and the files of other jobs as the record has them, at:
IN, OF = "../../inputs", "../../files"

PANEL, EFFECTS, AMPLITUDE = (f"--slm {IN}/{name}.toml" for name in ("panel", "effects", "amplitude"))
ROOM, COLOURS, WALL, POINTS = (f"{IN}/{name}.toml" for name in ("room", "colours", "wall", "points"))
RANKS = "mpirun --allow-run-as-root --oversubscribe -n 2"


@dataclasses.dataclass(frozen=True, eq=False)
class Job:
    """
    commands     command lines of the program, or of a Python script beside this file
    needs        what a machine may not have: opencl, mpi, python, scipy, torch, sse4, avx2
    launcher     words before the program
    environment  variables, beside those of all jobs
    copies       files that are copied into its folder first
    loose        files whose bytes depend on chance, as a pattern: they are kept for other jobs, and not compared
    """
    name: str
    commands: tuple
    needs: tuple = ()
    launcher: str = ""
    environment: dict = dataclasses.field(default_factory=dict)
    copies: tuple = ()
    loose: tuple = ()

    @property
    def sources(self):
        """Names of the jobs whose files it reads."""
        return sorted({name for text in self.commands + self.copies for name in re.findall(rf"{OF}/([\w-]+)", text)})


def job(name, *commands, needs="", **more):
    return Job(name, commands, tuple(needs.split()), **more)


def each(command, **variants):
    """A command for each variant: its name and its flags stand in the command as NAME and FLAGS."""
    return [command.replace("FLAGS", flags).replace("NAME", name) for name, flags in variants.items()]


def for_words(command, *words):
    """A command for each word, which stands in the command as WORD."""
    return [command.replace("WORD", word) for word in words]
