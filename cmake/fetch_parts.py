"""Fetch the third-party C sources that the build needs: Unity for the tests, the FMI headers for the FMUs.

Each part is searched on its project's own site first, then in the package index or in FMPy. A file is accepted only
with the SHA-256 written here (the hash of FMPy in the Python lock file covers its copies of the FMI headers).
Run at build time by the environment's Python.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import sys
import tarfile
import urllib.request
from pathlib import Path

SITE = "https://raw.githubusercontent.com"
SITE_TIMEOUT_S = 6
UNITY_SITE = SITE + "/ThrowTheSwitch/Unity/v2.6.1/src/"
UNITY = {
    "unity.c": "b90e735a54cf3b3765ab6caa955d11a1488ee73d9c6152cdc98576c2d17cb871",
    "unity.h": "9db174d3c2c6424fd35c0980c5941d124c5ebb0f48e8172f997a2aa9554b64ea",
    "unity_internals.h": "fcd8b3f6b412ac0ab599547eb8a30b6d7f3f0af77aab31f7a1822a2a8fc9a2b2",
}
UNITY_ARCHIVE = ("pysear", "0.7.1", "tests/unity")  # a source archive that carries the same three files
FMI_2_SITE = SITE + "/modelica/fmi-standard/v2.0.4/headers/"
FMI_2 = {
    "fmi2FunctionTypes.h": "b61f44eb767e566b507a22f36453ecafa41fd89fb4c2db3a99bf66491d8a927f",
    "fmi2Functions.h": "99a96ab899c9245ed95f61a6f27bf255da4aacf5ecea250b43c93c714b1475a2",
    "fmi2TypesPlatform.h": "838fb87c1f1c4a74c2c6a66716378c9c6db4900bb8c614d3ace38e90a682d7b6",
}
FMI_3_SITE = SITE + "/modelica/fmi-standard/v3.0.1/headers/"
FMI_3 = {
    "fmi3FunctionTypes.h": "77bb086dbf9b9123f75edc2a90a0f27fb5c32f913ab3f9b69fe2e2cbc2448b24",
    "fmi3Functions.h": "6367e9f7895848ed8d06c8a9b7f77e72d9f3eae102f64c313d51c10049b720ee",
    "fmi3PlatformTypes.h": "19ea19ae07cdab582931fc1a545d9aeef3d5066da131ee96a7e393e72164fa30",
}


class Unavailable(Exception):
    """A source does not have the part, or cannot be reached."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("part", choices=("unity", "fmi"))
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    sources, remedy = {
        "unity": ((unity_from_site, unity_from_archive), "-DUNITY_DIR=<folder with unity.c>"),
        "fmi": ((fmi_from_site, fmi_from_fmpy), "-DFMI_HEADERS_DIR=<folder with fmi2Functions.h and fmi3Functions.h>"),
    }[arguments.part]
    reasons = []
    for source in sources:
        try:
            write(arguments.folder, source())
            return 0
        except Unavailable as reason:
            reasons.append(str(reason))
    print(f"laconic: {arguments.part} not found ({'; '.join(reasons)}): give {remedy}", file=sys.stderr)
    return 1


def write(folder: Path, files: dict[str, bytes]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / name).write_bytes(content)


def checked(content: bytes, name: str, sha256: str) -> bytes:
    if hashlib.sha256(content).hexdigest() != sha256:
        raise Unavailable(f"{name} has another SHA-256 than expected")
    return content


def from_site(address: str, files: dict[str, str]) -> dict[str, bytes]:
    try:
        return {name: checked(download(address + name), name, sha256) for name, sha256 in files.items()}
    except OSError as error:
        raise Unavailable(f"its own site cannot be reached, {getattr(error, 'reason', error)}") from error


def download(address: str) -> bytes:
    with urllib.request.urlopen(address, timeout=SITE_TIMEOUT_S) as answer:
        return answer.read()


def unity_from_site() -> dict[str, bytes]:
    return from_site(UNITY_SITE, UNITY)


def unity_from_archive() -> dict[str, bytes]:
    project, version, folder = UNITY_ARCHIVE
    members = {}
    with tarfile.open(fileobj=io.BytesIO(source_archive(project, version))) as archive:
        for name, sha256 in UNITY.items():
            content = archive.extractfile(f"{project}-{version}/{folder}/{name}").read()
            members[name] = checked(content, name, sha256)
    return members


def source_archive(project: str, version: str) -> bytes:
    """A source archive, unchanged, from the configured package index.

    `pip download` would build the package, which needs compilers for another machine; so pip's finder finds it.
    """
    from pip._internal.commands import create_command
    from pip._internal.exceptions import PipError

    command = create_command("download")
    try:
        with command.main_context():
            options, _ = command.parse_args(["--disable-pip-version-check", project])
            session = command.get_default_session(options)
            finder = command._build_package_finder(options, session, ignore_requires_python=True)
            links = [found.link for found in finder.find_all_candidates(project) if str(found.version) == version]
            link = next(link for link in links if not link.is_wheel)
            answer = session.get(link.url_without_fragment)
            answer.raise_for_status()
            return answer.content
    except (PipError, OSError, StopIteration) as error:
        raise Unavailable("the package index has no source archive of it, or cannot be reached") from error


def fmi_from_site() -> dict[str, bytes]:
    return from_site(FMI_2_SITE, FMI_2) | from_site(FMI_3_SITE, FMI_3)


def fmi_from_fmpy() -> dict[str, bytes]:
    try:
        import fmpy
    except ImportError as error:
        raise Unavailable("FMPy is not installed") from error
    folder = Path(fmpy.__file__).parent / "c-code"
    try:
        return {name: (folder / name).read_bytes() for name in FMI_2 | FMI_3}
    except OSError as error:
        raise Unavailable(f"FMPy lacks {error.filename}") from error


if __name__ == "__main__":
    sys.exit(main())
