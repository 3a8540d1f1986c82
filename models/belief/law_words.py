"""A law as an equation, in Unicode and in LaTeX, and what it may mean."""

from __future__ import annotations

import math
from collections.abc import Sequence

from realitygap.embedded_sim.laws import Atom, Channel, Form
from realitygap.models.belief.law_values import SPEEDS

UNIT: dict[Channel, str] = {"turn": "rad/s", "bend": "rad/m"}
"""Of an amplitude, where it has one; of the others it is a share."""
NO_LENGTH = 5e-4
"""m: a place told to three digits is 0 below it."""
UNKNOWN = "mechanism unknown"
"""What is said where nothing is known to look like it."""

_LEFT = {
    "left": ("ω_left", r"\omega_\mathrm{left}"),
    "right": ("ω_right", r"\omega_\mathrm{right}"),
    "both": ("ω_left, ω_right", r"\omega_\mathrm{left}, \omega_\mathrm{right}"),
    "speed": ("v", "v"),
    "turning": ("Ω", r"\Omega"),
    "turn": ("Ω", r"\Omega"),
    "bend": ("Ω", r"\Omega"),
    "aside": ("v_aside", r"v_\mathrm{aside}"),
}
"""What changes: wheels' speeds, forward speed, turn rate, speed to the left."""
_RIGHT = {"bend": ("|v|", "|v|"), "aside": ("v", "v")}
"""What an amplitude is of, where it does not multiply what changes."""
_SYMBOL = {
    "wheel_speed": ("ω", r"\omega", "rad/s"),
    "speed": ("v", "v", "m/s"),
    "turn": ("Ω", r"\Omega", "rad/s"),
    "heading": ("ψ", r"\psi", ""),
    "left_angle": ("θ_left", r"\theta_\mathrm{left}", ""),
    "right_angle": ("θ_right", r"\theta_\mathrm{right}", ""),
    "radius": ("r", "r", "m"),
    "place": ("x", "x", "m"),
    "wall": ("d_wall", r"d_\mathrm{wall}", "m"),
    "gap": ("d_robot", r"d_\mathrm{robot}", "m"),
    "time": ("t", "t", "s"),
    "since": ("t_start", r"t_\mathrm{start}", "s"),
}
SYMBOLS = {
    "ω": "a wheel's own speed",
    "v": "speed ahead",
    "Ω": "turn rate",
    "ψ": "heading",
    "θ": "a wheel's angle",
    "r": "distance from the middle",
    "d_wall": "distance to the wall",
    "d_robot": "distance to the next robot's body",
    "t": "time since the run began",
    "t_start": "time since it was told to leave rest",
}
"""In words."""


def equation(
    channel: Channel, atoms: Sequence[Atom], amplitude: float | None = None, *, latex: bool = False
) -> str:
    """A law in one line.

    Args:
        channel: What changes.
        atoms: What it follows.
        amplitude: None: it is called a.
        latex: For LaTeX's mathematics, else Unicode.
    """
    style = 1 if latex else 0
    dot, plus = (r" \, ", r" \mathrel{+}= ") if latex else (" · ", " += ")
    size = "a" if amplitude is None else f"{abs(amplitude):.3g}"
    unit = UNIT.get(channel, "")
    if unit and amplitude is not None:
        size += rf"\,\mathrm{{{unit}}}" if latex else f" {unit}"
    terms = [size, *(_atom(one, style) for one in atoms if one.form != "always")]
    if channel in _RIGHT:
        terms.append(_RIGHT[channel][style])
    joined, less = dot.join(terms), amplitude is not None and amplitude < 0.0
    minus = "-" if latex else "−"
    if channel in ("left", "right", "both", "speed", "turning"):
        times = r" \mathrel{\times}= " if latex else " ×= "
        return f"{_LEFT[channel][style]}{times}1 {minus if less else '+'} {joined}"
    return f"{_LEFT[channel][style]}{plus}{minus if less else ''}{joined}"


def _number(value: float, unit: str, style: int) -> str:
    text = "0" if unit == "m" and abs(value) < NO_LENGTH else f"{value:.3g}"
    if not unit:
        return text
    return rf"{text}\,\mathrm{{{unit}}}" if style else f"{text} {unit}"


