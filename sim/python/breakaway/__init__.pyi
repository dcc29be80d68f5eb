from collections.abc import Iterable
from os import PathLike
from types import SimpleNamespace
from typing import Any, Literal

from numpy import float64, int8, int32
from numpy.typing import ArrayLike, NDArray

__version__: str

File = str | PathLike[str]
Numbers = NDArray[float64]

class InputError(ValueError):
    file: str
    key: str
    problem: str

class Simulation:
    figures: dict[str, Any]
    axes: dict[str, SimpleNamespace]
    time_s: Numbers
    q: Numbers
    v: Numbers

class Tuning:
    figures: dict[str, Any]
    text: str

class Identification:
    figures: dict[str, Any]
    text: str

class Attraction:
    figures: dict[str, Any]
    level: NDArray[int32]
    column: NDArray[int32]
    row: NDArray[int32]
    proved: NDArray[int8]

class Basin:
    figures: dict[str, Any]
    fates: NDArray[int8]
    times_s: Numbers
    coordinates: Numbers

def k3(
    position_m: ArrayLike, *, mass_kg: float, k1_N_per_m: float, k22_Ns_per_m: float, friction_lower_N: float
) -> tuple[Numbers, Numbers]: ...
def kick_table(file: File, distance_m: ArrayLike, *, axis: str = ...) -> SimpleNamespace: ...
def design(file: File) -> dict[str, Any]: ...
def simulate(file: File, *, trace: bool = ..., accuracy_m: float | None = ...) -> Simulation: ...
def study(
    file: File,
    *,
    starts: Iterable[tuple[float, float]] = ...,
    laws: int = ...,
    seed: int = ...,
    threads: int = ...,
    axis: str = ...,
) -> dict[str, Any]: ...
def tune(
    file: File,
    *,
    objective: Literal["time", "accuracy", "gentle"] = ...,
    laws: int = ...,
    seed: int = ...,
    threads: int = ...,
    axis: str = ...,
) -> Tuning: ...
def identify(
    file: File,
    *,
    record: File | None = ...,
    lowest_m: float | None = ...,
    highest_m: float | None = ...,
    duration_s: float = ...,
    axis: str = ...,
) -> Identification: ...
def attract(
    file: File, *, plane: tuple[int, int] = ..., window: float = ..., depth: int = ..., threads: int = ...
) -> Attraction: ...
def basin(
    file: File, *, points: int, window: float, plane: tuple[int, int] = ..., threads: int = ...
) -> Basin: ...
