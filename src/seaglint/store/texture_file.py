"""Textures on disk: a JSON file with the model, the data that it was fitted to, and the quality of the fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject
from seaglint.store.outputs import read_json, refuse_existing, write_json
from seaglint.textures.autobinomial import KIND as AUTOBINOMIAL
from seaglint.textures.autobinomial_texture import AutobinomialTexture
from seaglint.textures.gaussian_texture import KIND as GAUSS_MARKOV
from seaglint.textures.gaussian_texture import GaussianTexture
from seaglint.version import __version__

FORMAT: Final = "seaglint-texture"
VERSION: Final = 2  #: Version of new files: 2 since textures have noise of their own.

READ: Final = (1, 2)  #: Versions that are read.

Texture = GaussianTexture | AutobinomialTexture


@dataclass(frozen=True)
class StoredTexture:
    """Texture with its data and the quality of its fit."""

    texture: Texture  #: GaussianTexture or AutobinomialTexture.
    source: Mapping[str, Any] = field(default_factory=dict)  #: File, region, size, units, frame rate of the data.
    fit: Mapping[str, Any] = field(default_factory=dict)  #: Errors of the parameters and criteria.
    #: Agreement of samples and data (``seaglint.textures.quality.Comparison.as_dict``, and held-out data).
    quality: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()  #: Sentences on the fit.

    @property
    def units(self) -> str:
        """Return the units of the values; empty where they are not known."""
        return str(self.source.get("units") or "")

    @property
    def frame_rate(self) -> float | None:
        """Return the frames per second of the data [Hz]; None for a picture, or where it is not known."""
        rate = self.source.get("frame_rate_hz")
        return None if rate is None else float(rate)

    def to_dict(self) -> JsonObject:
        """Return the content of the file."""
        return {
            "format": FORMAT,
            "version": VERSION,
            "seaglint": __version__,
            "model": self.texture.to_dict(),
            "source": dict(self.source),
            "fit": dict(self.fit),
            "quality": dict(self.quality),
            "notes": list(self.notes),
        }


def write_texture(stored: StoredTexture, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write a texture's file.

    Raises
    ------
    DataError
        The file exists, its folder does not, or its name does not end in .json.
    StorageError
        No room or no rights.
    """
    output = refuse_existing(check_name(path), overwrite=overwrite)
    write_json(stored.to_dict(), output, indent=1)
    return output


def check_name(path: str | Path) -> Path:
    """Return the path of a texture's file; refuse it where it does not end in .json."""
    if Path(path).suffix.lower() != ".json":
        raise DataError(f"{path}: a texture is a JSON file; give a name that ends in .json")
    return Path(path)


def read_texture(path: str | Path) -> StoredTexture:
    """Read a texture's file.

    Raises
    ------
    DataError
        Nothing there, no texture, one of another version, or one that is not whole.
    """
    path = Path(path)
    content = read_json(path, "give a file of 'seaglint texture fit'")
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise DataError(f"{path}: is no texture; give a file of 'seaglint texture fit'")
    if content.get("version") not in READ:
        raise DataError(
            f"{path}: has version {content.get('version')!r}, this seaglint ({__version__}) reads versions up to {VERSION}; fit it anew or "
            f"take the seaglint that wrote it ({content.get('seaglint', 'not said')})"
        )
    try:
        notes = tuple(map(str, content["notes"]))
        return StoredTexture(_model(content["model"]), content["source"], content["fit"], content["quality"], notes)
    except KeyError as error:
        raise DataError(f"{path}: {error} is missing; the file is damaged, fit it anew") from error
    except (TypeError, AttributeError, ValueError, DataError, DomainError) as error:
        raise DataError(f"{path}: {error}; the file is damaged, fit it anew") from error


def _model(table: Mapping[str, Any]) -> Texture:
    if table["kind"] == GAUSS_MARKOV:
        return GaussianTexture.from_dict(table)
    if table["kind"] == AUTOBINOMIAL:
        return AutobinomialTexture.from_dict(table)
    raise DataError(f"model.kind = {table['kind']!r}; allowed are {GAUSS_MARKOV} and {AUTOBINOMIAL}")
