# SPDX-License-Identifier: MIT
"""A box of 6 x 4 x 3 in each format that is read."""
import io
import struct
import zipfile

POINTS = [(6.0 * (k & 1), 4.0 * (k >> 1 & 1), 3.0 * (k >> 2)) for k in range(8)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
TRIANGLES = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]


def words(rows):
    return "\n".join(" ".join(str(x) for x in row) for row in rows) + "\n"


def ply(kind):
    head = (
        f"ply\nformat {kind} 1.0\ncomment a box\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 12\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()
    if kind == "ascii":
        return head + (words(POINTS) + words([(3, *t) for t in TRIANGLES])).encode()
    return head + b"".join(struct.pack("<3f", *p) for p in POINTS) + b"".join(struct.pack("<B3i", 3, *t) for t in TRIANGLES)


def stl():
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*POINTS[k]) for k in t) + "endloop\nendfacet\n"
        for t in TRIANGLES
    )
    return f"solid box\n{facets}endsolid box\n".encode()


def binary_stl():
    facets = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for k in t for x in POINTS[k]), 0) for t in TRIANGLES)
    return b" " * 80 + struct.pack("<I", len(TRIANGLES)) + facets


def obj():
    faces = [("f", *(k + 1 for k in q)) for q in QUADS]
    return ("mtllib box.mtl\no box\n" + words([("v", *p) for p in POINTS]) + words(faces)).encode()


def off():
    return ("OFF\n8 12 0\n" + words(POINTS) + words([(3, *t) for t in TRIANGLES])).encode()


def dae():
    numbers, indices = words(POINTS).replace("\n", " "), words(TRIANGLES).replace("\n", " ")
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="mm" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="24">{numbers}</float_array>
<technique_common><accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
""".encode()


def amf():
    points = "".join(f"<vertex><coordinates><x>{x}</x><y>{y}</y><z>{z}</z></coordinates></vertex>" for x, y, z in POINTS)
    triangles = "".join(f"<triangle><v1>{a}</v1><v2>{b}</v2><v3>{c}</v3></triangle>" for a, b, c in TRIANGLES)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<amf unit="millimeter"><object id="0"><mesh><vertices>{points}</vertices><volume>{triangles}</volume></mesh></object></amf>
""".encode()


def threemf(method=zipfile.ZIP_STORED):
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in POINTS)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in TRIANGLES)
    package = "http://schemas.openxmlformats.org/package/2006"
    bytes_ = io.BytesIO()
    with zipfile.ZipFile(bytes_, "w", method) as out:
        for name, text in {
            "[Content_Types].xml": f'<Types xmlns="{package}/content-types"><Default Extension="rels" ContentType="application/'
            'vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/'
            'vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
            "_rels/.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="r" Target="/3D/3dmodel.model" '
            'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
            "3D/3dmodel.model": '<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
            f'<resources><object id="1" type="model"><mesh><vertices>{points}</vertices><triangles>{triangles}</triangles>'
            '</mesh></object></resources><build><item objectid="1"/></build></model>',
        }.items():
            out.writestr(zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0)), text, method)
    return bytes_.getvalue()


FILES = {
    "text.ply": ply("ascii"),
    "binary.ply": ply("binary_little_endian"),
    "text.stl": stl(),
    "binary.stl": binary_stl(),
    "box.obj": obj(),
    "box.off": off(),
    "box.dae": dae(),
    "box.amf": amf(),
    "box.3mf": threemf(),
}
STATED = (".dae", ".amf", ".3mf")
