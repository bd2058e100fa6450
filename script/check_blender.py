# Runs in Blender: builds a scene of meshes, renders it there and by `sensorfarm sense`, and compares pixel by pixel.
# Cycles casts one ray through each pixel's centre. Its material has the light of docs/cameras.md#colours: a diffuse
# surface in the sun, and skylight by the normal. Some have textures, with texels larger than pixels. So depths, labels,
# shadows and colours have to be equal, up to float32.
import json
import math
import pathlib
import subprocess
import sys

import bpy
import mathutils
import numpy

WIDTH, HEIGHT, FOV = 640, 480, 70.0
SUN, SUNLIGHT, SKYLIGHT = (-60.0, 35.0), 0.8, 0.3  # azimuth and elevation [deg]
FLOOR = 128 / 255  # "gray50" as written below, in sRGB
TEXTURED, TEXELS = ('ball', 'cube', 'wall'), 16  # along a side
MOST_DEPTH = 2e-5  # relative; coordinates, matrices and rays are in 32 bits there
program, folder = sys.argv[sys.argv.index('--') + 1:]
folder = pathlib.Path(folder)


def linear(encoded):
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


def encoded(light):
    return numpy.where(light <= 0.0031308, 12.92 * light, 1.055 * numpy.maximum(light, 0) ** (1 / 2.4) - 0.055)


def picture(name):
    """Returns a random picture of 8 bits, and the same in linear light, in which Cycles interpolates it linearly."""
    values = numpy.random.default_rng(len(name)).integers(0, 256, (TEXELS, TEXELS, 4)) / 255
    values[..., 3] = 1
    light = numpy.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    images = []
    for suffix, pixels in (('', values), ('_linear', light)):
        image = bpy.data.images.new(name + suffix, TEXELS, TEXELS, float_buffer=bool(suffix))
        if suffix:
            image.colorspace_settings.name = 'Non-Color'
        image.pixels.foreach_set(pixels.astype(numpy.float32).ravel())
        image.pack()
        images.append(image)
    return images


def material(name, color):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    surface = made.node_tree.nodes['Principled BSDF'].inputs['Base Color']
    surface.default_value = (*color, 1)
    if name in TEXTURED:
        image = made.node_tree.nodes.new('ShaderNodeTexImage')
        image.image, _ = picture(name)
        made.node_tree.links.new(image.outputs['Color'], surface)
    return made


def color_surfaces(made, color, *inputs):
    """Gives inputs of a material's nodes its colour, or its picture."""
    for each in inputs:
        each.default_value = (*color, 1)
    if made.name not in TEXTURED:
        return
    image = made.node_tree.nodes.new('ShaderNodeTexImage')
    image.image = bpy.data.images[made.name + '_linear']
    for each in inputs:
        made.node_tree.links.new(image.outputs['Color'], each)


def lit_as_here(made, color):
    """Replaces a material by our model of light."""
    nodes, link = made.node_tree.nodes, made.node_tree.links.new
    nodes.clear()
    made.cycles.sample_as_light = False
    sun_height = math.sin(math.radians(SUN[1]))
    ground = (SKYLIGHT + SUNLIGHT * sun_height) / 4
    diffuse, emission, both = (nodes.new(f'ShaderNode{kind}') for kind in ('BsdfDiffuse', 'Emission', 'AddShader'))
    color_surfaces(made, color, diffuse.inputs['Color'], emission.inputs['Color'])
    normal, split, seen = (nodes.new(f'ShaderNode{kind}') for kind in ('NewGeometry', 'SeparateXYZ', 'LightPath'))
    scale, once = nodes.new('ShaderNodeMath'), nodes.new('ShaderNodeMath')
    once.operation = 'MULTIPLY'
    scale.operation = 'MULTIPLY_ADD'
    scale.inputs[1].default_value, scale.inputs[2].default_value = (SKYLIGHT - ground) / 2, (SKYLIGHT + ground) / 2
    link(normal.outputs['Normal'], split.inputs[0])
    link(split.outputs['Z'], scale.inputs[0])
    link(scale.outputs[0], once.inputs[0])
    link(seen.outputs['Is Camera Ray'], once.inputs[1])
    link(once.outputs[0], emission.inputs['Strength'])
    link(diffuse.outputs[0], both.inputs[0])
    link(emission.outputs[0], both.inputs[1])
    link(both.outputs[0], nodes.new('ShaderNodeOutputMaterial').inputs['Surface'])


