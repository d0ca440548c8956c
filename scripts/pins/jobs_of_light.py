"""Jobs from scenes to fields."""
from inputs import EXAMPLES, ROOT
from job import COLOURS, IN, OF, PANEL, POINTS, RANKS, ROOM, WALL, each, for_words, job


def examples():
    for path in sorted(EXAMPLES.glob("*.toml")):
        yield job(f"example-{path.stem.replace('_', '-')}", f"run {IN}/small/{path.name} -o out")


def films():
    """A scene at several times, also gone on with and longer."""
    film = f"animate {IN}/small/chess_film.toml -o film"
    yield job("animate", f"{film} --times '200 ms, 1 s'", f"{film} --times '200 ms, 1 s, 5 s, 6 s' --film-format gif")
    yield job("animate-series", f"animate {IN}/small/chess_film.toml -o film --film-start '500 ms' --seconds 0.2 --fps 10 --film-format png")


def sources():
    """Scenes to sources."""
    yield job("trace", f"trace {ROOM} -o waves.ply --report report.json")
    yield job("trace-random", f"trace {ROOM} --pattern random --samples 4000 -o waves.ply")
    yield job("trace-tiled", f"trace {ROOM} --strategy tiled --tile-columns 3 --tile-rows 2 -o waves.ply --report report.json")
    yield job("trace-phases", *for_words(f"trace {ROOM} --phase WORD -o WORD.ply", "constant", "surface", "path"),
              f"trace {ROOM} --phase path --grain '60 um' -o grain.ply", f"trace {IN}/lasers.toml -o laser.ply")
    yield job("trace-options", *each(
        f"trace {ROOM} FLAGS -o NAME.ply", linear="--amplitude linear --seed 7", clamp="--clamp 0.5",
        each_hit="--phase surface --one-wave-per-cell false", path_end="--shadow-rays path-end --roulette-depth 1",
        grid="--accelerator grid", wide="--field-of-view '1.2 deg'", some="--path-expressions 'E(D|G)L, ES.*L' --max-depth 3"))
    yield job("trace-sets", f"trace {ROOM} --separate-lights true -o lights.ply",
              f"trace {COLOURS} --common-cone false -o cones.ply",
              f"trace {COLOURS} --frames 2 --path-expressions 'EL, E(D|G|S).*L' --separate-path-groups true -o waves.ply")
    yield job("trace-points", f"trace {POINTS} -o waves.ply")
    yield job("trace-models", *for_words(f"trace {IN}/data/WORD {PANEL} --columns 48 --rows 36 --paths 2 -o WORD.ply",
                                         "pump.glb", "helix_points.ply"))


def renders():
    """Scenes to pictures."""
    yield job("render", f"render {ROOM} -o render.png --report report.json", f"render {COLOURS} -o render.exr")
    yield job("render-lenses", *each(
        f"render {ROOM} FLAGS -o NAME.exr", round="--lens round --pupil '1 mm' --focus '30 mm'",
        panel="--lens panel --focus '30 mm'", eye="--eye '0.2 0 50 mm'"))
    yield job("render-options", *each(
        f"render {ROOM} FLAGS -o NAME.exr", grid="--accelerator grid", dark="--background false",
        seed="--seed 5 --roulette-depth 2", clamp="--clamp 0.4 --max-depth 3", some="--path-expressions 'EDL, ES.*L'",
        wide="--field-of-view '3 deg' --columns 48 --rows 48"))
    yield job("render-stereo", f"render {ROOM} --eye '0 0 60 mm' --eye-separation '4 mm' -o stereo.png")
    yield job("render-stack", *for_words(f"render {IN}/wall_in_colours.toml --focal-stack '29 30 32 mm' -o stack.WORD", "h5",
                                         "png", "exr"),
              f"render {WALL} --focal-stack '-20 30 mm' -o grey.h5")
    small = f"{PANEL} --rows 40 --paths 2 --denoise none"
    yield job("render-models", *for_words(f"render {IN}/data/WORD {small} -o WORD.exr", "pump.glb", "textured_box.glb",
                                          "torus.obj", "pebble.obj", "lampshade.obj", "helix_points.ply", "soup.ply"),
              f"render {IN}/data/pump.glb {small} --up z --rotation 'x 20 deg' --fit 0.5 --floor none -o turned.exr")
    yield job("render-other-models", *for_words(f"render {IN}/seeds/WORD {small} -o WORD.exr", "model.3ds", "model.dae",
                                                "model.off", "text.stl", "binary.stl"))


