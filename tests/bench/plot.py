#!/usr/bin/env python3
"""Figures from the reports of macula-bench: plot.py REPORT.json FOLDER.

sphere: figure_11.png (speed-up without foveation over samples a pixel), figure_12.png (time a frame
over the fovea's radius), primitives.png (time a frame over the number of primitives, from scenes
primitives-N) and table_1.txt (SSIM and FLIP at the fovea nearest 7.5 degrees).
culling: vpl_contrast.svg (contributions with and without BLSO), limitation.svg (log-polar space and interleaving,
with and without), error_over_kept.svg, error_over_time.svg and equal_time.txt (each baseline's error, read off its own
curve at the time that flc, flc_rays and flc_fast took, over theirs).
lightcuts: error_over_time.png (every method's error in F25 and outside over time), figure_8.png and table_4.txt (error and
time over alpha, from --alphas) and figure_9.png (stages of a frame beside the baseline of about equal error); figures 5, 6
and 7 are pictures: --pictures writes errors.png, maps.png, alphas.png and, of what the stages make, stages.png.
tradeoff: KERNEL.svg (what each knob buys: error as the eye weighs it over time, both over the kernel's own
settings, means of the scenes; the pictures beside the kernels' pages).
Needs matplotlib (Debian: python3-matplotlib).
"""
import json
import math
import pathlib
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)
from matplotlib import ticker  # noqa: E402


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


def culling_curves(rows, folder):
    """RMSE in the fovea over lights kept and over time, a column a scene and motion."""
    plt.rcParams["svg.fonttype"] = "none"
    cases = sorted({(row["scene"], row["motion"]) for row in rows})
    for name, key, unit in (("error_over_kept", "asked_for", "virtual lights kept"),
                            ("error_over_time", "cpu_ms", "CPU ms a frame")):
        figure, axes = plt.subplots(2, len(cases), figsize=(3.8 * len(cases), 6), squeeze=False)
        for column, (scene, motion) in enumerate(cases):
            here = select(rows, scene=scene, motion=motion)
            for line, region in enumerate(("rmse_in150", "rmse_out150")):
                axis = axes[line][column]
                for method in values(here, "method"):
                    points = sorted((row[key], row[region]) for row in select(here, method=method))
                    if method == "all_vpls":
                        axis.axhline(points[0][1], color="black", label=method)
                    else:
                        axis.plot(*zip(*points), "o-", label=method)
                axis.set(title=f"{scene}, {motion}", xlabel=unit, ylabel=region, xscale="log",
                         ylim=(0, None))
                if key == "asked_for":
                    asked = [kept for kept in values(here, key) if kept > 0]  # 0: all
                    axis.set_xticks(asked, asked, fontsize=7)
                    axis.minorticks_off()
        axes[0][0].legend(fontsize=6)
        figure.tight_layout()
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None})


def culling_switches(rows, folder):
    """The paper's figures VPLContrast and Limitation: flc beside itself with one of its parts off."""
    plt.rcParams["svg.fonttype"] = "none"
    figures = {"vpl_contrast": ("flc", "flc_no_blso"),
               "limitation": ("flc", "flc_no_logpolar", "flc_no_classes")}
    for name, methods in figures.items():
        kept = [row for row in rows if row["method"] in methods]
        if {row["method"] for row in kept} != set(methods):
            continue
        asked = values(kept, "asked_for")
        if name == "vpl_contrast":  # where nothing is culled they are one
            asked = [k for k in asked if 2 * k <= min(values(kept, "vpls"))] or asked
        most = max(asked)
        cases = sorted({(row["scene"], row["motion"]) for row in kept})
        figure, axes = plt.subplots(1, 3, figsize=(7 + 2 * len(cases), 3.8))
        for axis, (key, label) in zip(axes, (("rmse_in150", "RMSE in the fovea"),
                                             ("rmse_out150", "RMSE outside"), ("cpu_ms", "CPU ms a frame"))):
            for index, method in enumerate(methods):
                found = {(row["scene"], row["motion"]): row[key]
                         for row in select(kept, method=method, asked_for=most)}
                places = [place + (index - (len(methods) - 1) / 2) * 0.8 / len(methods)
                          for place, case in enumerate(cases) if case in found]
                axis.bar(places, [found[case] for case in cases if case in found], 0.8 / len(methods), label=method)
            axis.set_xticks(range(len(cases)), [f"{scene}\n{motion}" for scene, motion in cases], fontsize=7)
            axis.set_title(label, fontsize=9)
        axes[2].set_yscale("log")
        figure.suptitle(f"K = {most}", fontsize=9)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncol=len(methods), fontsize=7)
        figure.tight_layout(rect=(0, 0.06, 1, 1))
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None})


