# SPDX-License-Identifier: MIT
"""A tetrahedron-like body in the formats of meshes that scenes take: one block of 4 x 3 x 2, in each."""
import io
import struct
import zipfile

X, Y, Z = 4.0, 3.0, 2.0
POINTS = [(x, y, z) for z in (0.0, Z) for y in (0.0, Y) for x in (0.0, X)]
FACES = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def stl_text():
    facets = "".join("facet normal 0 0 0\n outer loop\n" + "".join("  vertex %g %g %g\n" % POINTS[k] for k in face) + " endloop\nendfacet\n"
                     for face in FACES)
    return ("solid block\n" + facets + "endsolid block\n").encode()


def stl_binary():
    return b"block".ljust(80, b"\0") + struct.pack("<I", len(FACES)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(c for k in face for c in POINTS[k]), 0) for face in FACES)


def obj():
    return ("o block\n" + "".join("v %g %g %g\n" % p for p in POINTS) + "".join("f %d %d %d\n" % tuple(k + 1 for k in f) for f in FACES)).encode()


def ply_head(kind):
    return (f"ply\nformat {kind} 1.0\ncomment block\nelement vertex {len(POINTS)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(FACES)}\nproperty list uchar int vertex_indices\nend_header\n").encode()


def ply_text():
    return ply_head("ascii") + ("".join("%g %g %g\n" % p for p in POINTS) + "".join("3 %d %d %d\n" % f for f in FACES)).encode()


def ply_binary(kind="binary_little_endian"):
    order = "<" if "little" in kind else ">"
    return ply_head(kind) + b"".join(struct.pack(order + "3f", *p) for p in POINTS) + b"".join(
        struct.pack(order + "B3i", 3, *f) for f in FACES)


def off():
    return (f"OFF\n{len(POINTS)} {len(FACES)} 0\n" + "".join("%g %g %g\n" % p for p in POINTS) + "".join("3 %d %d %d\n" % f for f in FACES)).encode()


def model_3mf():
    return ('<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xml:lang="en-US" '
            'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">\n<resources>\n<object id="1" type="model">\n<mesh>\n<vertices>\n' +
            "".join('<vertex x="%g" y="%g" z="%g" />\n' % p for p in POINTS) + "</vertices>\n<triangles>\n" +
            "".join('<triangle v1="%d" v2="%d" v3="%d" />\n' % f for f in FACES) +
            '</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item objectid="1" />\n</build>\n</model>\n').encode()


def packed_3mf(model):
    """Without the time of day, so that the same model makes the same bytes."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in (("[Content_Types].xml", b'<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
                            b'<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
                            b'<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'),
                           ("_rels/.rels", b'<?xml version="1.0" encoding="UTF-8"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
                            b'<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'),
                           ("3D/3dmodel.model", model)):
            archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data)
    return out.getvalue()


def dae():
    return ('<?xml version="1.0" encoding="utf-8"?>\n<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">\n'
            '<asset>\n<unit name="millimeter" meter="0.001"/>\n<up_axis>Z_UP</up_axis>\n</asset>\n<library_geometries>\n'
            '<geometry id="block">\n<mesh>\n<source id="p">\n'
            f'<float_array id="pa" count="{3 * len(POINTS)}">' + " ".join("%g %g %g" % p for p in POINTS) + "</float_array>\n<technique_common>\n"
            f'<accessor source="#pa" count="{len(POINTS)}" stride="3">\n<param name="X" type="float"/>\n<param name="Y" type="float"/>\n'
            '<param name="Z" type="float"/>\n</accessor>\n</technique_common>\n</source>\n<vertices id="v">\n<input semantic="POSITION" source="#p"/>\n'
            f'</vertices>\n<triangles count="{len(FACES)}">\n<input semantic="VERTEX" source="#v" offset="0"/>\n<p>' +
            " ".join("%d %d %d" % f for f in FACES) + '</p>\n</triangles>\n</mesh>\n</geometry>\n</library_geometries>\n<library_visual_scenes>\n'
            '<visual_scene id="s">\n<node>\n<instance_geometry url="#block"/>\n</node>\n</visual_scene>\n</library_visual_scenes>\n'
            '<scene>\n<instance_visual_scene url="#s"/>\n</scene>\n</COLLADA>\n').encode()


# By the ending of the file's name: its bytes, and whether it is a text.
ALL = {"text.stl": (stl_text(), True), "binary.stl": (stl_binary(), False), "block.obj": (obj(), True), "text.ply": (ply_text(), True),
       "little.ply": (ply_binary(), False), "big.ply": (ply_binary("binary_big_endian"), False), "block.off": (off(), True),
       "block.3mf": (packed_3mf(model_3mf()), False), "block.dae": (dae(), True)}


def gmsh(version, cubes=2):
    """A row of cubes along x, of six tetrahedra each, that may repeat along x; in format 2.2 or 4.1."""
    points = [(x, y, z) for x in range(cubes + 1) for y in (0, 1) for z in (0, 1)]
    solids = []
    for x in range(cubes):
        # From a corner to the opposite one, axis by axis; the volume of odd orders is negative.
        for order, odd in (((0, 1, 2), 0), ((0, 2, 1), 1), ((1, 0, 2), 1), ((1, 2, 0), 0), ((2, 0, 1), 0), ((2, 1, 0), 1)):
            corner = [x, 0, 0]
            path = [tuple(corner)]
            for axis in order:
                corner[axis] += 1
                path.append(tuple(corner))
            solids.append([points.index(p) + 1 for p in ([path[0], path[2], path[1], path[3]] if odd else path)])
    nodes = ["%g %g %g\n" % p for p in points]
    count, tets = len(points), len(solids)
    if version == 2:
        return (f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{count}\n" + "".join(f"{k + 1} {node}" for k, node in enumerate(nodes)) +
                f"$EndNodes\n$Elements\n{tets + 1}\n1 15 2 1 1 1\n" + "".join("%d 4 2 1 %d %d %d %d %d\n" % (k + 2, k % 2, *s) for k, s in enumerate(solids)) +
                "$EndElements\n").encode()
    return (f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {count} 1 {count}\n3 1 0 {count}\n" + "".join("%d\n" % (k + 1) for k in range(count)) +
            "".join(nodes) + f"$EndNodes\n$Elements\n1 {tets} 1 {tets}\n3 1 4 {tets}\n" + "".join("%d %d %d %d %d\n" % (k + 1, *s) for k, s in enumerate(solids)) +
            "$EndElements\n").encode()