def fields():
    """Sources and scenes to fields."""
    waves = f"field {OF}/trace/waves.ply {PANEL}"
    yield job("field-exact", f"{waves} --method exact -o field.npy", f"{waves} --double -o double.npy",
              f"{waves} --double -o double.h5")
    yield job("field-tiled", *each(f"{waves} --method tiled FLAGS -o NAME.npy", usual="--report report.json",
                                   coarse="--tolerance 1e-2", fine="--tolerance 1e-4"))
    yield job("field-planes", *each(f"{waves} --method planes --tolerance FLAGS -o NAME.npy --report NAME.json", usual="1e-3",
                                    coarse="1e-2", fine="2e-4"))
    yield job("field-auto", f"{waves} -o field.npy --report report.json", f"{waves} --device auto -o device.npy",
              f"field {OF}/trace/waves.ply --columns 100 --rows 60 --pitch '6 um' --wavelength '450 nm' --frame 3 -o other.npy")
    for name in ("SSE4", "AVX2"):
        yield job(f"field-{name.lower()}", *for_words(f"{waves} --method WORD -o WORD.npy", "tiled", "planes"),
                  environment={"HOLOTRACE_INSTRUCTIONS": name}, needs=name.lower())
    yield job("field-layers", *each(f"{waves} --method layers FLAGS -o NAME.npy --report NAME.json", slices="--slices 8",
                                    coarse="--tolerance 0.05", hidden="--slices 6 --silhouettes true"))
    yield job("field-triangles", *each(f"field {WALL} --method triangles FLAGS -o NAME.npy --report NAME.json", smooth="",
                                       flat="--shading flat", constant="--triangle-phase constant"))
    front = f"field {OF}/trace-points/waves.ply {PANEL}"
    yield job("field-front", *for_words(f"{front} --method WORD -o WORD.npy", "exact", "tiled", "planes", "layers"),
              f"{front} --method layers --silhouettes true --slices 20 -o hidden.npy")
    yield job("field-of-tiles", *for_words(f"field {OF}/trace-tiled/waves.ply {PANEL} --method WORD -o WORD.npy",
                                           "exact", "tiled", "planes"))
    yield job("field-astigmatic",
              *for_words(f"field {OF}/example-oblique-mirror/out/sources.ply --columns 96 --rows 64 --pitch '8 um' "
                         "--method WORD -o WORD.npy", "exact", "tiled", "planes", "layers"))
    yield job("field-gather", f"field {IN}/gather.toml -o field.npy --report report.json")
    yield job("field-formats", f"{waves} -o field.h5", f"{waves} -o field.exr")
    sets = " ".join(f"{OF}/trace-sets/waves{number}.ply" for number in ("", "_2", "_3"))
    yield job("field-colour", f"field {COLOURS} -o field.npy", f"field {COLOURS} -o field.h5",
              f"field {sets} {PANEL} -o sets.npy")
    yield job("field-names", *for_words(f"field {IN}/groups.toml -o group.WORD", "npy", "h5", "exr"))
    yield job("field-scenes", f"field {ROOM} -o room.npy", f"field {IN}/lasers.toml -o lasers.npy",
              f"field {POINTS} -o points.npy --report points.json")
    depth = f"--depth {IN}/depth.png --near '28 mm' --far '34 mm' {PANEL} --wavelength '532 nm'"
    yield job("field-depth", *each(
        f"field {IN}/data/pictures/rgba.png {depth} FLAGS -o NAME.npy", auto="--report report.json",
        slices="--slices 5 --width '0.8 mm'",
        perspective="--projection perspective --field-of-view '1 deg'", constant="--phase constant --seed 3",
        disparity="--depth-scale disparity --silhouettes true --slices 5"))
    yield job("field-depth-more", *each(
        f"field {IN}/data/pictures/rgba.png --depth {IN}/depth.png {PANEL} --slices 4 FLAGS -o NAME.npy",
        colour="--near '28 mm' --far '34 mm' --wavelength '638 nm, 520 nm, 450 nm'",
        cones="--near '28 mm' --far '34 mm' --wavelength '638 nm, 450 nm' --common-cone false",
        through="--near '-5 mm' --far '10 mm' --wavelength '532 nm'"))
    pictures = sorted(path.name for path in (ROOT / "tests" / "data_files" / "pictures").iterdir())
    yield job("read-pictures", *for_words(f"field {IN}/data/pictures/WORD {depth} --slices 2 -o WORD.npy", *pictures))