def read_off(points, at):
    """A curve's value: straight in the logarithms, beyond its ends as of variance, 1 / time."""
    points = sorted(points)
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x0 <= at <= x1 and x1 > x0 and min(y0, y1) > 0:
            return y0 * (at / x0) ** (math.log(y1 / y0) / math.log(x1 / x0))
    x, y = points[0] if at < points[0][0] else points[-1]
    return y * math.sqrt(x / at)


def equal_time(rows, folder):
    lines = [f"{'scene':16} {'motion':8} {'method':9} {'kept':>5} {'against':8} {'in':>6} {'out':>6}"]
    gains = {}
    for row in rows:
        if row["method"] not in ("flc", "flc_rays", "flc_fast"):
            continue
        for against in ("fir", "power"):
            curve = select(rows, scene=row["scene"], motion=row["motion"], method=against)
            if not curve:
                continue
            gain = [read_off([(r["cpu_ms"], r[region]) for r in curve], row["cpu_ms"]) /
                    max(row[region], 1e-9) for region in ("rmse_in150", "rmse_out150")]
            gains.setdefault((row["method"], against), []).append(gain)
            lines.append(f"{row['scene']:16} {row['motion']:8} {row['method']:9} {row['asked_for']:5} "
                         f"{against:8} {gain[0]:6.2f} {gain[1]:6.2f}")
    for (method, against), found in gains.items():
        means = [math.exp(sum(math.log(max(g[k], 1e-9)) for g in found) / len(found)) for k in (0, 1)]
        lines.append(f"{'geometric mean':25} {method:9} {'':5} {against:8} {means[0]:6.2f} {means[1]:6.2f}")
    (folder / "equal_time.txt").write_text("\n".join(lines) + "\n")


def lightcuts_curves(rows, folder):
    """Baselines as curves over their samples, other methods as points; a column a scene and gaze."""
    cases = sorted({(row["scene"], row["gaze"]) for row in rows})
    default = next((row["alpha"] for row in rows if row["method"] == "sl"), None)
    figure, axes = plt.subplots(2, len(cases), figsize=(3.8 * len(cases), 6), squeeze=False)
    for column, (scene, gaze) in enumerate(cases):
        here = [row for row in select(rows, scene=scene, gaze=gaze)
                if default is None or row["alpha"] == default]
        for axis, region in zip(axes[:, column], ("mse_f25", "mse_out25")):
            for method in values(here, "method"):
                points = sorted((row["cpu_ms"], row[region]) for row in select(here, method=method)
                                if row[region] > 0)
                if points:
                    axis.plot(*zip(*points), "o-", label=method)
            axis.set(title=f"{scene}, gaze {gaze}", xlabel="CPU ms a frame", ylabel=region,
                     xscale="log", yscale="log")
    axes[0][0].legend(fontsize=6)
    figure.tight_layout()
    figure.savefig(folder / "error_over_time.png", dpi=110)