def _along(direction: float) -> str:
    """Distance along a direction."""
    c, s = round(math.cos(direction), 2), round(math.sin(direction), 2)
    sizes = ("" if abs(v) == 1.0 else f"{abs(v):.2f} " for v in (c, s))
    parts = [f"{size}{name}" for size, name in zip(sizes, "xy", strict=True)]
    if c == 0.0:
        return parts[1] if s > 0.0 else f"-{parts[1]}"
    first = parts[0] if c > 0.0 else f"-{parts[0]}"
    return first if s == 0.0 else f"{first} {'+' if s > 0.0 else '-'} {parts[1]}"


def _atom(atom: Atom, style: int) -> str:
    symbol, unit = _SYMBOL[atom.of][style], _SYMBOL[atom.of][2]
    p, form = atom.parameters, atom.form
    exp, cos = (r"\exp", r"\cos") if style else ("exp", "cos")
    less, more = ("<", ">")
    if form == "power":
        size = f"|{symbol}|" if atom.of in SPEEDS else symbol
        base = f"{size} / {_number(p[0], unit, style)}"
        if round(p[1], 2) == 1.0:
            return f"({base})"
        return f"({base})^{{{p[1]:.2f}}}" if style else f"({base})^{p[1]:.2f}"
    if form == "sign":
        return rf"\operatorname{{sign}}({symbol})" if style else f"sign({symbol})"
    if form == "cosine":
        if atom.of == "time":
            rate = f"{2.0 * math.pi / abs(p[0]):.3g}"
            inner = rf"2\pi t / {rate}\,\mathrm{{s}}" if style else f"2π t / {rate} s"
        else:
            inner = symbol if round(p[0], 3) == 1.0 else f"{p[0]:.4g} {symbol}"
        phase = math.remainder(p[1], math.tau)
        sign = "+" if phase < 0.0 else ("-" if style else "−")
        own = atom.of in ("left_angle", "right_angle")
        last = r" - \varphi" if style else " − φ"
        return f"{cos}({inner}{last if own else f' {sign} {abs(phase):.3g}'})"
    if form in ("slope", "half"):
        direction = p[1] if form == "slope" else p[0]
        along = _along(direction)
        if form == "slope":
            return f"({along}) / {_number(p[0], unit, style)}"
        return f"[{along} {more} {_number(p[1], unit, style)}]"
    if form == "disc":
        x, y = (f"{'-' if v >= 0.0 else '+'} {abs(v):.3g}" for v in p[:2])
        return (
            f"[(x {x})² + (y {y})² {less} ({_number(p[2], unit, 0)})²]"
            if not style
            else (rf"[(x {x})^2 + (y {y})^2 {less} ({_number(p[2], unit, 1)})^2]")
        )
    if form == "below":
        size = f"|{symbol}|" if atom.of in SPEEDS else symbol
        return f"[{size} {less} {_number(p[0], unit, style)}]"
    if form == "over":
        most = r"\max" if style else "max"
        return f"{most}(1 {'-' if style else '−'} {_number(p[0], unit, style)} / |{symbol}|, 0)"
    if form == "fade":
        return f"{exp}(-{symbol} / {_number(p[0], unit, style)})"
    return f"f({'x, y' if atom.of == 'place' else symbol})"


def size_in_words(channel: Channel, value: float, low: float, high: float) -> str:
    """An amplitude with its interval."""
    if channel in UNIT:
        return f"{value:.3g} {UNIT[channel]} ({low:.3g} to {high:.3g})"
    return f"{100 * value:.2g} % ({100 * low:.2g} to {100 * high:.2g} %)"


_WHAT = {
    "left": "the left wheel turns",
    "right": "the right wheel turns",
    "both": "both wheels turn",
    "speed": "it drives",
    "turning": "it turns",
    "turn": "it turns",
    "bend": "its path bends",
    "aside": "it slides",
}


def reading(channel: Channel, atoms: Sequence[Atom], amplitude: float, wheel_radius: float) -> str:
    """What a law may mean, in a sentence.

    Args:
        channel: What changes.
        atoms: What it follows; none: a shape that cannot be told.
        amplitude: Of one robot.
        wheel_radius: m.
    """
    if not atoms:
        return UNKNOWN
    means = _mechanism(channel, atoms[0], amplitude, wheel_radius)
    return f"{_where(atoms[0])}: {_faster(channel, amplitude, atoms[0])}; {means}"