def build():
    """Returns the objects in order of their names, each with its colour (linear)."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.ops.mesh
    made = {}

    def add(name, color, operation, **keys):
        operation(**keys)
        made[name] = (bpy.context.object, color)
        bpy.context.object.name = name

    add('ball', (0.6, 0.1, 0.05), mesh.primitive_uv_sphere_add, segments=48, ring_count=24, radius=0.6,
        location=(0.5, 1.2, 0.6))
    add('cube', (0.1, 0.3, 0.6), mesh.primitive_cube_add, size=1, location=(-0.6, -1, 0.5), rotation=(0, 0, 0.5))
    add('cone', (0.7, 0.6, 0.1), mesh.primitive_cone_add, vertices=32, radius1=0.5, depth=1.4,
        location=(1.6, -0.9, 0.7))
    add('monkey', (0.35, 0.2, 0.1), mesh.primitive_monkey_add, size=1.6, location=(-0.4, 0.1, 1.9),
        rotation=(0.2, 0.1, -1.2))
    add('ring', (0.1, 0.5, 0.2), mesh.primitive_torus_add, major_radius=0.8, minor_radius=0.15,
        location=(2.6, 0.6, 0.9), rotation=(1.2, 0.4, 0))
    add('wall', (0.8, 0.8, 0.75), mesh.primitive_cube_add, size=1, location=(3.6, 0, 1), scale=(0.1, 6, 2))
    for i, (name, (thing, color)) in enumerate(made.items()):
        thing.data.materials.append(material(name, color))
        thing.pass_index = i + 2
        for other in bpy.context.selectable_objects:
            other.select_set(other == thing)
        bpy.ops.export_scene.gltf(filepath=str(folder / f'{name}.glb'), use_selection=True)
    return made


def photographed(names):
    models = '\n'.join(f'model( name "{name}" mesh "{name}.glb" pose [0 0 0 0] )' for name in names)
    world = folder / 'blender.world'
    world.write_text(f'''sun [{SUN[0]} {SUN[1]}]  sunlight {SUNLIGHT}  skylight {SKYLIGHT}  floor_color "gray50"
{models}
position( name "robot" pose [-4.5 -1.5 0 20] size [0.2 0.2 0.4]
  camera( resolution [{WIDTH} {HEIGHT}] fov {FOV} range [0 60] rgb 1 pose6 [0 0 1.2 5 8 0] ) )
''')
    command = [program, 'sense', str(world), '--type', 'camera', '--json']
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def place_camera(image):
    w, x, y, z = image['sensor_orientation']
    axes = mathutils.Quaternion((w, x, y, z)).to_matrix() @ mathutils.Matrix(((0, 0, -1), (-1, 0, 0), (0, 1, 0)))
    data = bpy.data.cameras.new('camera')
    data.sensor_fit, data.angle, data.clip_start, data.clip_end = 'HORIZONTAL', math.radians(FOV), 1e-3, 60
    camera = bpy.data.objects.new('camera', data)
    camera.matrix_world = mathutils.Matrix.Translation(image['sensor_position']) @ axes.to_4x4()
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def place_light():
    light = bpy.data.lights.new('sun', 'SUN')
    light.energy, light.angle = math.pi * SUNLIGHT, 0
    sun = bpy.data.objects.new('sun', light)
    azimuth, elevation = map(math.radians, SUN)
    toward = mathutils.Vector((math.cos(azimuth) * math.cos(elevation), math.sin(azimuth) * math.cos(elevation),
                               math.sin(elevation)))
    sun.rotation_euler = toward.to_track_quat('Z', 'Y').to_euler()
    bpy.context.collection.objects.link(sun)


def rendered(samples, bounces):
    """Returns depth, label and linear colour from the top left."""
    scene = bpy.context.scene
    scene.render.engine = 'CYCLES'
    scene.cycles.max_bounces = bounces
    scene.cycles.samples, scene.cycles.pixel_filter_type, scene.cycles.filter_width = samples, 'BLACKMAN_HARRIS', 0.01
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.use_pass_object_index = True
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    layers, out = tree.nodes.new('CompositorNodeRLayers'), tree.nodes.new('CompositorNodeOutputFile')
    out.base_path = str(folder)
    out.format.file_format, out.format.color_depth = 'OPEN_EXR', '32'
    out.file_slots.clear()
    images = []
    for output in ('Depth', 'IndexOB', 'Image'):
        out.file_slots.new(output)
        tree.links.new(layers.outputs[output], out.inputs[output])
    bpy.ops.render.render()
    for output in ('Depth', 'IndexOB', 'Image'):
        picture = bpy.data.images.load(str(folder / f'{output}0001.exr'))
        picture.colorspace_settings.name = 'Non-Color'
        pixels = numpy.empty(4 * WIDTH * HEIGHT, numpy.float32)
        picture.pixels.foreach_get(pixels)
        images.append(pixels.reshape(HEIGHT, WIDTH, 4)[::-1].astype(float))
        bpy.data.images.remove(picture)
    return images[0][..., 0], images[1][..., 0].round().astype(int), images[2][..., :3]


def save(name, picture):
    height, width, _ = picture.shape
    image = bpy.data.images.new(name, width, height)
    pixels = numpy.ones((height, width, 4), numpy.float32)
    pixels[..., :3] = picture[::-1]
    image.pixels.foreach_set(pixels.ravel())
    image.file_format, image.filepath_raw = 'PNG', str(folder / f'{name}.png')
    image.save()


def in_daylight(colors):
    """Blender's own light: white skylight, reflected and occluded."""
    for name, color in colors.items():
        nodes, link = bpy.data.materials[name].node_tree.nodes, bpy.data.materials[name].node_tree.links.new
        nodes.clear()
        diffuse = nodes.new('ShaderNodeBsdfDiffuse')
        color_surfaces(bpy.data.materials[name], color, diffuse.inputs['Color'])
        link(diffuse.outputs[0], nodes.new('ShaderNodeOutputMaterial').inputs['Surface'])
    world = bpy.context.scene.world = bpy.data.worlds.new('sky')
    world.use_nodes = True
    world.node_tree.nodes['Background'].inputs['Color'].default_value = (SKYLIGHT, SKYLIGHT, SKYLIGHT, 1)


