"""Opens every table of a run with the readers that are installed and does with them what their users do.

Argument: the directory of a run. Prints a line for each reader, file and operation, and fails at the first that does not
work or does not say what another reader says.
"""
import csv
import glob
import importlib
import os
import pathlib
import sys
import tempfile

run = sys.argv[1]
files = {os.path.basename(path)[:-8]: path for path in sorted(glob.glob(f"{run}/*.parquet"))}
assert {"episodes", "channels", "faults", "conditions", "summary", "comparison"} <= files.keys(), files.keys()


def said(reader, file, operation):
    print(f"{reader:<24} {file:<12} {operation}")


def known(name):
    """A module, or nothing where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def of_csv(name, **wanted):
    """Rows of a small table as CSV, which every version reads alike."""
    with open(f"{run}/{name}.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


expected = of_csv("comparison", scope="group", stratum="all")
differences = [int(row["only_a_failed"]) - int(row["only_b_failed"]) for row in expected]
assert any(difference < 0 for difference in differences), differences

pyarrow, pandas, polars, duckdb = (known(name) for name in ["pyarrow", "pandas", "polars", "duckdb"])
assert pyarrow, "pyarrow is what every other reader stands on"

import pyarrow.compute as compute
import pyarrow.parquet as parquet

reader = f"pyarrow {pyarrow.__version__}"
for name, path in files.items():
    table = parquet.read_table(path)
    said(reader, name, f"open ({table.num_rows} rows)")
    for field in table.schema:
        # Text that every version knows, and counts with a sign.
        assert str(field.type) in ["string", "int64", "double", "bool"], (name, field)
    metadata = {key.decode() for key in parquet.read_metadata(path).metadata}
    assert "urts-mc.campaign" in metadata and "urts-mc.seed" in metadata, (name, metadata)
assert parquet.read_metadata(files["episodes"]).metadata[b"urts-mc.unit.failed_at_s"] == b"s"
ftc = parquet.read_table(files["channels"], filters=[("controller", "==", "ftc")])
every = parquet.read_table(files["channels"])
assert 0 < ftc.num_rows < every.num_rows
said(reader, "channels", "filter text")
comparison = parquet.read_table(files["comparison"])
both = compute.and_(compute.equal(comparison["scope"], "group"), compute.equal(comparison["stratum"], "all"))
both = comparison.filter(both)
found = compute.subtract(both["only_a_failed"], both["only_b_failed"]).to_pylist()
assert found == differences, (found, differences)
said(reader, "comparison", "subtract counts")
grouped = every.group_by("controller").aggregate([("rmse", "mean")])
assert grouped.num_rows == len(set(every["controller"].to_pylist()))
said(reader, "channels", "group")
episodes = parquet.read_table(files["episodes"]).select(["episode", "controller", "agent", "status"])
joined = every.join(episodes, keys=["episode", "controller", "agent"])
assert joined.num_rows == every.num_rows
said(reader, "channels", "join")
# A table of very many rows is a folder of files under the table's name.
place = tempfile.TemporaryDirectory()
folder = pathlib.Path(place.name) / "channels.parquet"
folder.mkdir()
middle = every.num_rows // 2
for number, piece in enumerate([every.slice(0, middle), every.slice(middle)]):
    parquet.write_table(piece, folder / f"part-{number:05}.parquet")
assert parquet.read_table(folder).equals(every)
said(reader, "channels", "open as a folder")

if pandas:
    reader = f"pandas {pandas.__version__}"
    frames = {name: pandas.read_parquet(path) for name, path in files.items()}
    for name in frames:
        said(reader, name, "open")
    assert len(pandas.read_parquet(folder)) == every.num_rows
    said(reader, "channels", "open as a folder")
    ftc = pandas.read_parquet(files["channels"], filters=[("controller", "==", "ftc")])
    assert 0 < len(ftc) < len(frames["channels"])
    said(reader, "channels", "filter text")
    rows = frames["comparison"].query("scope == 'group' and stratum == 'all'")
    assert list(rows.only_a_failed - rows.only_b_failed) == differences
    said(reader, "comparison", "subtract counts")
    assert frames["channels"].groupby("controller").rmse.median().notna().any()
    said(reader, "channels", "group")
    named = frames["faults"].merge(frames["episodes"], on=["episode", "agent"])
    assert len(named) and named.fault.notna().all()
    said(reader, "faults", "join")

if polars:
    reader = f"polars {polars.__version__}"
    frames = {name: polars.read_parquet(path) for name, path in files.items()}
    for name in frames:
        said(reader, name, "open")
    assert polars.read_parquet(folder).height == every.num_rows
    said(reader, "channels", "open as a folder")
    assert 0 < frames["channels"].filter(polars.col("controller") == "ftc").height < frames["channels"].height
    said(reader, "channels", "filter text")
    rows = frames["comparison"].filter(polars.col("scope") == "group", polars.col("stratum") == "all")
    assert (rows["only_a_failed"] - rows["only_b_failed"]).to_list() == differences
    said(reader, "comparison", "subtract counts")
    assert frames["conditions"].group_by("source", "quantity").agg(polars.col("value").mean()).height > 5
    said(reader, "conditions", "group")
    named = frames["faults"].join(frames["episodes"], on=["episode", "agent"])
    assert named.height and named["fault"].null_count() == 0
    said(reader, "faults", "join")

if duckdb:
    reader = f"duckdb {duckdb.__version__}"
    for name, path in files.items():
        rows = duckdb.sql(f"select count(*) from '{path}'").fetchall()[0]
        assert rows[0] > 0
        said(reader, name, "open")
    rows = duckdb.sql(f"select count(*) from '{folder}/*.parquet'").fetchall()[0]
    assert rows[0] == every.num_rows
    said(reader, "channels", "open as a folder")
    ftc = duckdb.sql(f"select count(*) from '{files['channels']}' where controller = 'ftc'").fetchall()[0]
    assert 0 < ftc[0] < every.num_rows
    said(reader, "channels", "filter text")
    found = duckdb.sql(
        f"select only_a_failed - only_b_failed from '{files['comparison']}' "
        "where scope = 'group' and stratum = 'all'"
    ).fetchall()
    assert [row[0] for row in found] == differences
    said(reader, "comparison", "subtract counts")
    duckdb.sql(f"select controller, median(rmse) from '{files['channels']}' group by controller").fetchall()
    said(reader, "channels", "group")
    named = duckdb.sql(
        f"select f.fault, count(*) from '{files['faults']}' f join '{files['episodes']}' e using (episode, agent) "
        "where e.controller = 'ftc' group by f.fault"
    ).fetchall()
    assert named and all(row[0] for row in named)
    said(reader, "faults", "join")

# The thread pools of pyarrow 12 may bring the interpreter down as it ends; what was asked has been answered by then.
sys.stdout.flush()
os._exit(0)