def _faster(channel: Channel, amplitude: float, atom: Atom) -> str:
    what = _WHAT[channel]
    if atom.form in ("cosine", "sign", "slope", "curve"):
        return f"{what} more and less"
    if channel in ("left", "right", "both", "speed", "turning"):
        return f"{what} {'faster' if amplitude > 0.0 else 'slower'}"
    return f"{what} to the {'left' if amplitude > 0.0 else 'right'}"


def _where(atom: Atom) -> str:
    p = atom.parameters
    name = {
        "wheel_speed": "with that wheel's speed",
        "speed": "with its speed",
        "turn": "with the side to which it turns",
        "heading": "with its heading",
        "radius": "with its distance from the middle",
        "place": "with its place",
        "wall": "near the wall",
        "gap": "near another robot",
        "time": "with time",
        "since": "after leaving rest",
    }
    if atom.form == "always":
        return "always"
    if atom.form == "over":
        return f"beyond {_number(p[0], _SYMBOL[atom.of][2], 0)} of a wheel"
    if atom.form == "curve":
        return f"{name[atom.of]}, in a shape that was not found"
    if atom.of in ("left_angle", "right_angle"):
        times = {1: "once", 2: "twice"}.get(round(p[0]), f"{round(p[0])} times")
        return f"{times} per turn of the {atom.of.partition('_')[0]} wheel"
    if atom.of == "heading":
        east = math.degrees(math.remainder(p[1], math.tau) / p[0])
        times = {1: "once", 2: "twice"}.get(round(p[0]), f"{round(p[0])} times")
        return f"{times} per turn of the robot, most when it faces {east:.0f} degrees"
    if atom.form == "disc":
        return f"within {p[2]:.3g} m of ({p[0]:.3g}, {p[1]:.3g})"
    if atom.form == "half":
        return f"where {_along(p[0])} > {_number(p[1], 'm', 0)}"
    if atom.form == "below":
        if atom.of == "wheel_speed":
            return f"below {_number(p[0], _SYMBOL[atom.of][2], 0)} of a wheel"
        return f"{name[atom.of]}, within {1e3 * p[0]:.0f} mm"
    if atom.form == "cosine":
        return f"with a period of {2.0 * math.pi / abs(p[0]):.3g} s"
    return name[atom.of]


_CONSTANT: dict[tuple[Channel, Form], str] = {
    ("left", "always"): "as a wheel of another size does",
    ("right", "always"): "as a wheel of another size does",
    ("both", "always"): "as wheels of another size do, or a tracker of another metre shows it",
    ("speed", "always"): "as wheels of another size do, or a tracker of another metre shows it",
    ("bend", "sign"): "as a robot does whose wheels differ in size",
    ("turning", "always"): "as wheels do that are another distance apart",
    ("aside", "always"): "as a tracker shows it whose marker is turned",
}


def _mechanism(channel: Channel, atom: Atom, amplitude: float, wheel_radius: float) -> str:
    wheel = channel in ("left", "right")
    if atom.form in ("always", "sign") and (channel, atom.form) in _CONSTANT:
        return _CONSTANT[channel, atom.form]
    if atom.form in ("over", "below") and atom.of == "wheel_speed" and amplitude < 0.0:
        return "as of a motor at its limit" if atom.form == "over" else "as of a motor that sticks"
    if wheel and atom.of == f"{channel}_angle" and round(atom.parameters[0]) == 1:
        return f"as a wheel does that is eccentric by {1e3 * abs(amplitude) * wheel_radius:.2g} mm"
    if wheel and atom.of == f"{channel}_angle":
        return "as a wheel, tyre or gear does that is not round"
    if channel in ("turn", "bend") and atom.of == "heading" and round(atom.parameters[0]) == 1:
        return "as a magnet or a cable pulls, or a compass in the loop"
    if channel in ("both", "speed") and atom.form in ("half", "disc"):
        return "as on another floor, such as a carpet"
    if channel == "speed" and atom.of == "radius" and atom.form == "power":
        return "as a tracker's lens shows it"
    if channel in ("left", "right", "both", "speed") and atom.form == "power":
        if atom.of in ("wheel_speed", "speed") and amplitude < 0.0:
            return "as by slip, or a motor short of voltage"
        if atom.of == "time" and amplitude < 0.0:
            return "as of a battery that runs down"
    if channel in ("both", "speed") and atom.of == "gap":
        return "as if it felt the other robot"
    return UNKNOWN
