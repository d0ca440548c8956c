#!/usr/bin/env python3
"""Motion by Blender and by `holotrace`: the vertices of animated objects at several times.

Usage: blender_motion.py        in a Python 3.11 with `pip install bpy==4.2.0 numpy`, and Holotrace's package

A box that moves and one that turns (keys with Bezier curves and on lines), a bar whose skin follows an armature of two bones, and a plate
with a shape key are animated in Blender and written as glTF, once with a key for each frame (Blender's usual way) and once with the keys as
they were set. The vertices that Blender evaluates are compared with those of the scene here. Printed is the largest distance of a vertex of
one from the nearest one of the other; objects are 1 m large, and files have single precision. It fails if one that must agree is above 1 um.

Not the same by the format: between the frames of a file with a key for each of them, glTF goes on lines. Of turns with few keys Blender
interpolates the four numbers, and glTF the angle (LINEAR); those with Bezier curves are written with other slopes.
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

import holotrace as ht

FPS, FRAMES = 24, 24
ON_FRAMES, BETWEEN = [0, 5 / FPS, 0.5, 17 / FPS, 1], [0.27, 0.61]


def fresh():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = FPS
    scene.frame_start, scene.frame_end = 0, FRAMES
    return scene


def add_mesh(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    one = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(one)
    return one


def box(name, size):
    x, y, z = (s / 2 for s in size)
    corners = [(a, b, c) for a in (-x, x) for b in (-y, y) for c in (-z, z)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return add_mesh(name, corners, faces)


def interpolate(one, kind):
    curves = one.animation_data.action.fcurves
    for curve in curves:
        for key in curve.keyframe_points:
            key.interpolation = kind


def moving_box(kind, what):
    one = box("box", (0.5, 0.3, 0.2))
    one.rotation_mode = "QUATERNION"
    for frame, place, turn in [(0, (0, 0, 0), (1, 0, 0, 0)), (10, (0.4, -0.2, 0.3), (0.8, 0.6, 0, 0)), (24, (-0.3, 0.1, 0), (0, 0.6, 0.8, 0))]:
        setattr(one, what, place if what == "location" else turn)
        one.keyframe_insert(what, frame=frame)
    interpolate(one, kind)


def skinned_bar():
    rings = np.linspace(0, 1, 9)
    vertices = [(x, y, z) for z in rings for x, y in ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1))]
    faces = [(4 * k + i, 4 * k + (i + 1) % 4, 4 * k + 4 + (i + 1) % 4, 4 * k + 4 + i) for k in range(8) for i in range(4)]
    bar = add_mesh("bar", vertices, faces)
    rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    lower = rig.data.edit_bones.new("lower")
    lower.head, lower.tail = (0, 0, 0), (0, 0, 0.5)
    upper = rig.data.edit_bones.new("upper")
    upper.head, upper.tail, upper.parent = (0, 0, 0.5), (0, 0, 1), lower
    bpy.ops.object.mode_set(mode="OBJECT")
    for name in ("lower", "upper"):
        group = bar.vertex_groups.new(name=name)
        for i, (_, _, z) in enumerate(vertices):
            share = min(1, max(0, (z - 0.3) / 0.4))
            group.add([i], share if name == "upper" else 1 - share, "REPLACE")
    bar.parent = rig
    bar.modifiers.new("skin", "ARMATURE").object = rig
    for frame, angle in [(0, 0.0), (24, 1.2)]:
        for name, part in (("lower", 0.3), ("upper", 1.0)):
            bone = rig.pose.bones[name]
            bone.rotation_mode = "QUATERNION"
            bone.rotation_quaternion = (np.cos(part * angle / 2), np.sin(part * angle / 2), 0, 0)
            bone.keyframe_insert("rotation_quaternion", frame=frame)


def shape_key():
    plate = box("plate", (0.6, 0.6, 0.05))
    plate.shape_key_add(name="rest")
    key = plate.shape_key_add(name="bent")
    for point in key.data:
        point.co.z += 0.5 * point.co.x**2 + 0.1 * point.co.y
    for frame, value in [(0, 0.0), (12, 1.0), (24, 0.25)]:
        key.value = value
        key.keyframe_insert("value", frame=frame)


def vertices_by_blender(time):
    frame = time * FPS
    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    graph = bpy.context.evaluated_depsgraph_get()
    places = []
    for one in bpy.context.scene.objects:
        if one.type != "MESH":
            continue
        evaluated = one.evaluated_get(graph)
        mesh = evaluated.to_mesh()
        places += [tuple(evaluated.matrix_world @ vertex.co) for vertex in mesh.vertices]
        evaluated.to_mesh_clear()
    x, y, z = np.array(places).T
    return np.stack([x, z, -y], axis=1)  # glTF has y up


def vertices_here(scene, time):
    meshes = ht.load_scene(scene, time=time).meshes
    return np.concatenate([vertices for _, vertices, _ in meshes]) + [0, 0, 10]


def farthest(a, b):
    distances = np.linalg.norm(a[:, None] - b[None], axis=2)
    return max(distances.min(axis=0).max(), distances.min(axis=1).max())


def main():
    worst = 0
    with tempfile.TemporaryDirectory() as folder:
        model, scene = Path(folder, "motion.glb"), Path(folder, "scene.toml")
        scene.write_text(
            'wavelength = "532 nm"\n[[light]]\ntype = "point"\nposition = "0 0 1 m"\nintensity = 1\n'
            '[[object]]\ntype = "mesh"\nfile = "motion.glb"\nposition = "0 0 -10 m"\n'
        )
        cases = {f"box that {verb}, {kind.lower()} keys": (moving_box, kind, what) for kind in ("BEZIER", "LINEAR") for verb, what in (("moves", "location"), ("turns", "rotation_quaternion"))}
        cases |= {"skin of two bones": (skinned_bar,), "shape key": (shape_key,)}
        for name, (make, *arguments) in cases.items():
            for sampled in (True, False):
                fresh()
                make(*arguments)
                bpy.ops.export_scene.gltf(filepath=str(model), export_force_sampling=sampled, export_frame_range=False, export_optimize_animation_size=False)
                for times, where in ((ON_FRAMES, "on frames"), (BETWEEN, "between frames")):
                    distance = max(farthest(vertices_by_blender(t), vertices_here(str(scene), t)) for t in times)
                    is_same = where == "on frames" if sampled else "turns" not in name
                    worst = max(worst, distance if is_same else 0)
                    print(f"{name}, {'a key a frame' if sampled else 'keys as set'}, {where}: {1e6 * distance:.2f} um{'' if is_same else ' (not the same by the format)'}", flush=True)
    return 1 if worst > 1e-6 else 0


if __name__ == "__main__":
    sys.exit(main())