def bands():
    """Fields in bands; some are stopped, and go on from the files of the record."""
    tall = f"field {OF}/trace/waves.ply --columns 96 --rows 420 --pitch '8 um' --memory '600 MB' --quiet"
    yield job("bands", *for_words(f"{tall} --method WORD -o WORD.h5", "exact", "tiled", "planes", "auto"))
    yield job("bands-sets",
              f"field {OF}/trace-tiled/waves.ply --columns 160 --rows 300 --pitch '8 um' --memory '600 MB' -o tiles.h5 --quiet",
              f"field {IN}/tall_in_colours.toml --memory '600 MB' -o colours.h5 --quiet")
    slow = f"field {OF}/trace/waves.ply --columns 96 --rows 2048 --pitch '8 um' --method exact --memory '600 MB' -o field.h5"
    yield job("bands-stopped", f"stopped.py KILL field.h5.partial.json [[ -- {slow}", loose=("field.h5.partial",))
    yield job("bands-resumed", f"{slow} --quiet",
              copies=(f"{OF}/bands-stopped/field.h5.partial", f"{OF}/bands-stopped/field.h5.partial.json"))
    yield job("ranks-bands", f"{tall} --method tiled -o field.h5", f"{tall} --method planes -o planes.h5",
              f"field {OF}/trace-tiled/waves.ply --columns 160 --rows 300 --pitch '8 um' --memory '600 MB' -o tiles.h5 --quiet",
              f"field {OF}/example-oblique-mirror/out/sources.ply --columns 96 --rows 300 --pitch '8 um' --memory '600 MB' "
              "-o astigmatic.h5 --quiet", f"field {IN}/tall_in_colours.toml --memory '600 MB' -o colours.h5 --quiet",
              launcher=RANKS, needs="mpi")
    yield job("ranks-frames", f"encode {OF}/render-stack/stack.h5 {PANEL} --wavelength '532 nm' --frames 3 --iterations 5 "
              "--method sgd -o hologram.png --report report.json --quiet", launcher=RANKS, needs="mpi")


def propagations():
    """Fields to other planes."""
    field = f"propagate {OF}/field-exact/field.npy"
    yield job("propagate", *for_words(f"{field} --distance '30 mm' --method WORD -o WORD.npy --report WORD.json", "auto",
                                      "angular-spectrum", "rayleigh-sommerfeld", "fresnel"),
              *for_words(f"{field} --distance '30 mm' -o field.WORD", "h5", "exr"))
    yield job("propagate-options", *each(
        f"{field} FLAGS -o NAME.npy", back="--distance '-30 mm'", double="--distance '10 mm' --double",
        periodic="--distance '5 mm' --periodic true", near="--distance '1 mm' --pitch '4 um'",
        window="--distance '20 mm' --columns 100 --rows 90 --pitch '5 um' --centre-x '0.1 mm' --centre-y '-0.05 mm'"))
    yield job("propagate-labelled", *for_words(f"propagate {IN}/labelled.npy --distance '0.1 mm' -o labelled.WORD", "npy",
                                               "h5", "exr"),
              *for_words(f"propagate {IN}/filtered.npy --distance '0.1 mm' --centre-x '0.1 mm' --centre-y '-0.05 mm' "
                         "-o filtered.WORD", "npy", "h5", "exr"))
    yield job("propagate-others", f"propagate {OF}/field-colour/field.h5 --distance '30 mm' -o colour.npy",
              f"propagate {IN}/foreign.npy --distance '10 mm' -o foreign.npy",
              f"propagate {IN}/seeds/field.h5 --distance '1 mm' -o seed.npy")


JOBS = [*examples(), *films(), *sources(), *renders(), *fields(), *bands(), *propagations()]
