#!/usr/bin/env python3
"""Figures from the reports of macula-bench: plot.py REPORT.json FOLDER.

sphere: figure_11.png (speed-up without foveation over samples a pixel), figure_12.png (time a frame
over the fovea's radius), primitives.png (time a frame over the number of primitives, from scenes
primitives-N) and table_1.txt (SSIM and FLIP at the fovea nearest 7.5 degrees).
Needs matplotlib (Debian: python3-matplotlib).
"""
import json
import pathlib
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)


def select(rows, **wanted):
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def values(rows, key):
    return sorted({row[key] for row in rows})


def figure_11(rows, folder):
    scenes = values(rows, "scene")
    figure, axes = plt.subplots(1, len(scenes), figsize=(4 * len(scenes), 3.2), squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        for method in ("full_best", "ipr_paper", "ipr"):
            line = sorted(select(rows, scene=scene, method=method, views=min(values(rows, "views"))),
                          key=lambda row: row["ssaa"])
            if line:
                axis.plot([r["ssaa"] for r in line], [r["speedup"] for r in line], "o-", label=method)
        axis.set(title=scene, xlabel="samples a pixel", ylabel="speed-up over full", ylim=(0, None))
        axis.legend()
    figure.tight_layout()
    figure.savefig(folder / "figure_11.png", dpi=120)


def figure_12(rows, folder):
    foveated = select(rows, method="fipr", views=min(values(rows, "views")))
    if not foveated:
        return
    scenes, samples = values(foveated, "scene"), values(foveated, "ssaa")
    figure, axes = plt.subplots(len(scenes), len(samples), squeeze=False,
                                figsize=(3.6 * len(samples), 3 * len(scenes)))
    for line, scene in zip(axes, scenes):
        for axis, ssaa in zip(line, samples):
            here = select(foveated, scene=scene, ssaa=ssaa)
            for refresh in values(here, "refresh"):
                points = sorted(select(here, refresh=refresh), key=lambda row: row["fovea_deg"])
                axis.plot([r["fovea_deg"] for r in points], [r["cpu_ms"] for r in points], "o-",
                          label=f"fipr, refresh {refresh:g}")
            for row in select(rows, scene=scene, ssaa=ssaa, method="full")[:1]:
                axis.axhline(row["cpu_ms"], color="black", label="full")
            axis.set(title=f"{scene}, {ssaa} samples", xlabel="fovea, degrees",
                     ylabel="CPU ms a frame", yscale="log")
            axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(folder / "figure_12.png", dpi=120)


def primitives(rows, folder):
    counted = [row for row in rows if re.fullmatch(r"primitives-\d+", row["scene"])]
    figure, axis = plt.subplots(figsize=(4.6, 3.4))
    for method in values(counted, "method"):
        for ssaa in values(counted, "ssaa"):
            line = sorted((int(row["scene"].split("-")[1]), row["cpu_ms"])
                          for row in select(counted, method=method, ssaa=ssaa))
            axis.plot(*zip(*line), "o-", label=f"{method}, {ssaa} samples")
    if counted:
        axis.set(xlabel="primitives", ylabel="CPU ms a frame", xscale="log", yscale="log")
        axis.legend(fontsize=7)
        figure.tight_layout()
        figure.savefig(folder / "primitives.png", dpi=120)


def table_1(rows, folder):
    radii = [r for r in values(rows, "fovea_deg") if r > 0]
    lines = [f"{'scene':12} {'method':11} {'fovea':>6} {'ssaa':>5} {'refresh':>8} {'ssim':>8} {'flip':>8}"]
    radius = min(radii, key=lambda r: abs(r - 7.5)) if radii else 0
    for row in rows:
        if row["method"] in ("full", "full_best") or row["fovea_deg"] not in (0, radius):
            continue
        lines.append(f"{row['scene']:12} {row['method']:11} {row['fovea_deg']:6g} {row['ssaa']:5} "
                     f"{row['refresh']:8g} {row['ssim']:8.5f} {row['flip']:8.5f}")
    (folder / "table_1.txt").write_text("\n".join(lines) + "\n")


PLOTS = {"sphere": (figure_11, figure_12, primitives, table_1)}


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    report = json.loads(pathlib.Path(sys.argv[1]).read_text())
    if report["experiment"] not in PLOTS:
        sys.exit(f"no plots for experiment {report['experiment']}; there are: {', '.join(PLOTS)}")
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for plot in PLOTS[report["experiment"]]:
        plot(report["rows"], folder)


if __name__ == "__main__":
    main()
