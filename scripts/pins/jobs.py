"""The table of jobs: command lines whose outputs scripts/pin records and compares."""
import jobs_of_holograms
import jobs_of_light

JOBS = [*jobs_of_light.JOBS, *jobs_of_holograms.JOBS]  # a job reads from earlier ones only

# What no job can pin, and why.
NOT_PINNED = ("bench: it prints times", "display: it writes no file, and needs a monitor",
              "denoising: Open Image Denoise has releases of its own; all jobs are without it")
