"""What scripts/wheel.sh runs in a foreign system: a small recovery with each variant of the library, the time of the import, and
whether the licences of what the wheel holds are there.
"""
import hashlib
import importlib.metadata
import statistics
import subprocess
import sys
import tempfile

MAX_IMPORT_SECONDS = 0.15
LOADER = "/lib64/ld-linux-x86-64.so.2"
LIBRARIES = ("embree", "tbb", "OpenEXR", "Imath", "png", "jpeg", "fmt", "pugixml", "tinyobj")
COMPILED_IN = ("stb", "xxhash", "json", "nanobind")
NAME = "mat-goblet.roughness"


def run():
    """Prints the hash of the texture, and which of the package's variants was loaded."""
    import burnish

    folder = tempfile.mkdtemp()
    burnish.write_scene("goblet", folder, texture_size=64)
    renderer = burnish.load(f"{folder}/scene.xml", size=(64, 64))
    problem = burnish.Problem(renderer, renderer.render(spp=16), NAME)
    summary = burnish.solve(problem, iterations=20)
    assert summary.loss < summary.initial_loss, summary
    with open("/proc/self/maps", encoding="utf-8") as maps:
        loaded = {line.split()[-1] for line in maps if ".so" in line}
    wanted = [file for file in loaded if any(name in file for name in LIBRARIES)]
    assert len(wanted) >= len(LIBRARIES) and all("/burnish.libs/" in file for file in wanted), wanted
    [library] = [file for file in loaded if file.endswith("/libburnish_python.so")]
    print(hashlib.sha256(summary.textures[NAME].tobytes()).hexdigest(), library)


def import_seconds():
    """Of the processor, which other programs do not change; the median of seven processes."""
    code = "import time; begin = time.process_time(); import burnish; print(time.process_time() - begin)"
    return statistics.median(float(subprocess.check_output([sys.executable, "-c", code])) for _ in range(7))


def lacks_licences():
    """Libraries without a text among the package's licences, whose files have the names of Debian's packages."""
    texts = [file.name.lower() for file in importlib.metadata.files("burnish") if file.parent.name == "licenses"]
    return [name for name in LIBRARIES + COMPILED_IN if not any(name.lower() in text for text in texts)]


def main():
    assert not lacks_licences(), lacks_licences()
    said = subprocess.run([LOADER, "--help"], capture_output=True, text=True, check=False).stdout
    newer = [variant for variant in ("x86-64-v3", "x86-64-v4") if f"{variant} (supported, searched)" in said]
    hashes = set()
    for variant in ["x86-64", *newer]:
        found = subprocess.check_output([LOADER, "--glibc-hwcaps-mask", variant, sys.executable, __file__, "run"], text=True)
        digest, library = found.split()
        hashes.add(digest)
        assert (f"/{variant}/" in library) == (variant in newer), (variant, library)
    assert len(hashes) == 1, "the variants make other bytes"
    seconds = import_seconds()
    assert seconds < MAX_IMPORT_SECONDS, f"the import takes {seconds:.3f} s"
    print(f"wheel: recovers a texture, to the same bytes with {', '.join(['x86-64', *newer])}; the import takes {seconds:.3f} s")


if __name__ == "__main__":
    if sys.argv[1:] == ["run"]:
        run()
    else:
        main()
