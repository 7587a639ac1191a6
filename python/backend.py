# SPDX-License-Identifier: MIT
"""Builds the wheel of neph (PEP 517): the library by CMake, then an archive with the module."""
import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIBRARY = "libneph_metrics.so.0"
DATE = (1980, 1, 1, 0, 0, 0)  # of the files: the same sources give the same archive


def _version():
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(nephelometer VERSION ([\d.]+)", text)[1]


def _tag():
    return f"py3-none-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _build_library():
    """The library without its symbols for debuggers, in a build tree that is kept for the next
    time. NEPH_METRICS_LIBRARY names one that is built already."""
    if os.environ.get("NEPH_METRICS_LIBRARY"):
        return pathlib.Path(os.environ["NEPH_METRICS_LIBRARY"]).read_bytes()
    folder = ROOT / "build/wheel"
    for words in (["cmake", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Release",
                   "-DBUILD_TESTING=OFF"],
                  ["cmake", "--build", folder, "--target", "neph_metrics_shared", "--parallel"]):
        subprocess.run(list(map(str, words)), check=True)
    return (folder / "library" / LIBRARY).read_bytes()


def _metadata():
    return "\n".join(("Metadata-Version: 2.1", "Name: neph", f"Version: {_version()}",
                      "Summary: Errors, flicker and lag of rendered frames",
                      "License: MIT", "Requires-Python: >=3.9", "Requires-Dist: numpy", ""))


def _wheel_file():
    return "\n".join(("Wheel-Version: 1.0", "Generator: neph", "Root-Is-Purelib: false",
                      f"Tag: {_tag()}", ""))


def _record(files):
    """The line of each file: its name, hash and size."""
    def line(name, data):
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        return f"{name},sha256={digest},{len(data)}"
    return [line(name, data) for name, data in files.items()]


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Called by pip; returns the name of the archive."""
    del config_settings, metadata_directory
    about = f"neph-{_version()}.dist-info"
    files = {f"neph/{path.name}": path.read_bytes()
             for path in sorted((ROOT / "python/neph").glob("*.py"))}
    files |= {"neph/py.typed": b"", f"neph/{LIBRARY}": _build_library(),
              f"{about}/METADATA": _metadata().encode(), f"{about}/WHEEL": _wheel_file().encode(),
              f"{about}/LICENSE": (ROOT / "LICENSE").read_bytes()}
    record = "\n".join([*_record(files), f"{about}/RECORD,,", ""])
    name = f"neph-{_version()}-{_tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory, name), "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in [*files.items(), (f"{about}/RECORD", record.encode())]:
            info = zipfile.ZipInfo(path, DATE)
            info.external_attr = 0o644 << 16
            archive.writestr(info, data, zipfile.ZIP_DEFLATED)
    return name


def build_sdist(sdist_directory, config_settings=None):
    """Source archives are those of the project."""
    raise NotImplementedError("neph has no source archive of its own: build from its sources")