def main():
    made = build()
    image = photographed(made)
    bpy.ops.mesh.primitive_plane_add(size=400)
    floor = bpy.context.object
    floor.pass_index, gray = 1, linear(FLOOR)
    floor.data.materials.append(material('floor', (gray,) * 3))
    colors = {name: color for name, (_, color) in made.items()} | {'floor': (gray,) * 3}
    for name, color in colors.items():
        lit_as_here(bpy.data.materials[name], color)
    place_camera(image)
    place_light()
    depth, label, light = rendered(1, 0)

    shape = (HEIGHT, WIDTH)
    numbers = {None: 0, 'floor': 1} | {name: i + 2 for i, name in enumerate(made)}
    our_depth = numpy.array(image['depth_m']).reshape(shape)
    our_label = numpy.array([numbers[name] for name in image['labels']]).reshape(shape)
    rgb = numpy.array(image['rgb']).reshape(shape)
    our_color = numpy.stack([rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255], -1)
    color = numpy.clip(255 * encoded(light), 0, 255)

    same = (label == our_label) & (label > 0)
    print(f'{(label != our_label).sum()} of {label.size} pixels have other labels')
    off = numpy.abs(depth - our_depth)[same] / our_depth[same]
    print(f'depths: largest relative difference {off.max():.1e}, median {numpy.median(off):.1e}')
    step = numpy.abs(color - our_color).max(-1)
    print(f'colours: {(step[same] > 1).sum()} of {same.sum()} pixels differ by more than 1 of 255, '
          f'{(step[same] > 8).sum()} by more than 8')
    in_daylight(colors)
    pictures = our_color / 255, numpy.where(label[..., None] > 0, color / 255, 0), encoded(rendered(64, 8)[2])
    save('compared', numpy.concatenate(pictures, 1))
    good = (label != our_label).mean() < 5e-4 and (off > MOST_DEPTH).mean() < 1e-4 and (step[same] > 1).mean() < 2e-3
    print(f'{folder}/compared.png (sensorfarm, Cycles with the same light, Cycles in daylight): '
          + ('equal' if good else 'NOT EQUAL'))
    sys.exit(0 if good else 1)


main()
