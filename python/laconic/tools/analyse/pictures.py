"""All pictures of an analysis."""

from __future__ import annotations

from pathlib import Path

from laconic.pictures.plotting import save
from laconic.tools.analyse.findings import Study
from laconic.tools.analyse.pictures_free import path_picture, portrait_picture
from laconic.tools.analyse.pictures_steady import bifurcation_picture, driven_picture, eigenvalue_picture
from laconic.tools.analyse.pictures_traction import traction_picture

PICTURES = {
    "portrait": portrait_picture, "path": path_picture, "bifurcation": bifurcation_picture,
    "eigenvalues": eigenvalue_picture, "driven_portrait": driven_picture, "traction": traction_picture,
}


def draw(study: Study, folder: Path) -> list[Path]:
    """All pictures that the study has something for."""
    drawn = []
    for name, make in PICTURES.items():
        picture = make(study)
        if picture is not None:
            path = folder / f"{name}.png"
            save(picture, path)
            drawn.append(path)
    return drawn
