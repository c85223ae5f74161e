"""Figures of the shipped studies, and the sentences that answer their questions; both are functions of the table."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from seat_cosim.plotting import REPRODUCIBLE, save

Table = Mapping[str, Any]
"""Column to its values, see :func:`cosim.sweep.dataset.read_columns`."""

Numbers = npt.NDArray[np.float64]

_STYLE: Any = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.dpi": 150,
    "font.size": 9,
    "grid.alpha": 0.3,
    "legend.fontsize": 8,
    "legend.frameon": False,
    **REPRODUCIBLE,
}

_MAXIMUM = 1.2
"""SEAT at which the scale of maps ends."""


@dataclass(frozen=True)
class StudyFigure:
    """A figure and its answer.

    Attributes
    ----------
    fill
        Fills an empty figure from a table.
    answer
        Returns the answer as one sentence or two.
    size
        Width and height in inches.
    """

    fill: Callable[[Table, Figure], None]
    answer: Callable[[Table], str]
    size: tuple[float, float] = (7.0, 3.4)

    def draw(self, table: Table, folder: Path) -> list[Path]:
        """Draw the figure; the same table gives the same bytes.

        Parameters
        ----------
        table
            The table of the study.
        folder
            Where to.

        Returns
        -------
        list of Path
            The files.
        """
        paths = [folder / "figure.svg", folder / "figure.png"]
        with mpl.rc_context(_STYLE):
            figure = Figure(figsize=self.size, layout="constrained")
            self.fill(table, figure)
            save(figure, paths)
        return paths


def _laws(table: Table) -> dict[str, npt.NDArray[np.bool_]]:
    """Return each control law of a table, and which runs have it; the passive seat is one of them."""
    count = len(table["run"])
    controls, modes, gains = (table.get(name) or [""] * count for name in ("control", "mode", "gains"))
    names = [
        "passive seat" if control == "passive" else "robust" if mode == "robust" else gain
        for control, mode, gain in zip(controls, modes, gains, strict=True)
    ]
    return {name: np.array([each == name for each in names]) for name in dict.fromkeys(names)}


def _each(numbers: Mapping[str, str]) -> str:
    """List texts with the law that each is of."""
    return ", ".join(f"{text} ({law})" for law, text in numbers.items())


# ---- drivers' masses -------------------------------------------------------------------------------------------------


def _by_mass(table: Table) -> Iterator[tuple[str, Numbers, Numbers]]:
    """Yield each law with the masses, and its mean SEAT over the seeds, shape (masses, errors of the mass)."""
    masses, errors = (np.unique(table[name]) for name in ("driver_mass", "mass_error"))
    for law, runs in _laws(table).items():
        seat = np.array(
            [
                [table["seat"][runs & (table["driver_mass"] == m) & (table["mass_error"] == e)].mean() for e in errors]
                for m in masses
            ]
        )
        yield law, masses, seat


def _fill_masses(table: Table, figure: Figure) -> None:
    axis = figure.subplots()
    right = int(np.argmin(np.abs(np.unique(table["mass_error"]))))
    error = float(np.abs(table["mass_error"]).max())
    for law, masses, seat in _by_mass(table):
        (line,) = axis.plot(masses, seat[:, right], label=law)
        axis.fill_between(masses, seat.min(axis=1), seat.max(axis=1), alpha=0.2, color=line.get_color(), lw=0)
    axis.set(xlabel="driver's mass (kg)", ylabel="SEAT", ylim=(0.0, None))
    axis.set_title(f"lines: the controller has the right mass; bands: wrong by up to {error:g} kg", loc="left", size=9)
    axis.legend()


def _answer_masses(table: Table) -> str:
    right = int(np.argmin(np.abs(np.unique(table["mass_error"]))))
    ranges, changes = {}, {}
    for law, masses, seat in _by_mass(table):
        ranges[law] = f"{seat[:, right].min():.2f} to {seat[:, right].max():.2f}"
        changes[law] = f"{np.abs(seat - seat[:, [right]]).max():.2f}"
        low, high = masses[0], masses[-1]
    error = np.abs(table["mass_error"]).max()
    return (
        f"From {low:g} to {high:g} kg, SEAT is {_each(ranges)}; a mass that is wrong by up to {error:g} kg changes it "
        f"by at most {_each(changes)}."
    )


# ---- maps over two quantities ----------------------------------------------------------------------------------------


def _grids(table: Table, x: str, y: str) -> Iterator[tuple[str, Numbers, Numbers, Numbers]]:
    """Yield each law with the values of two variables, and its SEAT, shape (of y, of x)."""
    across, up = np.unique(table[x]), np.unique(table[y])
    for law, runs in _laws(table).items():
        order = np.lexsort((table[x][runs], table[y][runs]))
        yield law, across, up, table["seat"][runs][order].reshape(len(up), len(across))


def _fill_maps(table: Table, figure: Figure, x: tuple[str, str, float], y: tuple[str, str, float]) -> None:
    """Draw a map of SEAT for each law, with the line on which it is as good as the passive seat."""
    found = {law: rest for law, *rest in _grids(table, x[0], y[0])}
    passive = found.pop("passive seat")[2]
    axes = figure.subplots(1, len(found), sharey=True, squeeze=False)[0]
    for axis, (law, (across, up, seat)) in zip(axes, found.items(), strict=True):
        where = x[2] * across, y[2] * up
        image = axis.pcolormesh(*where, seat, vmin=0.0, vmax=_MAXIMUM, cmap="viridis_r", shading="nearest")
        if (seat > passive).any() and (seat < passive).any():
            axis.contour(*where, seat - passive, levels=[0.0], colors="red", linewidths=1.2)
        axis.set(xlabel=x[1], title=law)
        axis.grid(visible=False)
    axes[0].set_ylabel(y[1])
    figure.colorbar(image, ax=axes, label="SEAT; red: the passive seat's", extend="max")


def _fill_tolerance(table: Table, figure: Figure) -> None:
    x = ("seat.actuator.delay", "delay (ms)", 1e3)
    _fill_maps(table, figure, x, ("seat.actuator.time_constant", "lag (ms)", 1e3))


def _answer_tolerance(table: Table) -> str:
    found = {law: rest for law, *rest in _grids(table, "seat.actuator.delay", "seat.actuator.time_constant")}
    passive = found.pop("passive seat")[2]
    borne = {}
    for law, (delays, lags, seat) in found.items():
        worse = seat > passive
        late = 1e3 * (lags[:, None] + delays[None, :])
        largest = seat.max()
        borne[law] = f"up to {late[worse].min():.0f} ms" if worse.any() else f"all of the map, at most {largest:.2f}"
    return (
        f"The passive seat has a SEAT of {passive.flat[0]:.2f}; lag and delay together may reach, before a control law "
        f"is worse: {_each(borne)}."
    )


def _fill_mismatch(table: Table, figure: Figure) -> None:
    x = ("friction_share", "friction / nominal", 1.0)
    _fill_maps(table, figure, x, ("stiffness_share", "stiffness / nominal", 1.0))


def _answer_mismatch(table: Table) -> str:
    found = {law: rest for law, *rest in _grids(table, "friction_share", "stiffness_share")}
    passive = found.pop("passive seat")[2]
    near, worse = {}, {}
    for law, (friction, stiffness, seat) in found.items():
        inside = seat[np.abs(stiffness - 1.0) < 0.21][:, np.abs(friction - 1.0) < 0.51]
        near[law] = f"{inside.min():.2f} to {inside.max():.2f}"
        nominal = seat[np.abs(stiffness - 1.0).argmin()] > passive[np.abs(stiffness - 1.0).argmin()]
        worse[law] = f"{friction[nominal].min():g} times" if nominal.any() else f"not up to {friction[-1]:g} times"
    return (
        f"With friction within 50 % and stiffness within 20 % of the nominal seat, SEAT is {_each(near)}; the passive "
        f"seat is better from this friction on, with the nominal spring: {_each(worse)}."
    )


# ---- imperfections ---------------------------------------------------------------------------------------------------

_BINS = 10
"""Bins over which the conditional mean of a metric is taken."""

_NOT_IMPERFECT = ("run", "seat.sensor.seed")


def _variance_shares(table: Table, runs: npt.NDArray[np.bool_]) -> dict[str, float]:
    """Return the share of SEAT's variance that each variable alone explains: the first-order index of Sobol.

    It is the variance of the conditional mean in bins of equal counts, less what bins of independent samples have.
    """
    seat = table["seat"][runs]
    shares = {}
    for name, values in table.items():
        if name == "seat":
            break  # metrics follow the variables
        if isinstance(values, list) or name in _NOT_IMPERFECT:
            continue
        ordered = np.array_split(seat[np.argsort(values[runs], kind="stable")], _BINS)
        between = sum(len(each) * (each.mean() - seat.mean()) ** 2 for each in ordered) / len(seat)
        share, chance = between / seat.var(), (_BINS - 1) / (len(seat) - 1)
        shares[name] = max(0.0, (share - chance) / (1.0 - chance))
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


def _known(table: Table) -> dict[str, npt.NDArray[np.bool_]]:
    """Return each law, and its runs that have a SEAT."""
    return {law: runs & np.isfinite(table["seat"]) for law, runs in _laws(table).items()}


def _fill_imperfections(table: Table, figure: Figure) -> None:
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.1))
    laws = _known(table)
    for law, runs in laws.items():
        seat = np.sort(table["seat"][runs])
        left.plot(seat, 100.0 * np.arange(1, len(seat) + 1) / len(seat), label=law)
    left.set(xlabel="SEAT", ylabel="seats below (%)", xlim=(0.0, None), ylim=(0.0, 100.0))
    left.legend(loc="lower right")
    shares = {law: _variance_shares(table, runs) for law, runs in laws.items()}
    names = sorted(next(iter(shares.values())), key=lambda name: max(each[name] for each in shares.values()))
    height = 0.8 / len(shares)
    for number, (law, each) in enumerate(shares.items()):
        right.barh(
            np.arange(len(names)) - 0.4 + height * (number + 0.5), [100 * each[n] for n in names], height, label=law
        )
    right.set_yticks(range(len(names)), [name.removeprefix("seat.").replace("_", " ") for name in names])
    right.set_xlabel("share of the variance, alone (%)")


def _answer_imperfections(table: Table) -> str:
    parts = []
    for law, runs in _known(table).items():
        seat = table["seat"][runs]
        low, middle, high = np.quantile(seat, [0.05, 0.5, 0.95])
        (name, share), *_ = _variance_shares(table, runs).items()
        parts.append(
            f"{law}: SEAT {middle:.2f}, 90 % of the seats from {low:.2f} to {high:.2f}, "
            f"{100 * np.mean(seat < 1.0):.0f} % below 1; most of the spread comes from {name} ({100 * share:.0f} % of "
            "the variance alone)"
        )
    return f"{'; '.join(parts)}."


# ---- comfort against stroke ------------------------------------------------------------------------------------------


def pareto_front(first: Numbers, second: Numbers) -> npt.NDArray[np.intp]:
    """Return the points than which none is better in both quantities, which are to be small.

    Parameters
    ----------
    first, second
        Shape (points,).

    Returns
    -------
    ndarray
        Indices of the points, by ``first``.

    Examples
    --------
    >>> pareto_front(np.array([1.0, 2.0, 3.0, 2.5]), np.array([5.0, 3.0, 4.0, 1.0])).tolist()
    [0, 1, 3]
    """
    order = np.lexsort((second, first))
    lowest = np.minimum.accumulate(np.concatenate(([np.inf], second[order][:-1])))
    return order[second[order] < lowest]


def _presets(table: Table) -> dict[str, int]:
    """Return the run of each preset as it is."""
    is_plain = (table["spring_share"] == 1.0) & (table["damping"] == 0.0) & (table["observer_share"] == 1.0)
    return {table["gains"][i]: int(i) for i in np.flatnonzero(is_plain)}


def _fill_pareto(table: Table, figure: Figure) -> None:
    axis = figure.subplots()
    stroke, a_w = 1e3 * table["peak_deflection"], table["a_w"]
    front = pareto_front(stroke, a_w)
    axis.scatter(stroke, a_w, s=6, color="0.7", label="gains", linewidths=0)
    axis.plot(stroke[front], a_w[front], "o-", ms=3, lw=1.0, label="front")
    presets = _presets(table)
    for name, i in presets.items():
        axis.plot(stroke[i], a_w[i], "*", ms=10, label=name)
    axis.set(xlabel="largest deflection (mm)", ylabel="a_w of the driver (m/s²)")
    # around the front and the presets: gains whose loop is unstable reach metres
    shown = [*front, *presets.values()]
    left, right, top = 0.9 * stroke[front].min(), 1.6 * stroke[shown].max(), 1.3 * a_w[shown].max()
    axis.set(xlim=(left, right), ylim=(0.0, top))
    beyond = int(np.sum(~((stroke <= right) & (a_w <= top))))
    axis.legend(title=f"{beyond} of {len(stroke)} gains beyond" if beyond else None)


def _answer_pareto(table: Table) -> str:
    stroke, a_w = 1e3 * table["peak_deflection"], table["a_w"]
    front = pareto_front(stroke, a_w)
    better = {}
    for name, i in _presets(table).items():
        best = a_w[front][stroke[front] <= stroke[i]].min()
        better[name] = f"{100.0 * (1.0 - best / a_w[i]):.0f} %"
    first, last = front[0], front[-1]
    rate = table["damping"]
    return (
        f"On the front, a_w falls from {a_w[first]:.2f} m/s² with {stroke[first]:.0f} mm of stroke to {a_w[last]:.2f} "
        f"m/s² with {stroke[last]:.0f} mm, while the change of the rate gains goes from {rate[first]:g} to "
        f"{rate[last]:g} N·s/m; with the stroke of a preset, a_w could be lower by {_each(better)}."
    )


FIGURES = {
    "masses": StudyFigure(_fill_masses, _answer_masses),
    "tolerance": StudyFigure(_fill_tolerance, _answer_tolerance),
    "mismatch": StudyFigure(_fill_mismatch, _answer_mismatch),
    "imperfections": StudyFigure(_fill_imperfections, _answer_imperfections, (7.5, 4.0)),
    "pareto": StudyFigure(_fill_pareto, _answer_pareto, (6.0, 3.6)),
}
"""Name of a figure to what draws it."""
