"""Runs the code of reports/reading.ipynb, cell by cell in one namespace, as a notebook's kernel would.

Argument: the repository's root. The working directory has the run in reports/smoke. Prints what each cell ends with.
"""

import ast
import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

pictures = []
plt.show = lambda: pictures.append(plt.gcf().get_axes()) or plt.close()

notebook = json.loads((Path(sys.argv[1]) / "reports/reading.ipynb").read_text())
namespace = {}
for number, cell in enumerate(notebook["cells"]):
    if cell["cell_type"] != "code":
        continue
    assert not cell["outputs"] and cell["execution_count"] is None, f"cell {number} is stored with its outputs"
    body = ast.parse("".join(cell["source"]), f"cell {number}").body
    last = body.pop() if isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), f"cell {number}", "exec"), namespace)
    if last is not None:
        shown = eval(compile(ast.Expression(last.value), f"cell {number}", "eval"), namespace)
        if shown is not None:
            print(f"cell {number}: {shown}")

assert len(pictures) == 3, f"{len(pictures)} pictures"
for axes in pictures:
    assert all(axis.lines or axis.patches for axis in axes), "a picture is empty"
# What the notebook counts is what the program counted.
failed, summary = namespace["failed"], namespace["tables"]["summary"].to_dicts()
stated = {row["controller"]: row["failed"] for row in summary if row["stratum"] == "all"}
assert dict(zip(failed["controller"], failed["failed"])) == stated, (failed, stated)
assert not namespace["met"].is_empty()
print(f"failures: {stated}")
