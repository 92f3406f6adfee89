"""summary.py FOLDER: the ratios of all benchmarks whose figures are in the folder, each beside that of the previous
run. For ratios whose name ends in "ratio" more is better, for the others less."""
import json
import pathlib
import sys


def rows(path):
    kept = json.loads(path.read_text())
    before = kept.get("before", {})
    for name, value in kept["figures"].items():
        if name.endswith("ratio") or "/" in name:
            then = before.get(name)
            yield (path.stem, name, f"{value:.2f}",
                   f"{then:.2f}" if then else "-", f"{value / then:.2f}" if then else "-")


def main(folder):
    lines = [("benchmark", "ratio", "now", "then", "now/then")]
    for path in sorted(pathlib.Path(folder).glob("bench_*.json")):
        lines += rows(path)
    if len(lines) == 1:
        sys.exit(f"{folder} holds no ratio: make bench measures them")
    width = [max(map(len, column)) for column in zip(*lines)]
    for line in lines:
        print("  ".join(cell.ljust(w) if i < 2 else cell.rjust(w)
                        for i, (cell, w) in enumerate(zip(line, width))))


main(sys.argv[1])
