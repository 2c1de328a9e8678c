# SPDX-License-Identifier: MIT
# Opens the trace of made_trace.h as a user would, and checks values, types and units.
import sys

import h5py

with h5py.File(sys.argv[1], "r") as f:
    assert f.attrs["format"] == b"cuboct trace" or f.attrs["format"] == "cuboct trace"
    assert f.attrs["version"] == 2
    assert f.attrs["plan_hash"] in (b"fedcba9876543210", "fedcba9876543210")
    assert f.attrs["nodes"] == 2
    assert f.attrs["steps"] == 2 and f.attrs["hash_every"] == 1
    assert list(f["state_hash"]) == [1, 2**64 - 1, 3]

    frames = f["frames"]
    assert list(frames["step"]) == [0, 2]
    first, last = frames["first"][1], frames["first"][2]
    assert list(frames["id"][first:last]) == [0, 1, 5]
    assert list(frames["type"][first:last]) == [0, 1, 0]
    assert frames["x"].shape == (6, 3) and frames["x"].dtype == "int64"
    assert list(frames["v"][first + 2]) == [-2000, 1, 2**40]
    assert frames["v"].attrs["unit"] in (b"cell edge / step / 2^(P+G)", "cell edge / step / 2^(P+G)")
    assert frames["x"].compression == "gzip" and frames["x"].chunks is not None

    curve = f["curves/grip.force_x"]
    assert list(curve["step"]) == [0, 2]
    assert list(curve["value"]) == [0.0, -1.25]
    assert curve["value"].attrs["unit"] in (b"N", "N")

    assert f["cycles"].shape == (2, 2, 8, 2)
    assert list(f["cycles"][1, 1, 3]) == [1301, 1310]

    bodies = f["bodies"]
    assert list(bodies["step"]) == [0, 2]
    assert bodies["x"].shape == (4, 3) and bodies["x"].dtype == "float64"
    assert list(bodies["x"][2 + 1]) == [4, 5, -6] and list(bodies["v"][2]) == [-1, 0.1, 2]
    assert list(bodies["force"][3]) == [-3, 0, 1e9]
    assert bodies["v"].attrs["unit"] in (b"m/s", "m/s")

    assert f["findings"].attrs["watched"] == 2
    assert list(f["findings/particle"]) == [-1, 5] and list(f["findings/failure"]) == [2, 8]
    assert [t.decode() for t in f["findings/text"][:]][0] == "step 1: stiff hold: ..."
    assert [t.decode() for t in f["notes/text"][:]] == ["float", "a device, of some name", ""]

    stop = f["stop"].attrs
    assert stop["fault_name"] in (b"velocity out of width", "velocity out of width")
    assert stop["particle"] == 5 and stop["number"] == -(2**40)

    names = [n.decode() for n in f["counters/name"][:]]
    assert dict(zip(names, f["counters/value"][:])) == {"pairs_issued": 12.0, "stalls": 0.5}
