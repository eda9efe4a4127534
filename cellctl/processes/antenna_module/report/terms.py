"""What the predicted error of a plug is made of."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from cellctl.plot_style import ACCENT, style, to_svg

_WORDS = {
    "look_plug": "look at the plug",
    "look_socket": "looks at the socket",
    "approach": "approaches of the arm",
    "correction": "taught correction",
    "drift": "drift",
    "hand_eye": "hand-eye",
    "kinematics": "absolute error of the arm",
}


def error_terms(terms_um: Mapping[str, float]) -> str:
    """Standard deviation per axis by cause, µm, the largest on top; their squares add. SVG."""
    rows = sorted(terms_um.items(), key=lambda item: item[1])
    with style():
        figure = Figure(figsize=(7.2, 0.4 + 0.28 * len(rows)), layout="constrained")
        axes = figure.subplots()
        names = [_WORDS.get(name, name) for name, _ in rows]
        values = [value for _, value in rows]
        bars = axes.barh(names, values, color=ACCENT, height=0.6)
        axes.bar_label(bars, [f"{value:.1f}" for value in values], padding=3, fontsize=7)
        axes.set_xlabel("standard deviation per axis, µm")
        return to_svg(figure)
