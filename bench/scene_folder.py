"""The scene of a folder of captures, and what it was made of."""
import json
import shutil
import subprocess
import sys
from pathlib import Path

from compare_sides import PUBLISHED, digest_of


def source_of(name: str, arguments) -> dict:
    if name in PUBLISHED:
        return {"files": digest_of(arguments.scenes / name)}
    return {"texture_size": arguments.texture_size}


def refuse_another(name: str, folder: Path, found: dict, wanted: dict) -> None:
    if found == wanted:
        return
    was = "a copy of other files" if name in PUBLISHED else f"a scene of --texture-size {found.get('texture_size')}"
    sys.exit(f"captures: {folder} holds {was}: expected another folder")


def write_scene(name: str, folder: Path, arguments) -> Path:
    """scene/scene.xml in the folder of a capture. What is there is taken where it was made of the same."""
    file, record, wanted = folder / "scene" / "scene.xml", folder / "scene.json", source_of(name, arguments)
    if file.exists():
        if record.exists():
            refuse_another(name, folder, json.loads(record.read_text()), wanted)
        return file
    folder.mkdir(parents=True, exist_ok=True)
    record.write_text(json.dumps(wanted, indent=1) + "\n")
    if name in PUBLISHED:
        unfinished = folder / "scene.unfinished"
        shutil.rmtree(unfinished, ignore_errors=True)
        shutil.copytree(arguments.scenes / name, unfinished, copy_function=shutil.copyfile)
        shutil.rmtree(file.parent, ignore_errors=True)  # what was stopped without a name of its own
        unfinished.rename(file.parent)
    else:
        subprocess.run([arguments.burnish, "scene", name, "-o", file.parent, "--texture-size",
                        str(arguments.texture_size)], check=True, stdout=subprocess.DEVNULL)
    return file
