"""The folder of a sweep: its plan, the chunks that are done, and in the end one Parquet file with all runs in order.

    sweep.json         plan, versions, command: written first
    parts/N.parquet    a chunk that is done, written whole; all of them go when the results are whole
    results.parquet    a row for each run, with the text of sweep.json in its metadata
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from laconic.base.outputs import whole_file
from laconic.errors import BadInput, reason_of
from laconic.tools.sweep.chunk import Rows
from laconic.tools.sweep.plan import Plan, plan_from

ABOUT, RESULTS, PARTS = "sweep.json", "results.parquet", "parts"
METADATA = b"laconic.tools.sweep"
COLUMNS = ("run", "refused", "refused_at_s")


@dataclass(frozen=True)
class Store:
    """A folder with its plan; chunks are counted from 0."""

    folder: Path
    plan: Plan
    chunk: int               # runs in each but the last
    about: Mapping[str, Any]

    @property
    def chunks(self) -> int:
        """How many there are."""
        return -(-self.plan.runs // self.chunk)

    def range_of(self, number: int) -> tuple[int, int]:
        """The first run of a chunk, and how many it has."""
        first = number * self.chunk
        return first, min(self.chunk, self.plan.runs - first)

    @property
    def is_whole(self) -> bool:
        """Whether the results are there."""
        return (self.folder / RESULTS).exists()

    def missing(self) -> list[int]:
        """The chunks that are still to be done."""
        return [] if self.is_whole else [number for number in range(self.chunks) if not self._is_there(number)]

    def _path_of(self, number: int) -> Path:
        return self.folder / PARTS / f"{number:06d}.parquet"

    def _is_there(self, number: int) -> bool:
        try:
            return bool(pq.read_metadata(self._path_of(number)).num_rows == self.range_of(number)[1])
        except (OSError, pa.ArrowInvalid):
            return False

    def schema(self) -> pa.Schema:
        """Columns of the results: run, varied keys, measures, why there are none."""
        kinds = {"text": pa.string(), "true or false": pa.bool_(), "whole number": pa.int64()}
        return pa.schema([("run", pa.int64()),
                          *((each.key.text, kinds.get(each.key.known.kind, pa.float64())) for each in self.plan.varied),
                          *((each.text, pa.float64()) for each in self.plan.measures),
                          ("refused", pa.string()), ("refused_at_s", pa.float64())])

    def keep(self, number: int, values: Mapping[str, np.ndarray], rows: Rows) -> None:
        """Writes a chunk that is done; whatever ends the program leaves it whole or not there."""
        first, count = self.range_of(number)
        reasons = [rows.reasons.get(place) for place in range(count)]
        columns = {"run": np.arange(first, first + count), **values,
                   **{measure.text: pa.array(found, mask=np.isnan(found))
                      for measure, found in zip(self.plan.measures, rows.measures, strict=True)},
                   "refused": [each and each.reason for each in reasons],
                   "refused_at_s": [each and each.at_s for each in reasons]}
        path = self._path_of(number)
        fresh = path.with_suffix(".fresh")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            pq.write_table(pa.table(columns, self.schema()), fresh, compression="zstd")
            fresh.replace(path)
        except OSError as error:
            raise BadInput(f"{path}: cannot be written ({reason_of(error)}); what is done is kept, choose another "
                           "place or make room") from None

    def finish(self) -> Path:
        """All chunks as one file, in the order of the runs: the same bytes however they were done."""
        schema = self.schema().with_metadata({METADATA: text_of(self.about).encode()})
        with whole_file(self.folder / RESULTS) as fresh, \
                pq.ParquetWriter(fresh, schema, compression="zstd") as writer:
            for number in range(self.chunks):
                writer.write_table(pq.read_table(self._path_of(number)).cast(schema), row_group_size=self.chunk)
        with suppress(OSError):
            shutil.rmtree(self.folder / PARTS)
        return self.folder / RESULTS


def text_of(about: Mapping[str, Any]) -> str:
    """The text of sweep.json."""
    return json.dumps(about, indent=1, ensure_ascii=False) + "\n"


def open_store(folder: Path, plan: Plan, chunk: int, versions: Mapping[str, str], command: str) -> Store:
    """A folder for a plan: a fresh one, or one that has begun with the same; BadInput for one with another plan."""
    file = folder / ABOUT
    about = {"command": command, "runs": plan.runs, "chunk": chunk, "digest": plan.digest, "versions": dict(versions),
             "plan": plan.as_json()}
    if not file.exists():
        if folder.is_dir() and any(folder.iterdir()):
            raise BadInput(f"-o {folder}: has other files in it; give a folder that is empty or not there yet")
        with whole_file(file) as fresh:
            fresh.write_text(text_of(about), encoding="utf-8", newline="")
        return Store(folder, plan, chunk, about)
    there = read_about(folder)
    if there["digest"] != plan.digest:
        raise BadInput(f"-o {folder}: has another sweep: {there['command']}; give another folder")
    if there["versions"] != dict(versions):
        changed = next(name for name in {**there["versions"], **versions}
                       if there["versions"].get(name) != versions.get(name))
        raise BadInput(f"-o {folder}: was begun with {changed} {there['versions'].get(changed)}, this is "
                       f"{versions.get(changed)}, whose numbers may differ; give another folder")
    return Store(folder, plan, int(there["chunk"]), there)


def read_about(folder: Path) -> dict[str, Any]:
    """What sweep.json tells; BadInput where it is not there or is none."""
    file = folder / ABOUT
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
        return {name: found[name] for name in ("command", "runs", "chunk", "digest", "versions", "plan")}
    except OSError as error:
        raise BadInput(f"{file}: cannot be read ({reason_of(error)}); give the folder of a sweep") from None
    except (ValueError, KeyError, TypeError):
        raise BadInput(f"{file}: is no description of a sweep; give the folder of a sweep") from None


def plan_in(folder: Path) -> tuple[Plan, dict[str, Any]]:
    """The plan of a folder."""
    about = read_about(folder)
    return plan_from(about["plan"]), about