def lightcuts_alphas(rows, folder):
    swept = select(rows, method="paper")
    alphas = values(swept, "alpha")
    if len(alphas) < 2:
        return
    cases = sorted({(row["scene"], row["gaze"]) for row in swept})
    figure, axes = plt.subplots(1, 2, figsize=(8, 3.4))
    lines = [f"{'CPU ms':24}" + "".join(f"{alpha:9g}" for alpha in alphas)]
    for scene, gaze in cases:
        line = sorted(select(swept, scene=scene, gaze=gaze), key=lambda row: row["alpha"])
        lines.append(f"{scene + ', ' + gaze:24}" + "".join(f"{row['cpu_ms']:9.0f}" for row in line))
        for axis, region in zip(axes, ("mse_f25", "mse_out25")):
            axis.plot([r["alpha"] for r in line], [r[region] for r in line], "o-", label=scene)
            axis.set(xlabel="alpha", ylabel=region, xscale="log", yscale="log")
    axes[0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(folder / "figure_8.png", dpi=110)
    (folder / "table_4.txt").write_text("\n".join(lines) + "\n")


STAGES = ("tree_ms", "fpsm_ms", "cut_ms", "sample_ms", "shade_ms", "glossy_ms", "denoise_ms")


def lightcuts_stages(rows, folder):
    """Figure 9: where a frame's time goes, beside the baseline that errs about as much within 25 degrees."""
    cases = sorted({(row["scene"], row["gaze"]) for row in rows})
    default = next((row["alpha"] for row in rows if row["method"] == "sl"), None)
    figure, axes = plt.subplots(1, len(cases), figsize=(4.2 * len(cases), 3.4), squeeze=False)
    for axis, (scene, gaze) in zip(axes[0], cases):
        here = select(rows, scene=scene, gaze=gaze)
        bars = []
        for method in ("paper", "ours"):
            for row in [r for r in here if r["method"] == method and r["alpha"] == default]:
                baseline = [r for r in select(here, method=row["against"]) if r["mse_f25"] > 0]
                if row["mse_f25"] > 0 and baseline:
                    like = min(baseline, key=lambda r: abs(math.log(r["mse_f25"] / row["mse_f25"])))
                    bars.append((f"{like['method']} {like['mean_lspp']:.0f}", like))
                bars.append((method, row))
        under = [0.0] * len(bars)
        for stage in STAGES:
            heights = [max(row.get(stage) or 0.0, 0.0) for _, row in bars]
            axis.bar(range(len(bars)), heights, bottom=under, label=stage.removesuffix("_ms"))
            under = [low + height for low, height in zip(under, heights)]
        axis.set_xticks(range(len(bars)), [name for name, _ in bars], fontsize=7)
        axis.set(title=f"{scene}, gaze {gaze}", ylabel="CPU ms a frame")
    axes[0][0].legend(fontsize=6)
    figure.tight_layout()
    figure.savefig(folder / "figure_9.png", dpi=110)


def over_default(rows):
    """By configuration: time and error over the default's, geometric means of the scenes that have both."""
    default = {row["scene"]: row for row in rows if row["config"] == "scale=1"}
    points = {}
    for config in {row["config"] for row in rows}:
        here = [row for row in select(rows, config=config) if row["scene"] in default and row["rmse_ew"]]
        if len(here) < len(default):
            continue
        points[config] = tuple(
            math.exp(sum(math.log(row[key] / default[row["scene"]][key]) for row in here) / len(here))
            for key in ("cpu_ms", "rmse_ew"))
    return points


def knob_lines(points):
    """Knobs that were turned one at a time: name -> [(value, point)], the default's value left out."""
    lines = {}
    for config, point in points.items():
        words = config.split()
        if len(words) == 1:
            name, value = words[0].split("=")
            lines.setdefault(name, []).append((value, point))
    return {name: line for name, line in lines.items() if name not in ("grid", "jpeg", "depth")}


def front(points):
    """Those that no other beats in both, by rising time."""
    best, kept = math.inf, []
    for point in sorted(points):
        if point[1] < best:
            best, kept = point[1], kept + [point]
    return kept


def matters(point):
    return any(abs(math.log(value)) > 0.08 for value in point)


def tradeoff_curves(rows, folder):
    plt.rcParams["svg.fonttype"] = "none"
    for kernel in values(rows, "kernel"):
        here = select(rows, kernel=kernel)
        figure, axis = plt.subplots(figsize=(9, 5.5))
        points = over_default(here)
        uniform = [point for config, point in points.items() if select(here, config=config)[0]["uniform"]]
        axis.plot(*zip(*front(uniform)), "--", color="0.6", label="whole pictures, uniform")
        foveated = [(config, point) for config, point in points.items()
                    if not select(here, config=config)[0]["uniform"]]
        axis.plot(*zip(*front(point for _, point in foveated)), "-", color="black", linewidth=1, label="front")
        axis.plot(*zip(*(point for _, point in foveated)), ".", color="0.8", zorder=0)
        markers = "os^vDPX*<>ph"
        lines = sorted(knob_lines(dict(foveated)).items())
        turned = [(name, line) for name, line in lines if any(matters(point) for _, point in line)]
        for index, (name, line) in enumerate(turned):
            line = sorted(line + [("", (1.0, 1.0))], key=lambda entry: entry[1])
            axis.plot(*zip(*(point for _, point in line)), markers[index % len(markers)] + ":", markersize=4,
                      color=f"C{index % 10}", label=name, linewidth=0.8)
            for value, point in line:
                if matters(point):
                    axis.annotate(value, point, fontsize=6, xytext=(3, 3), textcoords="offset points")
        still = [name for name, _ in lines if name not in dict(turned)]
        if still:
            axis.text(0.02, 0.02, "less than 8 % in both: " + ", ".join(still), fontsize=7,
                      transform=axis.transAxes)
        axis.plot(1, 1, "k+", markersize=12, label="as it is")
        axis.set(xscale="log", yscale="log", xlabel="CPU time of a frame over the default's",
                 ylabel="error as the eye weighs it, over the default's", title=kernel)
        for which in (axis.xaxis, axis.yaxis):
            which.set_major_formatter(ticker.FormatStrFormatter("%g"))
            which.set_minor_formatter(ticker.FormatStrFormatter("%g"))
            which.set_minor_locator(ticker.LogLocator(subs=(2, 3, 5, 7)))
        axis.tick_params(which="both", labelsize=7)
        axis.legend(fontsize=7, ncol=2)
        figure.tight_layout()
        figure.savefig(folder / f"{kernel}.svg", metadata={"Date": None})


PLOTS = {"tradeoff": (tradeoff_curves,), "culling": (culling_switches, culling_curves, equal_time), "lightcuts": (lightcuts_curves, lightcuts_alphas, lightcuts_stages),
         "sphere": (figure_11, figure_12, primitives, table_1)}


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
