"""The bill of materials, CycloneDX 1.6 in JSON: every file of the release, every part inside of one, what made them."""

from __future__ import annotations

import json
import uuid
from collections.abc import Iterable, Mapping
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement

from laconic_build.c.facts import Facts
from laconic_build.release.parts import Part
from laconic_build.release.products import Product
from laconic_build.release.tree import Tree

Json = dict[str, Any]
SCHEMA = "http://cyclonedx.org/schema/bom-1.6.schema.json"
ROOT = "laconic"


def bill_of(tree: Tree, facts: Facts, products: Iterable[Product], sums: Mapping[str, str], parts: Mapping[str, Part],
            needed: Iterable[Requirement], tools: Mapping[str, str]) -> Json:
    """`sums`: checksums of all files of the release but the bill; `needed`: what pip fetches for a wheel; `tools`:
    names and versions of what compiled and packed."""
    by_name = {product.name: product for product in products}
    used = {key for product in by_name.values() for key in product.holds}
    fetched = {f"pip:{each.name}": each for each in needed}
    inside = [{"ref": name, "dependsOn": depends_on(by_name[name], fetched)} for name in sorted(by_name)]
    body: Json = {
        "metadata": {
            "timestamp": datetime.fromtimestamp(tree.epoch, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "tools": {"components": [{"type": "application", "name": name, "version": version}
                                     for name, version in sorted(tools.items())]},
            "component": {"type": "application", "bom-ref": ROOT, "name": facts.title, "version": facts.version,
                          "description": facts.sentence, "licenses": ours(facts), "copyright": facts.copyright,
                          "properties": [{"name": "laconic:commit", "value": tree.commit},
                                         {"name": "laconic:changed-files", "value": str(len(tree.changed))}]}},
        "components": [*(file_entry(name, sums[name], by_name.get(name), facts) for name in sorted(sums)),
                       *(part_entry(parts[key]) for key in sorted(used)),
                       *(fetched_entry(ref, each) for ref, each in sorted(fetched.items()))],
        "dependencies": [{"ref": ROOT, "dependsOn": sorted(sums)}, *inside]}
    number = uuid.uuid5(uuid.NAMESPACE_OID, json.dumps(body, sort_keys=True))
    return {"$schema": SCHEMA, "bomFormat": "CycloneDX", "specVersion": "1.6", "serialNumber": f"urn:uuid:{number}",
            "version": 1, **body}


def depends_on(product: Product, fetched: Iterable[str]) -> list[str]:
    """References to what is inside of a product, and to what it needs beside it."""
    return sorted([*(f"part:{key}" for key in product.holds), *(fetched if product.is_wheel else ())])


def file_entry(name: str, digest: str, product: Product | None, facts: Facts) -> Json:
    """A file of the release; those that are no product are texts."""
    told = {"mime-type": product.kind, "description": product.text} if product else {"mime-type": "text/plain"}
    licences = {} if name.startswith("licences/") else {"licenses": ours(facts)}
    return {"type": "file", "bom-ref": name, "name": name, **told, **licences,
            "hashes": [{"alg": "SHA-256", "content": digest}]}


def part_entry(part: Part) -> Json:
    """A part that others wrote."""
    licence = {"id": part.licence} if part.is_spdx else {"name": part.licence}
    return {"type": "library", "bom-ref": f"part:{part.key}", "name": part.name, "version": part.version,
            "description": part.what, "licenses": [{"license": licence}]}


def fetched_entry(ref: str, need: Requirement) -> Json:
    """What is not inside of a wheel, but fetched when it is installed."""
    scope = "optional" if need.marker and "extra" in str(need.marker) else "required"
    return {"type": "library", "bom-ref": ref, "name": need.name, "scope": scope,
            "purl": f"pkg:pypi/{need.name.lower()}",
            "properties": [{"name": "laconic:inside", "value": "no: pip fetches it"},
                           {"name": "laconic:versions", "value": str(need.specifier)}]}


def ours(facts: Facts) -> list[Json]:
    """The project's own licence."""
    return [{"license": {"id": facts.licence_id}}]


def needed_by(wheel_metadata: Iterable[str]) -> list[Requirement]:
    """Requirements of a wheel's metadata but those on itself; one a name, a required one before an optional one."""
    found: dict[str, Requirement] = {}
    for line in wheel_metadata:
        if line.startswith("Requires-Dist: "):
            need = Requirement(line.removeprefix("Requires-Dist: "))
            found.setdefault(need.name, need)
    return [need for name, need in sorted(found.items()) if name != "laconic"]


def written(bill: Json) -> str:
    """Its text."""
    return json.dumps(bill, indent=1, ensure_ascii=False) + "\n"


def faults_of(text: str) -> str:
    """What CycloneDX's schema refuses in it; empty where it is valid."""
    from cyclonedx.schema import SchemaVersion
    from cyclonedx.validation.json import JsonStrictValidator

    found = JsonStrictValidator(SchemaVersion.V1_6).validate_str(text)
    return str(found) if found else ""


def unnamed(bill: Json, folder: Path) -> list[str]:
    """Files of the release that the bill does not name; it cannot name itself nor the checksums."""
    named = {entry["name"] for entry in bill["components"] if entry["type"] == "file"}
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    return sorted(name for name in there - named if name != "SHA256SUMS" and not name.endswith(".cdx.json"))
