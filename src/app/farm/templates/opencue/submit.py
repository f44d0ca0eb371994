"""Launches a film's parts and their join by PyOutline. submit.sh tells what is left, and names."""
import getpass
import os
import re

import outline
import outline.cuerun
import outline.modules.shell


def layer(name, words, frames):
    """Its names lie in its environment: Cuebot replaces #NAMES# within a command, and a shell reads it."""
    width = {"cores": float(os.environ["OPENCUE_CORES"]), "overrideCores": True} if "OPENCUE_CORES" in os.environ else {}
    return outline.modules.shell.Shell(
        name, command=["sh", "-c", "'exec \"$R2M_PROGRAM\" " + words + "'"], range=frames, chunk=1, threadable=True,
        env={name: os.environ[name] for name in ("R2M_PROGRAM", "R2M_PLAN")}, **width)


job = outline.Outline(
    re.sub(r"\W", "_", "@name@"), shot=os.environ.get("OPENCUE_SHOT", "film"), show=os.environ.get("OPENCUE_SHOW", "testing"), user=getpass.getuser())
join = layer("join", 'join "$R2M_PLAN"', "1-1")
job.add_layer(join)
if os.environ["R2M_LEFT"]:
    parts = layer("parts", 'part "$R2M_PLAN" #IFRAME#', os.environ["R2M_LEFT"])
    job.add_layer(parts)
    join.depend_all(parts)
outline.cuerun.launch(job, use_pycuerun=False)
